"""Somebody is carried while his unit tells that he stands (decision 0126)."""

import math

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.trackers.entry import Place, followed, off_m, shown, surely_elsewhere
from tests.estimator.trackers.restarts import assert_goes_on_alike

SECONDS, DOWN_S, LIFTED_S, SET_DOWN_S = 140, 40, 60, 95
FAR_M = {"a0": (-12.0, -16.0), "a1": (32.0, -14.0), "a2": (30.0, 18.0), "a3": (-10.0, 16.0)}
NEAR_M = {f"a{k}": (8.0 * (k % 5 - 1), -8.0 if k < 5 else 13.0 + (k % 2)) for k in range(10)}
"""Four anchors around that are ranged; or ten along his way that are only heard."""
CARRIED_MPS = 0.7
STAYS_M, WALLS_DB = 4.0, 5.0
"""What walls take of powers stays for so far, and differs by so much."""
MOVES = "moves while the unit of ff1 stands"


def way(second: int, carried: bool = True) -> Place:
    """He walks east and north, goes down, is carried back past where he came in, and walks off."""
    walked = min(second, DOWN_S)
    east, north = 0.5 * walked, min(0.2 * walked, 6.0)
    if carried and second > LIFTED_S:
        east -= CARRIED_MPS * (min(second, SET_DOWN_S) - LIFTED_S)
    if second > SET_DOWN_S:
        north += 0.5 * (second - SET_DOWN_S)
    return east, north


def told(
    seed: int, *, ranges: bool, carried: bool = True, crumbs: bool = False, driven_m: float = 0.0
) -> list[AnyReading]:
    """What is told of him; his unit tells that he stands until he walks off.

    Args:
        seed: of chance.
        ranges: he is ranged, by four anchors around; else only heard, by ten along his way.
        carried: he is carried while his unit stands.
        crumbs: he has dropped breadcrumbs.
        driven_m: so far north the first anchor, a fire engine, is driven while his unit stands.
    """
    chance, anchors_m = np.random.default_rng(seed), FAR_M if ranges else NEAR_M
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*place, 0.0), sigma_m=0.1)
        for name, place in anchors_m.items()
    ]
    start = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3)
    readings.append(start)
    radios, beside_db = dict(anchors_m), dict[str, float]()
    for second in range(1, SECONDS + 1):
        t, at, before = float(second), way(second, carried), way(second - 1, carried)
        stands = DOWN_S < second <= SET_DOWN_S
        noise_m = 0.002 if stands else 0.03
        step_m = np.zeros(2) if stands else np.subtract(at, before)
        east, north = (step_m + chance.normal(0.0, noise_m, 2)).tolist()
        readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(east, north, 0.0)))
        if crumbs and second % 10 == 0 and second < DOWN_S:
            radios[f"b{second}"] = at
            readings.append(Drop(t=t, node=f"b{second}", by="ff1"))
        kept = math.exp(-math.dist(at, before) / STAYS_M)
        if driven_m and second > LIFTED_S:
            radios["a0"] = FAR_M["a0"][0], FAR_M["a0"][1] + min(second - LIFTED_S, 5) / 5 * driven_m
        for name, place in radios.items():
            news_db = math.sqrt(1.0 - kept**2) * float(chance.normal(0.0, WALLS_DB))
            beside_db[name] = kept * beside_db.get(name, 0.0) + news_db
            far_m = max(math.dist(at, place), 0.5)
            dbm = -42.0 - 25.0 * math.log10(far_m) + beside_db[name] + float(chance.normal(0.0, 2.0))
            readings.append(Rssi(t=t, a="ff1", b=name, dbm=dbm))
            if ranges and second % 2 == 0:
                off = far_m + float(chance.normal(0.0, 0.1))
                readings.append(Range(t=t, a="ff1", b=name, range_m=max(off, 0.1), technology="uwb"))
    return readings


def noticed(readings: list[AnyReading]) -> list[str]:
    """All that is said while second after second comes."""
    tracker, texts = KirchhoffTracker(), list[str]()
    for second in range(SECONDS + 1):
        tracker.fold([reading for reading in readings if int(reading.t) == second])
        texts += [notice.text for notice in tracker.take_notices()]
    return texts


@pytest.mark.parametrize(("ranges", "at_most_s", "near_m"), [(True, 3, 0.3), (False, 25, 5.0)])
def test_who_is_carried_is_followed_though_his_unit_stands(
    ranges: bool, at_most_s: int, near_m: float
) -> None:
    """By powers alone he was shown 24 m off to the end, while a standstill was believed."""
    for seed in range(3):
        readings = told(seed, ranges=ranges)
        found = followed(readings, LIFTED_S)
        assert len(surely_elsewhere(found, way)) < at_most_s
        assert off_m(found[-1][1], way(SECONDS)) < near_m
        assert sum(MOVES in text for text in noticed(readings)) == 1


@pytest.mark.parametrize("ranges", [True, False])
def test_looking_back_he_is_nowhere_surely_elsewhere(ranges: bool) -> None:
    """While a standstill was believed he was for half of the time and more."""
    for seed in range(3):
        for point in BatchSmoother().smooth(told(seed, ranges=ranges))["ff1"]:
            squared = outside(point.position_m, point.covariance_m2, way(int(point.t)))
            assert squared < SURE


@pytest.mark.parametrize("ranges", [True, False])
def test_who_stands_is_not_thought_to_be_carried(ranges: bool) -> None:
    for seed in range(3):
        readings = told(seed, ranges=ranges, carried=False)
        assert not any(MOVES in text for text in noticed(readings))
        tracker = KirchhoffTracker()
        tracker.fold(readings)
        assert off_m(shown(tracker), way(SECONDS, carried=False)) < (0.3 if ranges else 2.5)


@pytest.mark.parametrize("driven_m", [12.0, -12.0])
def test_a_fire_engine_that_is_driven_nearer_or_away_carries_nobody(driven_m: float) -> None:
    for seed in range(3):
        readings = told(seed, ranges=True, carried=False, driven_m=driven_m)
        assert not any(MOVES in text for text in noticed(readings))
        assert off_m(followed(readings, SECONDS)[-1][1], way(SECONDS, carried=False)) < 1.0


def test_no_breadcrumb_is_said_to_be_kicked_because_he_is_carried() -> None:
    for seed in range(3):
        texts = noticed(told(seed, ranges=True, crumbs=True))
        assert any(MOVES in text for text in texts)
        assert not any("it was kicked" in text for text in texts)


def test_he_is_carried_on_after_a_restart() -> None:
    assert_goes_on_alike(told(1, ranges=True), float(SET_DOWN_S - 5))
