"""How well the gyros of an incident's PDR units are calibrated, as the units themselves tell.

One unit's gyro turns by 0.03 degrees a second, another's by ten times that; the units of a crew are mostly
of one kind. What the readings alone say of each bias, d with variance v, is held against several spreads:
p ∝ Π N(d; 0, v + σ²), uniform in σ beforehand (Gelman 2006, "Prior distributions for variance parameters in
hierarchical models"). Of each bias the prior is the one Gaussian that leaves of it the mean square which they
all leave: of a bad unit in a good crew they say two things. It is none wider than the widest of them.
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
        It, which leaves to the bias the mean square that all spreads together leave to it. Of the Gaussians
        that a prior may leave that one is nearest to what they leave (Kullback-Leibler divergence).
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
    # All in variances of what the readings alone say: a share s of it kept leaves the mean square s + s² m.
    m = product**2 / information
    square = (weight * (share + m * share**2)).sum()
    kept = min(2.0 * square / (1.0 + math.sqrt(1.0 + 4.0 * m * square)), share.max())
    return math.sqrt(alone * kept / (1.0 - kept))
