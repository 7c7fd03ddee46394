"""How well the gyros of an incident's PDR units are calibrated, as the units themselves tell.

One unit's gyro turns by 0.03 degrees a second, another's by ten times that; the units of a crew are mostly
of one kind. What the readings alone say of each bias, d with variance v, is held against several spreads:
p ∝ Π N(d; 0, v + σ²), uniform in σ beforehand (Gelman 2006, "Prior distributions for variance parameters in
hierarchical models"). Of each bias the prior is the one Gaussian under which its mean is that of them all, or
a wider one where they leave it less sure: of a bad unit in a good crew they say two things. It is none wider
than the widest of them.
"""

import math
from collections.abc import Iterable

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.fusion.learned.calibration import Told
from estimator.graph.dense import Array

SPREADS = ((np.arange(10) + 0.5) / 10.0 * physics.BIAS_SIGMA_MOST_RADPS) ** 2
"""Variances that stand for all (rad²/s²)."""


def bias_sigma_radps(own: Told, told: Iterable[Told]) -> float:
    """Standard deviation of the prior of a unit's bias (rad/s).

    Args:
        own: what readings alone say of it (s²/rad², s/rad).
        told: what they say of all units', its own included.

    Returns:
        It, at least what all spreads together give to the mean and to the variance of the bias, and at most
        the widest of them.
    """
    said = [one for one in told if one[0] > 0.0]
    return prior_sigma_radps(*own, np.array(said, dtype=np.float64).reshape(-1, 2))


@njit(cache=True, error_model="numpy")
def prior_sigma_radps(information: float, product: float, told: Array) -> float:
    """`bias_sigma_radps` of a unit about whose bias readings say these two things.

    Args:
        information: what they say of it (s²/rad²); nil: nothing.
        product: the same (s/rad).
        told: what they say of each unit of which they say anything, m × 2.
    """
    logarithm = np.zeros(len(SPREADS))
    for i in range(len(told)):
        spread = 1.0 / told[i, 0] + SPREADS
        logarithm -= 0.5 * (np.log(spread) + (told[i, 1] / told[i, 0]) ** 2 / spread)
    weight = np.exp(logarithm - logarithm.max())
    weight /= weight.sum()
    if not information > 0.0:
        return math.sqrt((weight * SPREADS).sum())
    alone = 1.0 / information
    share = SPREADS / (SPREADS + alone)
    mean = (weight * share).sum()
    # The variance that all spreads together leave, over that of the readings alone.
    left = mean + (product**2 / information) * (weight * (share - mean) ** 2).sum()
    kept = min(max(mean, left), share.max())
    return math.sqrt(alone * kept / (1.0 - kept))
