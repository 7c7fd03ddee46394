"""What readings alone say of a calibration, and whether a ranging technology is calibrated.

Its scale is nearly nil, or else wide. What the readings alone say of it, d with variance v, is held against
both kinds: p ∝ share · N(d; 0, v + σ²). The next solution has the prior of one of them.
"""

import math

from estimator.fusion import physics

NOTHING = 1e-6
"""Share of the information on a number below which readings have told nothing of it."""
UNTOLD = (0.0, 0.0)
Told = tuple[float, float]
"""What readings say of a number without its prior: information, and that times the number."""
TRUSTED = 0.25
"""Probability of not being calibrated below which a technology is taken for calibrated. One that is wrongly
trusted bends everything; one that is wrongly distrusted costs some sharpness."""


def told_of(sigma: float, estimate: float, variance: float) -> Told:
    """What an estimate says of a number without its prior; nothing where it is no better than that.

    Args:
        sigma: standard deviation of the prior, of mean 0, that the estimate was made with.
        estimate: of the number.
        variance: of the estimate, the prior included.
    """
    if not variance > 0.0:
        return UNTOLD
    information = 1.0 / variance - 1.0 / sigma**2
    return UNTOLD if information * variance < NOTHING else (information, estimate / variance)


def narrow_sigma(outliers: float, scatter: float = math.inf) -> float:
    """Standard deviation of a calibrated technology's scale among walls.

    The farther a range, the more walls it crosses, and each makes it longer: where many are clearly too
    long, the others are so too, about in proportion to their length. What walls make a range longer by
    scatters as much (`smoothing.readings.obstructed`): where the others hardly scatter, they are in sight,
    and the many are echoes that say nothing of them.

    Args:
        outliers: share of its ranges that are clearly too long, 0 to 1.
        scatter: what the others scatter by, over their length; infinite where nobody knows.
    """
    return math.hypot(physics.RANGE_SCALE_SIGMA, min(physics.OBSTRUCTED_SCALE * outliers, scatter))


def scale_sigma(share: float, narrow: float) -> float:
    """Standard deviation of the prior of a scale that is uncalibrated with probability `share`.

    Args:
        share: probability that it is not calibrated.
        narrow: standard deviation where it is.
    """
    return narrow if share < TRUSTED else physics.RANGE_SCALE_WIDE


def bias_sigma_m(technology: str) -> float:
    """Standard deviation of the prior of a technology's bias (m)."""
    return physics.RANGE_BIAS_SIGMA_M.get(technology, physics.RANGE_BIAS_OTHER_SIGMA_M)


def uncalibrated(sigma: float, estimate: float, variance: float, narrow: float) -> float:
    """Probability that a technology is not calibrated.

    Args:
        sigma: standard deviation of the prior, of mean 0, that the estimate was made with.
        estimate: of its scale error.
        variance: of the estimate, the prior included.
        narrow: standard deviation of the scale of a calibrated technology.
    """
    information, product = told_of(sigma, estimate, variance)
    if not information > 0.0:
        return physics.UNCALIBRATED
    alone = 1.0 / information
    said = product * alone
    odds = _logarithm(said, alone + physics.RANGE_SCALE_WIDE**2)
    odds -= _logarithm(said, alone + narrow**2)
    odds += math.log(physics.UNCALIBRATED / (1.0 - physics.UNCALIBRATED))
    return 1.0 / (1.0 + math.exp(min(max(-odds, -700.0), 700.0)))


def _logarithm(value: float, variance: float) -> float:
    """Of the density of N(0, variance), up to a constant."""
    return -0.5 * (math.log(variance) + value**2 / variance)
