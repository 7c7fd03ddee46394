"""Raw samples navigated to displacements, alone and by the whole tracker, held against the truth."""

from collections.abc import Sequence

import numpy as np

from estimator.estimate import Notice
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.navigation import navigate
from estimator.inertial.progress import Navigation
from estimator.inertial.samples import pieces
from estimator.measurements.displacement import Displacement
from estimator.measurements.imu import Imu
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, outside
from tests.estimator.inertial.gait import STEP_S, Gait, Stride

BLOCK = [*[Stride()] * 8, Stride(0.9, 0.785), Stride(0.9, 0.785)]
"""One side of a block, and a turn to the left."""


def entered(t: float, heading_rad: float = 0.0) -> Node:
    """ff1 at the door, who faces what he is told to."""
    return Node(
        t=t,
        node="ff1",
        role="responder",
        position_m=(0.0, 0.0, 0.0),
        sigma_m=0.1,
        heading_rad=heading_rad,
        heading_sigma_rad=0.02,
    )


def navigated(readings: list[Imu], heading_rad: float = 0.0) -> tuple[list[InertialDisplacement], list[str]]:
    """The displacements that `navigate` makes of readings, and its remarks on them."""
    known: Navigation | None = None
    found, texts = [], []
    for reading in readings:
        for piece in pieces(reading):
            done = navigate(known, piece, heading_rad)
            known = done.navigation
            found += done.displacements
            texts += [done.text] if done.text else []
    return found, texts


def total_m(displacements: Sequence[Displacement]) -> np.ndarray:
    """The sum of displacements, 3 (m)."""
    return np.asarray(np.sum(np.array([d.delta_m for d in displacements]), axis=0))


def true_m(gait: Gait, t: float) -> np.ndarray:
    """Where the boot really is, 3 (m)."""
    return np.array([np.interp(t, gait.t + STEP_S, gait.place_m[:, axis]) for axis in range(3)])


def track_boot(truth: Gait, felt: Gait, begins: Node) -> tuple[list[Notice], float]:
    """Fold a boot's samples into the tracker, and assert that its bearer is inside each ellipse shown.

    Returns:
        The notices given, and the largest error of a position shown (m).
    """
    tracker, notices, farthest_m = KirchhoffTracker(), list[Notice](), 0.0
    tracker.fold([begins])
    for reading in felt.readings():
        tracker.fold([reading])
        (found,) = tracker.estimates()
        notices += tracker.take_notices()
        there = truth.bearer_m(found.t)
        assert outside(found.position_m, found.covariance_m2, there) < INSIDE
        farthest_m = max(farthest_m, float(np.linalg.norm(np.array(found.position_m) - there)))
    return notices, farthest_m


def total_sigma_m(found: Sequence[Displacement]) -> float:
    """Standard deviation of the sum of displacements by their own sigmas, per axis (m)."""
    return float(np.sqrt(sum((d.sigma_m or 0.0) ** 2 for d in found)))
