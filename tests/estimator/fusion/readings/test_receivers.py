"""What the fixes of somebody who flies have in common is not averaged away."""

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import outside

SIGMA_M = (1.0, 1.0, 1.5)
OUT_M = 20.0


def flown(seconds: int, off_m: float, sigma_m: tuple[float, float, float] = SIGMA_M) -> list[AnyReading]:
    """A UAV flies round a breadcrumb and ranges it; its fixes are off by the same to the east."""
    chance = np.random.default_rng(3)
    crumb = np.array([4.0, -2.0, 0.0])
    readings: list[AnyReading] = [Node(t=0.0, node="uav", role="uav")]
    for second in range(1, seconds + 1):
        turn = 2.0 * np.pi * second / 70.0
        there = np.array([OUT_M * np.cos(turn), OUT_M * np.sin(turn), 10.0])
        fix = there + np.array([off_m, 0.0, 0.0]) + chance.normal(0.0, 1.0, 3) * 0.5 * np.array(sigma_m)
        east, north, up = fix.tolist()
        t = second + 0.25
        readings.append(Position(t=t, node="uav", position_m=(east, north, up), sigma_m=sigma_m))
        range_m = float(np.linalg.norm(there - crumb) + chance.normal(0.0, 0.1))
        readings.append(Range(t=t, a="uav", b="b1", range_m=range_m, technology="uwb"))
    return readings


@pytest.mark.parametrize("seconds", [60, 150])
def test_a_hundred_fixes_are_as_unsure_as_what_all_of_them_are_off_by(seconds: int) -> None:
    tracker = KirchhoffTracker()
    tracker.fold(flown(seconds, off_m=1.5))
    found = {one.node: one for one in tracker.estimates()}
    crumb, uav = found["b1"], found["uav"]
    assert crumb.covariance_m2 is not None
    assert uav.covariance_m2 is not None
    assert min(crumb.covariance_m2[0], uav.covariance_m2[0]) > 0.45 * SIGMA_M[0] ** 2
    assert outside(crumb.position_m, crumb.covariance_m2, (4.0, -2.0)) < 5.99


def test_where_it_is_beside_what_it_ranges_is_known_better_than_where_both_are() -> None:
    tracker = KirchhoffTracker()
    tracker.fold(flown(100, off_m=0.0))
    between = tracker.relative("uav", "b1")
    (crumb,) = (one for one in tracker.estimates() if one.node == "b1")
    assert between is not None
    assert crumb.covariance_m2 is not None
    assert between.covariance_m2[0] < 0.7 * crumb.covariance_m2[0]


def test_fixes_that_are_told_to_be_better_are_off_by_something_else() -> None:
    """Once corrections come, nobody is as unsure any longer as without them."""
    tracker = KirchhoffTracker()
    better = [r for r in flown(100, off_m=0.0, sigma_m=(0.1, 0.1, 0.15)) if r.t > 50.0]
    tracker.fold([r for r in flown(100, off_m=2.0) if r.t < 50.0] + better)
    found = {one.node: one for one in tracker.estimates()}["b1"]
    assert outside(found.position_m, found.covariance_m2, (4.0, -2.0)) < 5.99
    assert found.covariance_m2 is not None
    assert found.covariance_m2[0] < 0.5
