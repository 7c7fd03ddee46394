"""What a displacement over a long time is unsure by: it tells where its bearer has come to, not his way.

A radio that was silent sends what its unit has summed up meanwhile as one displacement. Who has searched a
room comes back to its door: the way that he has walked is as long as he was gone, not as long as its chord.
And the unit's frame has turned on that way, by what its gyro is off.

About its chord nobody knows the way: it is a Brownian bridge B of rate q (`silence.wandered_m2`). Turned by
an angle w(t), its end moves by ∫ w dB, whose variance along each axis is q ∫ (w − w̄)² dt: q v T / 6 for a
random walk that has variance v at the end, and q β² T³ / 12 for a bias β.
"""

import math

from estimator.fusion import physics
from estimator.fusion.learned.calibration import Told

STRAIGHT_S = 4.0
"""Nobody's way over a longer time is a straight line."""
RATE_M2_PER_S = 2.0 * physics.SILENT_SPEED_MPS**2 * physics.SILENT_MEMORY_S
WALKED_MPS = math.sqrt(0.5 * math.pi) * physics.SILENT_SPEED_MPS
"""Mean speed of a bearer who walks with `SILENT_SPEED_MPS` along each axis."""


def walked_m(chord_m: float, span_s: float) -> float:
    """Length of the way behind a displacement of `chord_m` (m) over `span_s` (s)."""
    return max(chord_m, WALKED_MPS * (span_s - STRAIGHT_S))


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
