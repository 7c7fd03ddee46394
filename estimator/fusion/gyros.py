"""How well the gyros of an incident's PDR units are calibrated, as the units themselves tell.

One unit's gyro turns by 0.03 degrees a second, another's by ten times that; the units of a crew are mostly
of one kind. What the readings alone say of each bias, d with variance v, is held against several spreads:
p ∝ Π N(d; 0, v + σ²), uniform in σ beforehand (Gelman 2006, "Prior distributions for variance parameters in
hierarchical models"). Of each bias the prior is the one Gaussian under which its mean is that of them all, or
a wider one where they leave it less sure: of a bad unit in a good crew they say two things.
"""

import math
from collections.abc import Iterable

import numpy as np

from estimator.fusion import physics
from estimator.fusion.calibration import Told

SPREADS = ((np.arange(10) + 0.5) / 10.0 * physics.BIAS_SIGMA_MOST_RADPS) ** 2
"""Variances that stand for all (rad²/s²)."""
MOST_KEPT = 0.999
"""A prior that keeps more of what readings say of a bias is none."""


def bias_sigma_radps(own: Told, told: Iterable[Told]) -> float:
    """Standard deviation of the prior of a unit's bias (rad/s).

    Args:
        own: what readings alone say of it (s²/rad², s/rad).
        told: what they say of all units', its own included.

    Returns:
        It, at least what all spreads together give to the mean and to the variance of the bias.
    """
    logarithm = np.zeros(len(SPREADS))
    for information, product in told:
        if information > 0.0:
            spread = 1.0 / information + SPREADS
            logarithm -= 0.5 * (np.log(spread) + (product / information) ** 2 / spread)
    weight = np.exp(logarithm - logarithm.max())
    weight /= weight.sum()
    if not own[0] > 0.0:
        return math.sqrt(float(weight @ SPREADS))
    alone = 1.0 / own[0]
    share = SPREADS / (SPREADS + alone)
    mean = float(weight @ share)
    # The variance that all spreads together leave, over that of the readings alone.
    left = mean + (own[1] ** 2 / own[0]) * float(weight @ (share - mean) ** 2)
    kept = min(max(mean, left), MOST_KEPT)
    return math.sqrt(alone * kept / (1.0 - kept))
