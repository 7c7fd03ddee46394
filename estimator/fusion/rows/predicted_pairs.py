"""What a Kirchhoff state foretells of the ranges and powers of a tick before it takes them in, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion.learned import rival
from estimator.fusion.learned.rival import TOLD
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.rows.joint_covariance import variance
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
    count, jacobian = 0, seen.jacobian.copy()
    for r in np.argsort(epochs, kind="mergesort"):
        kind, a, b = table[r, KIND], place[int(table[r, A])], place[int(table[r, B])]
        if kind not in (RANGE, RSSI) or table[r, LINK] < 0 or (a >= 0) == (b >= 0) or not seen.solvable:
            continue
        unit, told = max(a, b), found[count]
        if kind == RSSI and not (powers[unit] and table[r, EXTRA] >= 0):
            continue
        near, far = (0, 3) if a >= 0 else (3, 0)
        near_m, far_m = (A_E, B_E) if a >= 0 else (B_E, A_E)
        squared = 0.0
        for axis in range(3):
            here, there = table[r, near_m + axis], table[r, far_m + axis]
            if seen.columns[r, near + axis] >= 0:
                here += x[seen.columns[r, near + axis]]
            if seen.columns[r, far + axis] >= 0:
                there += x[seen.columns[r, far + axis]]
            squared += (here - there) ** 2
            told[rival.EAST + axis] = there if axis < 2 else here - there
            jacobian[r, near + axis] = 0.0
        for i in range(2):
            for j in range(2):
                own[unit, i, j] = seen.own[r, near + i, near + j]
        told[rival.UNIT], told[rival.LINK], told[rival.EPOCH] = unit, table[r, LINK], epochs[r]
        # What it would be without the technology's states, to first order.
        if kind == RANGE:
            told[rival.READ], told[rival.EXPONENT] = np.sqrt(squared) + seen.residual[r], 0.0
            told[rival.SIGMA] = min(table[r, SIGMA], NOISIER * table[r, NOMINAL])
        else:
            exponent = x[seen.columns[r, EXPONENT]]
            by_way = rssi_at(-np.inf, squared, 0.0, exponent).predicted
            told[rival.READ], told[rival.EXPONENT] = by_way + seen.residual[r], exponent
            # A bad unit makes all errors alike: powers would be worth nothing.
            told[rival.SIGMA] = table[r, NOMINAL]
        told[rival.OUTLIERS] = min(table[r, OUTLIERS], rival.OBSTRUCTED)
        told[rival.OFF], told[rival.UNSURE] = seen.residual[r], seen.predicted[r]
        told[rival.REST] = variance(seen.own, jacobian, r)
        count += 1
    return PredictedPairs(found[:count], own)
