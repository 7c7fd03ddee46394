"""Where readings of samples lead a boot, and where they lead by what it says."""

from collections.abc import Sequence

import numpy as np

from estimator.inertial.navigation import Led, Navigation, navigate
from estimator.inertial.samples import pieces
from estimator.measurements.displacement import Displacement
from estimator.measurements.imu import Imu
from tests.estimator.inertial.gait import STEP_S, Gait


def followed(readings: list[Imu], heading_rad: float = 0.0) -> tuple[list[Led], list[str]]:
    """The displacements that readings lead to, and what is said of them."""
    known: Navigation | None = None
    found, texts = [], []
    for reading in readings:
        for piece in pieces(reading):
            done = navigate(known, piece, heading_rad)
            known = done.navigation
            found += done.displacements
            texts += [done.text] if done.text else []
    return found, texts


def where(displacements: Sequence[Displacement]) -> np.ndarray:
    """Their sum, 3 (m)."""
    return np.asarray(np.sum(np.array([d.delta_m for d in displacements]), axis=0))


def true_m(gait: Gait, t: float) -> np.ndarray:
    """Where the boot really is, 3 (m)."""
    return np.array([np.interp(t, gait.t + STEP_S, gait.place_m[:, axis]) for axis in range(3)])


def unsure_m(found: Sequence[Displacement]) -> float:
    """The standard deviation that the sum of displacements has by what they say (m)."""
    return float(np.sqrt(sum((d.sigma_m or 0.0) ** 2 for d in found)))
