"""Symmetric positive definite systems, scaled first: metres and rad/s live together."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotri, dpotrs

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

MAX_JITTER = 1e-9
LEAST_EIGENVALUE = 1e-8
LEAST_INFORMATION = 1e-12


class Cholesky(NamedTuple):
    """A factorised matrix A = D C Cᵀ D.

    Attributes:
        factor: C, lower triangle, n × n.
        scale: the diagonal of D, n.
    """

    factor: Array
    scale: Array


def factorise(matrix: Array) -> Cholesky:
    """Cholesky factor of a symmetric positive definite matrix after scaling its diagonal to ones.

    Where rounding has made the matrix slightly indefinite, the diagonal is raised by the least power of ten
    that lets it pass: this takes away no information but adds at most `MAX_JITTER` of each variable's own.

    Args:
        matrix: n × n.

    Raises:
        ValueError: the matrix is not finite, or far from positive definite.
    """
    if len(matrix) == 0:  # LAPACK refuses empty matrices
        return Cholesky(np.zeros((0, 0)), np.zeros(0))
    matrix, scaled, scale = np.ascontiguousarray(matrix), np.zeros(matrix.shape), np.empty(len(matrix))
    jitter = 0.0
    while True:
        if not scale_diagonal(matrix, jitter, scaled, scale):
            raise ValueError("the information matrix is not finite or has a variable without information")
        # LAPACK works by columns: the upper triangle by rows is the lower one to it, without a copy.
        factor, failed = dpotrf(scaled.T, lower=1, clean=0, overwrite_a=1)
        if failed == 0:
            return Cholesky(factor, scale)
        jitter = 1e-13 if jitter == 0.0 else jitter * 10.0
        if jitter > MAX_JITTER:
            raise ValueError("the information matrix is not positive definite")


@njit(cache=True, nogil=True)
def scale_diagonal(matrix: Array, jitter: float, scaled: Array, scale: Array) -> bool:
    """Scale a matrix so that its diagonal is 1, and raise that by `jitter`.

    Args:
        matrix: n × n.
        jitter: what is added to the diagonal.
        scaled: its upper triangle takes the result, n × n.
        scale: takes the roots of the matrix's diagonal, n.

    Returns:
        False where the matrix is not finite or its diagonal not positive.
    """
    n = len(matrix)
    for i in range(n):
        if not matrix[i, i] > 0.0:
            return False
        scale[i] = np.sqrt(matrix[i, i])
    unscale = 1.0 / scale
    for i in range(n):
        row, found = matrix[i], scaled[i]
        for j in range(n):
            if not np.isfinite(row[j]):
                return False
        for j in range(i, n):
            found[j] = row[j] * unscale[i] * unscale[j]
        found[i] += jitter
    return True


def mended(matrix: Array) -> Array:
    """The nearest matrix that can be factorised, for one that cancellation has left indefinite.

    Readings of absurd size next to precise ones take away more digits than a double has. What is left of the
    directions concerned is noise: they get almost no information.

    Args:
        matrix: n × n, symmetric and finite.
    """
    scale = np.sqrt(np.maximum(np.diagonal(matrix), LEAST_INFORMATION))
    # Of a covariance's inverse no scaled entry is beyond 1: what is has lost its meaning to rounding.
    with np.errstate(over="ignore"):
        scaled = np.clip(matrix / scale[:, None] / scale[None, :], -1.0, 1.0)
    values, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    whole = (vectors * np.maximum(values, LEAST_EIGENVALUE)) @ vectors.T
    return np.asarray(0.5 * (whole + whole.T) * scale[:, None] * scale[None, :])


def solve(cholesky: Cholesky, right: Array) -> Array:
    """A⁻¹ `right`, for a vector n or a matrix n × k."""
    if len(cholesky.scale) == 0:
        return right.copy()
    scale = cholesky.scale if right.ndim == 1 else cholesky.scale[:, None]
    answer, _ = dpotrs(cholesky.factor, right / scale, lower=1)
    return np.asarray(answer, dtype=np.float64) / scale


def inverse(cholesky: Cholesky) -> Array:
    """A⁻¹, n × n, exactly symmetric."""
    if len(cholesky.scale) == 0:
        return np.zeros((0, 0))
    lower, _ = dpotri(cholesky.factor, lower=1)
    return unscaled(lower.T, cholesky.scale)


def log_determinant(cholesky: Cholesky) -> float:
    """The logarithm of |A|."""
    return 2.0 * float(np.log(np.diagonal(cholesky.factor) * cholesky.scale).sum())


@njit(cache=True, nogil=True)
def unscaled(upper: Array, scale: Array) -> Array:
    """Both triangles of D⁻¹ A D⁻¹ for the upper one of A (n × n) and the diagonal of D (n)."""
    n, unscale = len(scale), 1.0 / scale
    found = np.empty((n, n))
    for i in range(n):
        for j in range(i, n):
            found[i, j] = upper[i, j] * unscale[i] * unscale[j]
            found[j, i] = upper[i, j] * unscale[j] * unscale[i]
    return found
