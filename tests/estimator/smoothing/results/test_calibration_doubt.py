"""A ranging technology of which readings hardly tell whether it is calibrated."""

import math

import numpy as np
import pytest

from estimator.estimate import TrackPoint
from estimator.fusion.learned.calibration import TRUSTED
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, outside
from tests.estimator.smoothing.windows import entered, fused

SECONDS, LAP_S, RADIUS_M = 240, 80, 15.0
BEACONS = {"b1": (10.0, 25.0), "b2": (-22.0, 10.0), "b3": (5.0, -5.0)}
LONGER = 1.035
"""Of ranges: his steps, which are as long as they are told, may as well be too short by as much."""


def place(second: float) -> np.ndarray:
    """Where he is on his round, which begins at the origin (m)."""
    turn = 2.0 * math.pi * second / LAP_S
    return RADIUS_M * np.array([math.sin(turn), 1.0 - math.cos(turn)])


def incident() -> list[AnyReading]:
    """Three rounds past beacons that nobody has surveyed."""
    chance = np.random.default_rng(2)
    readings: list[AnyReading] = [entered(), *(Node(t=0.0, node=b, role="beacon") for b in BEACONS)]
    for second in range(1, SECONDS + 1):
        step = place(second) - place(second - 1) + chance.normal(0.0, 0.01, 2)
        delta_m = (float(step[0]), float(step[1]), 0.0)
        readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=delta_m))
        for beacon, at_m in BEACONS.items():
            range_m = LONGER * math.dist(place(second), at_m) + float(chance.normal(0.0, 0.1))
            readings.append(Range(t=float(second), a="ff1", b=beacon, range_m=range_m, technology="uwb"))
    return readings


def inside(points: list[TrackPoint]) -> float:
    """Share of his true places that the ellipses hold."""
    held = [outside(p.position_m, p.covariance_m2, place(p.t)) < INSIDE for p in points]
    return sum(held) / len(held)


def test_it_is_taken_for_calibrated_and_is_not() -> None:
    """Or the others would show nothing."""
    assert 0.05 < fused(incident()).calibrations["uwb"].uncalibrated < TRUSTED


def test_the_smoothed_view_holds_what_a_map_that_is_too_large_shows_elsewhere() -> None:
    assert inside(BatchSmoother(TrackerSettings()).smooth(incident())["ff1"]) >= 0.9


def test_the_live_picture_holds_it_as_well() -> None:
    tracker, readings, shown = KirchhoffTracker(), incident(), list[TrackPoint]()
    for second in range(SECONDS + 1):
        tracker.fold([r for r in readings if second - 1 < r.t <= second])
        found = next(e for e in tracker.estimates() if e.node == "ff1")
        assert found.position_m is not None
        assert found.covariance_m2 is not None
        shown.append(TrackPoint(t=found.t, position_m=found.position_m, covariance_m2=found.covariance_m2))
    assert inside(shown) >= 0.9


@pytest.mark.parametrize("node", ["ff1", "b1"])
def test_evidence_is_as_unsure_of_it(node: str) -> None:
    smoother, readings = BatchSmoother(TrackerSettings()), incident()
    evidence = smoother.evidence(readings, node)
    assert evidence is not None
    last = smoother.smooth(readings)[node][-1]
    assert evidence.covariance_m2 == pytest.approx(last.covariance_m2, rel=0.02, abs=1e-4)
