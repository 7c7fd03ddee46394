"""Units that count from another heading than they did (decisions 0087 and 0126)."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.simulate import scenario
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.trackers.entry import shown

SECONDS, TURNED_S, ASKED_S, LATE_S = 150, 60, 90, 115
ANCHORS_M = {"a0": (-16.0, -14.0), "a1": (16.0, -14.0), "a2": (16.0, 14.0), "a3": (-16.0, 14.0)}
STAYS_M = 4.0
Frame = Callable[[int], float]


def as_it_was(_: int) -> float:
    return 0.0


def on_again(second: int) -> float:
    """What a unit that was switched off and on again faces, against what it faced before (rad)."""
    return 2.0 if second > TURNED_S else 0.0


def late(second: int) -> float:
    """The same when a window knows well what it faced before (rad)."""
    return 2.0 if second > LATE_S else 0.0


def walk(
    frame: Frame, seed: int, off_s: int = 0, off_from_s: int = TURNED_S, ranged: bool = False
) -> tuple[list[AnyReading], Array]:
    """He walks from goal to goal among four radios, whose powers share half of their errors while he is near.

    Args:
        frame: how his unit's frame is turned, second by second (rad).
        seed: of chance.
        off_s: for how long it tells nothing (s).
        off_from_s: since when (s).
        ranged: he ranges to those four every other second, and to what he has dropped.
    """
    chance = np.random.default_rng(seed)
    at = goal = chance.uniform(-5.0, 5.0, 2)
    readings: list[AnyReading] = [_node(name, place) for name, place in ANCHORS_M.items()]
    readings.append(_node("ff1", at.tolist()))
    psi_rad, bias_radps, way = chance.normal(0.0, 0.05), math.radians(chance.normal(0.0, 0.15)), [at]
    beside_db = {name: chance.normal(0.0, 4.0) for name in ANCHORS_M}
    for second in range(1, SECONDS + 1):
        if np.hypot(*(goal - at)) < 1.0:
            goal = chance.uniform(-14.0, 14.0, 2)
        step_m = (goal - at) / max(1.0, float(np.hypot(*(goal - at))))
        at, psi_rad = at + step_m, psi_rad + bias_radps
        way.append(at)
        cosine, sine = math.cos(psi_rad + frame(second)), math.sin(psi_rad + frame(second))
        told_m = np.array([[cosine, sine], [-sine, cosine]]) @ step_m + chance.normal(0.0, 0.03, 2)
        if not off_from_s < second <= off_from_s + off_s:
            delta_m = (*told_m.tolist(), 0.0)
            readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=delta_m))
        kept = math.exp(-float(np.hypot(*step_m)) / STAYS_M)
        for name, place in ANCHORS_M.items():
            off_m = max(float(np.hypot(*(at - place))), 0.5)
            beside_db[name] = kept * beside_db[name] + math.sqrt(1.0 - kept**2) * chance.normal(0.0, 4.0)
            dbm = -42.0 - 25.0 * math.log10(off_m) + beside_db[name] + chance.normal(0.0, 4.0)
            readings.append(Rssi(t=float(second), a="ff1", b=name, dbm=dbm))
        if ranged:
            readings += _ranged(second, np.array(way), chance)
    return readings, np.array(way)


def _ranged(second: int, way: Array, chance: np.random.Generator) -> list[AnyReading]:
    """What he drops and ranges to in a second."""
    if second % 12 == 0 and second < TURNED_S:
        return [Drop(t=float(second), node=f"b{second}", by="ff1")]
    if second % 2:
        return []
    radios = ANCHORS_M | {f"b{s}": (way[s, 0], way[s, 1]) for s in range(12, min(second, TURNED_S), 12)}
    far_m = {
        name: float(np.hypot(*(way[-1] - place)) + chance.normal(0.0, 0.1)) for name, place in radios.items()
    }
    return [
        Range(t=float(second), a="ff1", b=name, range_m=max(off_m, 0.0), technology="uwb")
        for name, off_m in far_m.items()
    ]


def _node(name: str, place_m: tuple[float, float] | list[float]) -> Node:
    responder, (east, north) = name == "ff1", place_m
    return Node(
        t=0.0,
        node=name,
        role="responder" if responder else "anchor",
        position_m=(east, north, 0.0),
        sigma_m=0.3 if responder else 0.1,
        heading_sigma_rad=0.05 if responder else None,
    )


def followed(readings: list[AnyReading], way: Array) -> tuple[int, int]:
    """For how many seconds he is shown elsewhere, and sure of it; and how often a turn is told."""
    tracker, wrong, told = KirchhoffTracker(), 0, 0
    for second in range(SECONDS + 1):
        tracker.fold([r for r in readings if r.t == second])
        told += sum("faces elsewhere" in notice.text for notice in tracker.take_notices())
        found = shown(tracker)
        wrong += outside(found.position_m, found.covariance_m2, way[second]) > SURE
    return wrong, told


@pytest.mark.parametrize(("off_s", "at_most_s"), [(0, 100), (8, 50)])
def test_who_switches_his_unit_off_and_on_is_not_shown_elsewhere_as_sure_for_long(
    off_s: int, at_most_s: int
) -> None:
    """Of 270 seconds: while nobody asked whether its frame had turned, it was for 133 and 94."""
    wrong, told = zip(*(followed(*walk(on_again, seed, off_s)) for seed in (0, 2, 4)), strict=True)
    assert sum(wrong) < at_most_s
    assert told == (1, 1, 1)


@pytest.mark.parametrize("off_s", [0, 8])
def test_no_breadcrumb_seems_to_be_kicked_because_who_is_ranged_has_turned(off_s: int) -> None:
    """Four breadcrumbs of one walk did, and he was shown 24 m off."""
    for seed in (1, 2, 5):
        readings, way = walk(late, seed, off_s, LATE_S, ranged=True)
        tracker, texts = KirchhoffTracker(), list[str]()
        for second in range(SECONDS + 1):
            tracker.fold([r for r in readings if r.t == second])
            texts += [notice.text for notice in tracker.take_notices()]
            found = shown(tracker)
            assert outside(found.position_m, found.covariance_m2, way[second]) < SURE
        assert not any("kicked" in text for text in texts)
        assert any("faces elsewhere" in text or "different ways" in text for text in texts)


@pytest.mark.parametrize("off_s", [0, 8])
def test_looking_back_who_is_ranged_is_where_he_was_though_his_unit_has_turned(off_s: int) -> None:
    """He was surely elsewhere for 24 to 35 seconds of each walk."""
    for seed in (1, 2, 5):
        readings, way = walk(late, seed, off_s, LATE_S, ranged=True)
        track = BatchSmoother().smooth(readings)["ff1"]
        assert sum(outside(p.position_m, p.covariance_m2, way[int(p.t)]) > SURE for p in track) < 3


@pytest.mark.parametrize("off_s", [0, 8])
def test_a_unit_that_faces_what_it_faced_is_believed(off_s: int) -> None:
    for seed in (0, 2, 3):
        assert followed(*walk(as_it_was, seed, off_s)) == (0, 0)


def test_a_kicked_breadcrumb_is_no_turn_of_who_hears_it() -> None:
    for seed in range(2):
        tracker = KirchhoffTracker()
        tracker.fold(scenario("kicked-breadcrumb", seed).readings)
        tracker.estimates()
        assert not any("faces elsewhere" in notice.text for notice in tracker.take_notices())


def test_who_may_have_turned_is_doubted_alike_after_a_restart() -> None:
    readings, _ = walk(on_again, 0)
    tracker = KirchhoffTracker()
    tracker.fold([r for r in readings if r.t <= ASKED_S])
    again = KirchhoffTracker.restore(tracker.snapshot())
    for one in (tracker, again):
        one.fold([r for r in readings if r.t > ASKED_S])
    assert again.estimates() == tracker.estimates()
