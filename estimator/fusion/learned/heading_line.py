"""What headings that ought to stay, and do not, tell of a gyro's bias: the slope of a line through them."""

import math
from typing import NamedTuple, Self

import msgspec
import numpy as np

from estimator.fusion import physics

Sums = tuple[float, float, float, float, float, float]


class Bias(NamedTuple):
    """A gyro bias and its standard deviation (rad/s)."""

    value: float
    sigma: float


class HeadingLine(msgspec.Struct, frozen=True, array_like=True):
    """Headings in a unit's frame that follow each other while the true one stays.

    Attributes:
        since_t: epoch of the first one (s).
        t: of the newest one (s).
        heading_rad: the newest one.
        turned_rad: by how much it has turned since the first one.
        sums: their number, and of their epochs τ and turns h since the first one Σ τ, Σ h, Σ τ², Σ τ h, Σ h².
    """

    since_t: float
    t: float
    heading_rad: float
    turned_rad: float = 0.0
    sums: Sums = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    @property
    def lasted_s(self) -> float:
        """From the first one to the newest one (s)."""
        return self.t - self.since_t

    @property
    def number(self) -> float:
        """How many they are."""
        return self.sums[0]

    def step_rad(self, heading_rad: float) -> float:
        """By how much a heading has turned since the newest one (rad)."""
        return float((heading_rad - self.heading_rad + np.pi) % (2.0 * np.pi) - np.pi)

    def off_rad(self, heading_rad: float) -> float:
        """By how much a heading differs from the mean of them (rad)."""
        return self.turned_rad + self.step_rad(heading_rad) - self.sums[2] / self.number

    def extended(self, t: float, heading_rad: float) -> Self:
        """The line with one more heading."""
        n, t1, h1, t2, th, h2 = self.sums
        after, turned = t - self.since_t, self.turned_rad + self.step_rad(heading_rad)
        sums = n + 1.0, t1 + after, h1 + turned, t2 + after * after, th + after * turned, h2 + turned * turned
        return type(self)(self.since_t, t, heading_rad, turned, sums)

    def bias(self, jitter_rad: float, walk_rad2_per_s: float) -> Bias:
        """The bias that they show: β = −slope, for the true heading stays (decision 0020).

        Args:
            jitter_rad: noise of a heading, before their own scatter has told.
            walk_rad2_per_s: variance that the angle of the unit's frame gains each second.
        """
        n, t1, h1, t2, th, h2 = self.sums
        spread = t2 - t1 * t1 / n
        slope = (th - t1 * h1 / n) / spread
        scatter = max(h2 - h1 * h1 / n - slope * slope * spread, 0.0)
        usual = physics.STILL_JITTER_READINGS
        variance = (scatter + usual * jitter_rad**2) / (n - 2.0 + usual)
        # A random walk of the angle bends the line: 6/5 of its variance per time (its least-squares slope).
        walk = 1.2 * walk_rad2_per_s / self.lasted_s
        return Bias(-slope, math.sqrt(variance / spread + walk))
