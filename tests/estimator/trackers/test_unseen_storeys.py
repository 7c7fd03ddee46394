"""Who climbs a stair, where neither his unit nor anything else measures heights, is where ranges have him."""

from itertools import pairwise

import numpy as np
import pytest

from estimator.estimate import Covariance6, Vector3
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE

STOREY_M = 3.5
CORNERS_M = ((0.0, 0.0), (24.0, 0.0), (24.0, 12.0), (0.0, 12.0), (0.0, 0.0))
"""Of the corridors of each storey; the stair goes up at the entry."""
STAIR = 8
"""Seconds on the stair, 0.8 m to the side in each: there and back."""
REACH_M, DROPS_S = 18.0, (8, 20, 32, 44, 56, 68)


def way_m() -> Array:
    """Round the ground floor, up the stair, round the floor above at 1 m/s: second by second, k × 3 (m)."""
    lap = [np.array(CORNERS_M[0])]
    for since, until in pairwise(np.array(CORNERS_M)):
        off = until - since
        long = round(float(np.hypot(*off)))
        lap += [since + off * k / long for k in range(1, long + 1)]
    ground = np.column_stack([np.array(lap), np.zeros(len(lap))])
    out = [*range(1, STAIR // 2 + 1), *range(STAIR // 2 - 1, -1, -1)]
    stair = np.array([(-0.8 * e, 0.0, STOREY_M * (k + 1) / STAIR) for k, e in enumerate(out)])
    return np.concatenate([ground, stair, ground[1:] + np.array([0.0, 0.0, STOREY_M])])


def climbs(seed: int) -> tuple[list[AnyReading], Array]:
    """What is posted of him, and his way."""
    chance, way = np.random.default_rng(seed), way_m()
    radios = {"base": way[0]}
    readings: list[AnyReading] = [
        Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.2),
    ]
    for second in range(1, len(way)):
        e, n = (way[second, :2] - way[second - 1, :2] + chance.normal(0.0, 0.03, 2)).tolist()
        readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(e, n, 0.0)))
        for name, at in radios.items():
            off_m = float(np.linalg.norm(way[second] - at))
            if off_m < REACH_M:
                range_m = abs(off_m + float(chance.normal(0.0, 0.15)))
                readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
        if second in DROPS_S:
            radios[f"b{second}"] = way[second]
            readings.append(Drop(t=float(second), node=f"b{second}", by="ff1"))
    return readings, way


def stays(seed: int, way: Array) -> list[AnyReading]:
    """What is posted of another one, who goes round the ground floor as long as somebody else's way takes."""
    chance, lap = np.random.default_rng((seed, 2)), way[: len(way) // 2]
    readings: list[AnyReading] = [
        Node(t=0.0, node="ff2", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.2)
    ]
    for second in range(1, len(way)):
        was, now = lap[(second - 1) % (len(lap) - 1)], lap[second % (len(lap) - 1)]
        e, n = (now[:2] - was[:2] + chance.normal(0.0, 0.03, 2)).tolist()
        readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff2", delta_m=(e, n, 0.0)))
        for name, at in [("base", way[0]), *((f"b{t}", way[t]) for t in DROPS_S if t < second)]:
            off_m = float(np.linalg.norm(now - at))
            if off_m < REACH_M:
                range_m = abs(off_m + float(chance.normal(0.0, 0.15)))
                readings.append(Range(t=float(second), a="ff2", b=name, range_m=range_m, technology="uwb"))
    return readings


def off(position_m: Vector3, covariance_m2: Covariance6, at: Array) -> tuple[float, float]:
    """How far off he is shown in the plane (m), and that squared by what is said."""
    ee, en, _, nn, _, _ = covariance_m2
    error = np.array(position_m[:2]) - at[:2]
    squared = float(error @ np.linalg.solve(np.array([[ee, en], [en, nn]]), error))
    return float(np.hypot(*error)), squared


@pytest.mark.parametrize("seed", range(3))
def test_he_is_shown_where_ranges_from_the_floor_below_have_him(seed: int) -> None:
    readings, way = climbs(seed)
    tracker, found = KirchhoffTracker(), []
    for second in range(len(way)):
        tracker.fold([r for r in readings if second - 1 < r.t <= second])
        shown = next(e for e in tracker.estimates() if e.node == "ff1")
        assert shown.position_m is not None
        assert shown.covariance_m2 is not None
        found.append(off(shown.position_m, shown.covariance_m2, way[second]))
    off_m, squared = np.array(found[5:]).T
    assert off_m.mean() < 0.5
    assert (squared > SURE).sum() < 3


@pytest.mark.parametrize("seed", range(3))
def test_the_smoothed_view_has_him_there_too(seed: int) -> None:
    readings, way = climbs(seed)
    track = BatchSmoother().smooth(readings)["ff1"]
    found = [off(p.position_m, p.covariance_m2, way[round(p.t)]) for p in track]
    off_m, squared = np.array(found).T
    assert off_m.mean() < 0.4
    assert (squared > SURE).sum() == 0


def test_his_storey_is_unsure_whichever_of_two_heights_ranges_have_led_to() -> None:
    readings, way = climbs(0)
    tracker = KirchhoffTracker()
    tracker.fold(readings)
    shown = next(e for e in tracker.estimates() if e.node == "ff1")
    assert shown.position_m is not None
    assert shown.covariance_m2 is not None
    assert abs(shown.position_m[2] - way[-1, 2]) < 2.45 * np.sqrt(shown.covariance_m2[5])
    assert np.sqrt(shown.covariance_m2[5]) > STOREY_M / 2.0


@pytest.mark.parametrize("seed", range(3))
def test_who_keeps_to_the_ground_is_left_there_when_another_one_climbs(seed: int) -> None:
    readings, way = climbs(seed)
    tracks = BatchSmoother().smooth([*readings, *stays(seed, way)])
    rose_m = {name: np.ptp([p.position_m[2] for p in tracks[name]]) for name in ("ff1", "ff2")}
    assert rose_m["ff1"] > 0.5 * STOREY_M
    assert rose_m["ff2"] < 0.5


def test_on_one_floor_nobody_is_led_off_it_by_what_ranges_scatter() -> None:
    readings, way = climbs(0)
    on_ground = [r for r in readings if r.t < len(way) // 2]
    tracker = KirchhoffTracker()
    tracker.fold(on_ground)
    shown = next(e for e in tracker.estimates() if e.node == "ff1")
    assert shown.position_m is not None
    assert abs(shown.position_m[2]) < 0.5
