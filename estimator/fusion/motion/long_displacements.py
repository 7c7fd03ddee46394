"""What a displacement over a long time is unsure by: it tells where its bearer has come to, not his way.

A radio that was silent sends what its unit has summed up meanwhile as one displacement. Who has searched a
room comes back to its door: the way that he has walked is as long as he was gone, not as long as its chord.
And the unit's frame has turned on that way, by what its gyro is off.

About its chord nobody knows the way: it is a Brownian bridge B of rate q (`silence.wandered_m2`). Turned by
an angle w(t), its end moves by ∫ w dB, whose variance along each axis is q ∫ (w − w̄)² dt: q v T / 6 for a
random walk that has variance v at the end, and q β² T³ / 12 for a bias β.
"""

import math

import numpy as np

from estimator.fusion import physics
from estimator.fusion.learned.calibration import Told
from estimator.graph.dense import Array

STRAIGHT_S = 4.0
"""Nobody's way over a longer time is a straight line."""
BRIDGED_M_PER_ROOT_S = 1.0
"""A way over a longer time is a random walk between its ends."""
UPWARDS = np.array([1.0, 1.0, 0.1])
"""What such a walk is unsure by along each axis."""
ALIKE = 0.25
"""How much of a reading inside it is off as all others in it are, along one axis."""
RATE_M2_PER_S = 2.0 * physics.SILENT_SPEED_MPS**2 * physics.SILENT_MEMORY_S
WALKED_MPS = math.sqrt(0.5 * math.pi) * physics.SILENT_SPEED_MPS
"""Mean speed of a bearer who walks with `SILENT_SPEED_MPS` along each axis."""


def walked_m(chord_m: float, span_s: float) -> float:
    """Length of the way behind a displacement of `chord_m` (m) over `span_s` (s)."""
    return max(chord_m, WALKED_MPS * (span_s - STRAIGHT_S))


def bridged_m2(marks_t: Array, t: Array) -> Array:
    """Variance along each horizontal axis of a place inside displacements over a long time, m (m²).

    Only their two ends are known: between them the bearer may have walked anywhere, a Brownian bridge.

    Args:
        marks_t: epochs at which his unit's displacements begin and end, ascending (s).
        t: the epochs asked, m (s).
    """
    if len(marks_t) < 2:
        return np.zeros(len(t))
    right = np.clip(np.searchsorted(marks_t, t, side="left"), 1, len(marks_t) - 1)
    before, after = marks_t[right - 1], marks_t[right]
    span = after - before
    inside = (span > STRAIGHT_S) & (t > before) & (t < after)
    return np.where(
        inside, BRIDGED_M_PER_ROOT_S**2 * (t - before) * (after - t) / np.maximum(span, 1e-9), 0.0
    )


def alike(marks_t: Array, t: Array) -> Array:
    """How many times each of m readings is to be told what it is off by, for those beside it are off alike.

    However many there are in one displacement over a time T, all are off by the same way: the variance of
    their average is q T / 12, where that of each is q T / 6 on average; and half of them tell of either axis.
    So four count as one.

    Args:
        marks_t: see `bridged_m2`.
        t: epochs of the readings, m (s).
    """
    right = np.searchsorted(marks_t, t, side="left")
    return np.asarray(np.maximum(ALIKE * np.bincount(right, minlength=1)[right], 1.0))


def turned_m2(span_s: float, turn_rad2: float, bias_told: Told) -> float:
    """Variance along each axis that a frame's turning on an unknown way gives its end (m²).

    Args:
        span_s: how long the displacement lasted (s).
        turn_rad2: variance of the frame's random walk in that time (rad²).
        bias_told: what readings say of the gyro's bias: information (s²/rad²) and its product with the mean.
    """
    if span_s <= STRAIGHT_S:
        return 0.0
    bias2 = physics.BIAS_SIGMA_MOST_RADPS**2 / 3.0
    information, product = bias_told
    if information > 0.0:
        bias2 = min(1.0 / information + (product / information) ** 2, bias2)
    return RATE_M2_PER_S * span_s * (turn_rad2 / 6.0 + bias2 * span_s**2 / 12.0)
