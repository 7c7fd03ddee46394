"""What a Kirchhoff state knows of a tick's readings before it takes them in.

A reading is held against a few numbers, and what it tells of the others follows from these: they are summed
out beforehand (operation 3 of paper A, eq. 17), and put where they belong at the end.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.rows.joint_covariance import TouchedNumbers, joint, numbers_of, variances
from estimator.fusion.rows.rows import WIDTH, columns_of, linearise
from estimator.graph.dense import Array, Indices
from estimator.graph.triangular import backward, forward, halved


class Prediction(NamedTuple):
    """Readings at the estimate from before them.

    Attributes:
        solvable: L is positive definite; else nothing is known.
        columns: which numbers each depends on, m × 9; −1 where there is none.
        numbers: the numbers of all readings.
        x: these, k.
        prior: L without the others, k × k.
        pull: b without the others, k.
        jacobian: derivatives of the predictions by the numbers of each, m × 9.
        residual: z − h(x), m.
        own: covariance of the numbers of each, m × 9 × 9.
        predicted: variance of each prediction, m.
        factor: of L with the others first, as `halved` leaves it, n × n.
        unscale: the same, n.
        half: U⁻ᵀ D⁻¹ b of the others, n − k.
    """

    solvable: bool
    columns: Indices
    numbers: TouchedNumbers
    x: Array
    prior: Array
    pull: Array
    jacobian: Array
    residual: Array
    own: Array
    predicted: Array
    factor: Array
    unscale: Array
    half: Array


@njit(cache=True, error_model="numpy", nogil=True)
def predict(table: Array, matrix: Array, vector: Array, x: Array) -> Prediction:
    """Linearise readings, and find how unsure they are.

    Args:
        table: of m readings, see `rows.Row`.
        matrix: L, n × n or larger.
        vector: b, n.
        x: the estimate, n.
    """
    m, n, columns = len(table), len(x), columns_of(table)
    numbers = numbers_of(columns, n)
    k, first = len(numbers.used), len(numbers.others)
    own, predicted = np.zeros((m, WIDTH, WIDTH)), np.zeros(m)
    factor, unscale, prior = np.empty((n, n)), np.empty(n), np.empty((k, k))
    order = np.concatenate((numbers.others, numbers.used))
    here, pull, half = x[numbers.used], vector[numbers.used], vector[numbers.others]
    solvable = halved(matrix, order, first, factor, unscale, prior)
    jacobian, residual = np.empty((m, WIDTH)), np.empty(m)
    linearise(table, numbers.at, here, jacobian, residual)
    if solvable:
        joint(factor[first:, first:].copy(), unscale[first:], numbers, own)
        variances(own, jacobian, predicted)
        if half.any():
            half *= unscale[:first]
            forward(factor[:first, :first], half)
            for i in range(first):
                for c in range(k):
                    pull[c] -= factor[i, first + c] * half[i] / unscale[first + c]
    return Prediction(
        solvable,
        columns,
        numbers,
        here,
        prior,
        pull,
        jacobian,
        residual,
        own,
        predicted,
        factor,
        unscale,
        half,
    )


@njit(cache=True, error_model="numpy")
def follow(seen: Prediction, moved: Array, x: Array) -> None:
    """Move an estimate to where its readings have led the numbers that they depend on.

    Args:
        seen: what was known of the readings.
        moved: these numbers, k.
        x: the estimate, n, changed.
    """
    first = len(seen.numbers.others)
    off, step = (moved - seen.x) / seen.unscale[first:], seen.half.copy()
    for i in range(first):
        for c in range(len(off)):
            step[i] -= seen.factor[i, first + c] * off[c]
    backward(seen.factor, step)
    for i in range(first):
        x[seen.numbers.others[i]] += seen.unscale[i] * step[i]
    for c in range(len(moved)):
        x[seen.numbers.used[c]] = moved[c]
