"""What a Kirchhoff state foretells of the ranges and powers of a tick before it takes them in, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion.learned import rival
from estimator.fusion.learned.rival import TOLD
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.rows.joint_covariance import variances
from estimator.fusion.rows.prediction import Prediction
from estimator.fusion.rows.rows import (
    A_E,
    B_E,
    EXTRA,
    KIND,
    LINK,
    NOMINAL,
    OUTLIERS,
    SIGMA,
    A,
    B,
)
from estimator.graph.dense import Array, Indices
from estimator.measurements.rssi import rssi_at

NOISIER = 1.5
"""So many times the claimed or assumed sigma at most: what a bad unit has made of it is not to excuse it."""


EXPONENT = 7
"""Which of the numbers that a power depends on is its exponent."""


class PredictedPairs(NamedTuple):
    """Ranges and powers between a unit's bearer and somebody else.

    Attributes:
        told: see `rival.UNIT` and what stands with it, m × `TOLD`, in order of epoch.
        own: covariance of the place of each unit of which something is told: east, north, units × 2 × 2 (m²).
    """

    told: Array
    own: Array


@njit(cache=True)
def predict_pairs(
    table: Array, epochs: Array, units: Indices, powers: NDArray[np.bool_], seen: Prediction, x: Array
) -> PredictedPairs:
    """Predict the ranges and powers of units; not those between two units, for either may be bad.

    Args:
        table: of m readings, see `rows.Row`.
        epochs: theirs, m (s).
        units: where the position of each begins, ascending or not.
        powers: of which units powers are told as well.
        seen: what is known of them before they are taken in.
        x: the estimate, n.
    """
    found, own = np.empty((len(table), TOLD)), np.zeros((len(units), 2, 2))
    place = np.full(len(x) + 1, -1)
    for i in range(len(units)):
        place[units[i]] = i
    chosen, unit = np.zeros(len(table), dtype=np.bool_), np.zeros(len(table), dtype=np.intp)
    for r in range(len(table)):
        if (table[r, KIND] == RANGE or table[r, KIND] == RSSI) and table[r, LINK] >= 0:
            a, b = place[int(table[r, A])], place[int(table[r, B])]
            unit[r] = max(a, b)
            chosen[r] = (a >= 0) != (b >= 0) and (
                table[r, KIND] == RANGE or (powers[unit[r]] and table[r, EXTRA] >= 0)
            )
    some = np.flatnonzero(chosen)
    if len(some) == 0 or not seen.solvable:
        return PredictedPairs(found[:0], own)
    some = some[np.argsort(epochs[some], kind="mergesort")]
    rows, m, columns, covariance = table[some], len(some), seen.columns[some], seen.own[some]
    jacobian, residual, rest = seen.jacobian[some], seen.residual[some], np.empty(m)
    for k in range(m):
        r = some[k]
        by_a = place[int(rows[k, A])] >= 0
        near, far = (0, 3) if by_a else (3, 0)
        near_m, far_m = (A_E, B_E) if by_a else (B_E, A_E)
        jacobian[k, near : near + 3] = 0.0
        own[unit[r]] = covariance[k, near : near + 2, near : near + 2]
        squared = 0.0
        for axis in range(3):
            here, there = rows[k, near_m + axis], rows[k, far_m + axis]
            if columns[k, near + axis] >= 0:
                here += x[columns[k, near + axis]]
            if columns[k, far + axis] >= 0:
                there += x[columns[k, far + axis]]
            squared += (here - there) ** 2
            found[k, rival.EAST + axis] = there if axis < 2 else here - there
        found[k, rival.UNIT], found[k, rival.LINK], found[k, rival.EPOCH] = unit[r], rows[k, LINK], epochs[r]
        # What it would be without the technology's states, to first order.
        if rows[k, KIND] == RANGE:
            found[k, rival.READ], found[k, rival.EXPONENT] = np.sqrt(squared) + residual[k], 0.0
            found[k, rival.SIGMA] = min(rows[k, SIGMA], NOISIER * rows[k, NOMINAL])
        else:
            exponent = x[columns[k, EXPONENT]]
            by_way = rssi_at(-np.inf, squared, 0.0, exponent).predicted
            found[k, rival.READ], found[k, rival.EXPONENT] = by_way + residual[k], exponent
            # A bad unit makes all errors alike: powers would be worth nothing.
            found[k, rival.SIGMA] = rows[k, NOMINAL]
        found[k, rival.OUTLIERS] = min(rows[k, OUTLIERS], rival.OBSTRUCTED)
        found[k, rival.OFF], found[k, rival.UNSURE] = residual[k], seen.predicted[r]
    variances(covariance, jacobian, rest)
    found[:m, rival.REST] = rest
    return PredictedPairs(found[:m], own)
