"""Symmetric positive definite systems, scaled first: metres and rad/s live together."""

from typing import NamedTuple

import numpy as np
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
    diagonal = np.diagonal(matrix)
    if not np.isfinite(matrix).all() or not diagonal.min() > 0.0:
        raise ValueError("the information matrix is not finite or has a variable without information")
    scale = np.sqrt(diagonal)
    unscale = 1.0 / scale
    jitter = 0.0
    while True:
        scaled = matrix * unscale[:, None]
        scaled *= unscale
        if jitter:
            scaled.flat[:: len(scale) + 1] += jitter
        # LAPACK works by columns; the matrix is symmetric, so its transpose is the same without a copy.
        factor, failed = dpotrf(scaled.T, lower=1, clean=1, overwrite_a=1)
        if failed == 0:
            return Cholesky(factor, scale)
        jitter = 1e-13 if jitter == 0.0 else jitter * 10.0
        if jitter > MAX_JITTER:
            raise ValueError("the information matrix is not positive definite")


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
    full: Array = lower + lower.T
    full.flat[:: len(full) + 1] *= 0.5
    unscale = 1.0 / cholesky.scale
    full *= unscale[:, None]
    full *= unscale
    return full
