"""How the readings of a window are weighed: by their noise, and by how far off the estimate may be."""

import numpy as np

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RSSI
from estimator.graph.dense import Array
from estimator.graph.robust import Weighted, weigh
from estimator.smoothing.readings.rows import Rows

SLACK_DB_PER_M = 4.0
"""What a metre makes of a signal's power a few metres away."""


def weigh_readings(rows: Rows, residual: Array, slack_m: float, doubt: Array | None) -> Weighted:
    """E-step of the readings' noise, as large as the estimate may be off.

    Else readings a metre off pull with all their weight (graduated non-convexity, Blake, Zisserman).

    Args:
        rows: the readings.
        residual: z − h(x) − shift, m.
        slack_m: how far off places may be (m): gyro biases are then as unsure as biases are.
        doubt: variance of each h(x) by what is not solved yet, m; None: all is.
    """
    sigma = rows.sigma
    unsure = np.zeros(len(residual)) if doubt is None else doubt
    if slack_m > 0.0:
        sigma = loosened(rows, slack_m)
        unsure = np.where(rows.turns, physics.BIAS_SIGMA_MOST_RADPS**2, unsure)
    noise = rows.noise.T

    def weighed(first: int, last: int) -> Weighted:
        own = slice(first, last)
        return weigh(residual[own], sigma[own], unsure[own], *noise[:, own])

    shares = rows.in_shares(weighed)
    return shares[0] if len(shares) == 1 else Weighted(*map(np.concatenate, zip(*shares, strict=True)))


def loosened(rows: Rows, slack_m: float) -> Array:
    """Standard deviation of each reading's good noise where places may be off, m.

    Args:
        rows: the readings.
        slack_m: how far off (m).
    """
    slack = np.where(rows.turns, 0.0, slack_m)
    slack[: len(rows.pairs)][rows.pairs[:, 1] == RSSI] *= SLACK_DB_PER_M
    return np.asarray(np.hypot(rows.sigma, slack))
