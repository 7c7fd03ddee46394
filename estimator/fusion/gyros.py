"""How well the gyros of an incident's PDR units are calibrated, as the units themselves tell.

One unit's gyro turns by 0.03 degrees a second, another's by ten times that; the units of a crew are mostly
of one kind. What the readings alone say of each bias, d with variance v, is held against several spreads:
p ∝ Π N(d; 0, v + σ²), uniform in σ beforehand (Gelman 2006, "Prior distributions for variance parameters in
hierarchical models"). Of each bias the prior is the one Gaussian under which its mean is that of them all.
"""

import math
from collections.abc import Iterable

import numpy as np

from estimator.fusion import physics

SPREADS = ((np.arange(10) + 0.5) / 10.0 * physics.BIAS_SIGMA_MOST_RADPS) ** 2
"""Variances that stand for all (rad²/s²)."""
NOTHING = 1e-6
"""Share of the information on a bias below which readings have told nothing of it."""
UNTOLD = (0.0, 0.0)
Told = tuple[float, float]
"""What readings say of a bias without its prior: information (s²/rad²), and that times the bias (s/rad)."""


def told_of(sigma: float, estimate: float, variance: float) -> Told:
    """What an estimate says of a bias without its prior.

    Args:
        sigma: standard deviation of the prior, of mean 0, that the estimate was made with (rad/s).
        estimate: of the bias (rad/s).
        variance: of the estimate, the prior included (rad²/s²).
    """
    information = 1.0 / variance - 1.0 / sigma**2
    return UNTOLD if information * variance < NOTHING else (information, estimate / variance)


def bias_sigma_radps(own: Told, told: Iterable[Told]) -> float:
    """Standard deviation of the prior of a unit's bias (rad/s).

    Args:
        own: what is told of it.
        told: what is told of all units', its own included.
    """
    logarithm = np.zeros(len(SPREADS))
    for information, product in told:
        if information > 0.0:
            spread = 1.0 / information + SPREADS
            logarithm -= 0.5 * (np.log(spread) + (product / information) ** 2 / spread)
    weight = np.exp(logarithm - logarithm.max())
    weight /= weight.sum()
    if own[0] == 0.0:
        return math.sqrt(float(weight @ SPREADS))
    alone = 1.0 / own[0]
    drawn = float(weight @ (alone / (SPREADS + alone)))
    return math.sqrt(alone * (1.0 - drawn) / drawn)
