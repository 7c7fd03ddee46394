"""Covariances of four numbers: as upper triangles, and after a reading, compiled."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array


@njit(cache=True)
def full(upper: Array) -> Array:
    """A symmetric matrix, 4 × 4, from its upper triangle."""
    found, at = np.empty((4, 4)), 0
    for r in range(4):
        for c in range(r, 4):
            found[r, c] = found[c, r] = upper[at]
            at += 1
    return found


@njit(cache=True)
def upper_of(matrix: Array) -> Array:
    """The upper triangle of a symmetric matrix, 4 × 4."""
    found, at = np.empty(10), 0
    for r in range(4):
        for c in range(r, 4):
            found[at] = matrix[r, c]
            at += 1
    return found


@njit(cache=True)
def kalman_update(x: Array, covariance: Array, across: Array, variance: float, off: float) -> None:
    """Take a scalar reading into an estimate, in place: a step of a Kalman filter without temporary arrays.

    Args:
        x: the estimate, 4, changed.
        covariance: of it, Σ, 4 × 4, changed: exactly symmetric after.
        across: Σ Hᵀ, 4.
        variance: of what was read less what was foretold.
        off: what was read less what was foretold.
    """
    for i in range(4):
        gain = across[i] / variance
        x[i] += gain * off
        for j in range(4):
            covariance[i, j] -= gain * across[j]
    for i in range(4):
        for j in range(i):
            covariance[i, j] = covariance[j, i] = 0.5 * (covariance[i, j] + covariance[j, i])
