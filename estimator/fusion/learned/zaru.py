"""Standing still tells the gyro bias: ZARU (decision 0020).

The true heading stays, so what the unit turns meanwhile is −β Δt. Reported headings are noisy, and their
noise is not told: β is the slope of a line through those of a standstill, and what they scatter about it says
how good it is. The longer the line, the better: cut into pieces of 5 s, half a minute tells a fifth.
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np

from estimator.fusion import physics


class Bias(NamedTuple):
    """A gyro bias and its standard deviation (rad/s)."""

    value: float
    sigma: float


class Standing(msgspec.Struct, frozen=True, array_like=True):
    """Headings that a unit has reported since it stands still, as far as they are not used yet.

    Attributes:
        since_t: epoch of the first one (s).
        t: of the newest one (s).
        heading_rad: the newest one.
        turned_rad: by how much it has turned since the first one.
        told: this standstill has told a bias before.
        sums: their number, and of their epochs τ and turns h since the first one Σ τ, Σ h, Σ τ², Σ τ h, Σ h².
    """

    since_t: float
    t: float
    heading_rad: float
    turned_rad: float = 0.0
    told: bool = False
    sums: tuple[float, float, float, float, float, float] = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def bias(self) -> Bias | None:
        """The bias that they show; None where they are too few."""
        lasted_s = self.t - self.since_t
        n, t1, h1, t2, th, h2 = self.sums
        if n < physics.STILL_READINGS or lasted_s < physics.STILL_S:
            return None
        spread = t2 - t1 * t1 / n
        slope = (th - t1 * h1 / n) / spread
        scatter = max(h2 - h1 * h1 / n - slope * slope * spread, 0.0)
        usual = physics.STILL_JITTER_READINGS
        variance = (scatter + usual * physics.STILL_JITTER_RAD**2) / (n - 2.0 + usual)
        # A random walk of the angle bends the line: 6/5 of its variance per time (its least-squares slope).
        walk = 1.2 * physics.GYRO_WALK_RAD_PER_ROOT_S**2 / lasted_s
        return Bias(-slope, math.sqrt(variance / spread + walk))


def stand_on(before: Standing | None, t: float, heading_rad: float) -> tuple[Standing, Bias | None]:
    """A unit that still stands reports its heading.

    Args:
        before: what it has reported since it stands; None: it just came to a stand.
        t: epoch (s).
        heading_rad: the heading.

    Returns:
        What is not used yet, and the bias where it is told now: the standstill was long, or ended by a turn
        or by a silence, in which the bearer may have turned.
    """
    if before is None:
        return Standing(t, t, heading_rad), None
    step = (heading_rad - before.heading_rad + np.pi) % (2.0 * np.pi) - np.pi
    since_s = t - before.t
    if since_s > physics.STILL_SILENT_S or abs(step) > physics.STILL_TURN_RADPS * max(since_s, 1.0):
        bias = before.bias()
        return Standing(t, t, heading_rad, told=before.told or bias is not None), bias
    n, t1, h1, t2, th, h2 = before.sums
    after, turned = t - before.since_t, before.turned_rad + step
    sums = n + 1.0, t1 + after, h1 + turned, t2 + after * after, th + after * turned, h2 + turned * turned
    standing = Standing(before.since_t, t, heading_rad, turned, before.told, sums)
    if after < physics.STILL_LONG_S or sums[0] < physics.STILL_READINGS:
        return standing, None
    return Standing(t, t, heading_rad, told=True), standing.bias()
