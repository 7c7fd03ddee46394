"""What a boot's navigation has led to since it was told last, as a displacement that may be believed."""

import numpy as np

from estimator.inertial.boot import Boot
from estimator.inertial.displacement import InertialDisplacement, displacement_of
from estimator.inertial.free_navigation import add_doubt

STRETCHES = 2.0
"""Forces are summed up twice: a way is too long by twice as much as its time."""
FASTEST_MPS = 25.0
"""A runner's boot swings twice as fast as he runs."""


def plausible_displacement(
    boot: Boot, node: str, span: tuple[float, float], unsure_m2: float, stretched_m: float, pace_sigma: float
) -> tuple[list[InertialDisplacement], float]:
    """The displacement over a span of time.

    Args:
        boot: its navigation at the end of it; its place counts from the beginning.
        node: whose it is.
        span: when it begins and ends (s).
        unsure_m2: variance of its place by what has been bridged in it (m²).
        stretched_m: by how much its way may be too long or too short in all before it (m).
        pace_sigma: what the pace of its clock is off by, as a share.

    Returns:
        The displacement, unless it is nonsense; and `stretched_m` after it.
    """
    from_t, t = span
    add_doubt(boot, t - from_t)
    stretch_m = STRETCHES * pace_sigma * float(np.sqrt(np.dot(boot.held.place, boot.held.place)))
    unsure_m2 += stretch_m * (stretch_m + 2.0 * stretched_m)
    found = [displacement_of(boot, node, from_t, t, unsure_m2)] if _sound(boot) else []
    return found, stretched_m + stretch_m


def _sound(boot: Boot) -> bool:
    """Whether it moves as a boot may, and knows how well it knows that."""
    speed = float(np.sqrt(np.dot(boot.held.velocity, boot.held.velocity)))
    return speed < FASTEST_MPS and all(bool(np.isfinite(array).all()) for array in (*boot.held, *boot.free))
