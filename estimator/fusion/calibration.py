"""Whether an instrument is calibrated: its scale nearly nil, or else wide.

Which one is told by what the readings alone say of these numbers, d with information D, against both priors:
p ∝ share · N(d; 0, D⁻¹ + prior). The next solution has the prior of the likelier kind.
"""

from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.graph.dense import Array

TRUSTED = 0.1
"""Probability of being uncalibrated below which an instrument is taken for calibrated: one that is wrongly
trusted bends everything, one that is wrongly distrusted costs some sharpness for a while."""


class Kinds(NamedTuple):
    """The two kinds of an instrument.

    Attributes:
        narrow: standard deviations of its numbers where it is calibrated, n.
        wide: the same where it is not, n.
        usual: how many are not, 0 to 1.
    """

    narrow: Array
    wide: Array
    usual: float

    def information(self, share: float) -> Array:
        """Information of the prior where an instrument is uncalibrated with probability `share`, n."""
        return np.asarray((self.narrow if share < TRUSTED else self.wide) ** -2.0)


def of_technology(name: str) -> Kinds:
    """Scale and bias (m) of a ranging technology."""
    bias = physics.RANGE_BIAS_SIGMA_M.get(name, physics.RANGE_BIAS_OTHER_SIGMA_M)
    narrow, wide = (physics.RANGE_SCALE_SIGMA, bias), (physics.RANGE_SCALE_WIDE, bias)
    return Kinds(np.array(narrow), np.array(wide), physics.UNCALIBRATED)


def uncalibrated(kinds: Kinds, share: float, estimate: Array, covariance: Array) -> float:
    """Probability that an instrument is not calibrated.

    Args:
        kinds: what it may be.
        share: the probability with which `estimate` was made.
        estimate: its numbers, n.
        covariance: of them, the prior included, n × n.
    """
    prior = np.diag(kinds.information(share))
    known = np.linalg.inv(covariance)
    values, vectors = np.linalg.eigh(known - prior)
    told = values > 1e-6 * known.diagonal().max()
    if not told.any():
        return kinds.usual
    axes = vectors[:, told]
    said = (axes.T @ (known @ estimate)) / values[told]
    odds = []
    for sigma, probability in ((kinds.narrow, 1.0 - kinds.usual), (kinds.wide, kinds.usual)):
        spread = np.diag(1.0 / values[told]) + axes.T @ np.diag(sigma**2) @ axes
        _, logarithm = np.linalg.slogdet(spread)
        odds.append(np.log(probability) - 0.5 * (logarithm + said @ np.linalg.solve(spread, said)))
    return float(1.0 / (1.0 + np.exp(np.clip(odds[0] - odds[1], -700.0, 700.0))))
