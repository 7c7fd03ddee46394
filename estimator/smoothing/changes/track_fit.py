"""The likeliest way of few numbers for ranges to what stands, and its evidence, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.physics import SIGMA_FLOOR_M
from estimator.graph.dense import Array
from estimator.graph.robust import mixture_cost, weigh
from estimator.graph.triangular import cholesky, forward

SLACKS_M = (8.0, 2.0, 0.5, 0.0, 0.0)
NOISIER = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Times that ranges may be as noisy as usual: what was learned of them meanwhile may be a wrong way's."""
FARTHEST_M = 40.0
"""No step leads farther."""


class RangedTrack(NamedTuple):
    """Ranges of a radio to what stands.

    Attributes:
        there_m: the other ends: east, north, m × 2 (m).
        up_m: how much higher it is than those, m (m).
        range_m: ranges without their technology's bias and scale, m (m).
        sigma_m: usual standard deviation of each, m (m).
        noise: outliers, shift and spread of each, m × 3.
    """

    there_m: Array
    up_m: Array
    range_m: Array
    sigma_m: Array
    noise: Array


class TrackFit(NamedTuple):
    """What a descent has led to.

    Attributes:
        way_m: where it was at each range: east, north, m × 2 (m).
        evidence: log likelihood of the ranges, whatever its numbers are, by Laplace's approximation.
        x: its numbers, n.
        good: share of the ranges that agree with it.
    """

    way_m: Array
    evidence: float
    x: Array
    good: float


@njit(cache=True, error_model="numpy")
def fit_track(ranged: RangedTrack, basis: Array, led: bool, start: Array, known: Array) -> TrackFit:
    """Gauss's and Newton's steps, with slack at first, so that good ranges are not taken for outliers.

    Args:
        ranged: the ranges.
        basis: displacements of a unit, m × 2 (m), or how much each knot of a free way counts, m × k.
        led: it is a unit's: its numbers are where it is in the middle and ψ; else those of the knots.
        start: numbers to begin from, about which they are known, n.
        known: their information beforehand, n × n.
    """
    m, n = len(basis), len(start)
    x, noise = start.copy(), ranged.noise
    way, along, residual = np.empty((m, 2)), np.zeros((m, n)), np.empty(m)
    outliers, shift, spread = noise[:, 0].copy(), noise[:, 1].copy(), noise[:, 2].copy()
    for slack in SLACKS_M:
        look(ranged, basis, led, x, way, along, residual)
        weighted = weigh(residual, ranged.sigma_m, np.full(m, slack * slack), outliers, shift, spread)
        right = np.zeros(n)
        matrix = known.copy()
        for r in range(n):
            for c in range(n):
                right[r] -= known[r, c] * (x[c] - start[c])
        for i in range(m):
            weight, pulled = weighted.information[i], weighted.residual[i]
            if slack > 0.0:
                weight, pulled = weighted.good[i] / (ranged.sigma_m[i] ** 2 + slack * slack), residual[i]
            add(along[i], weight, pulled, matrix, right)
        if not cholesky(matrix, 0, len(matrix)):
            break
        forward(matrix, right)
        farthest = 0.0
        for r in range(n - 1, -1, -1):
            for c in range(r + 1, n):
                right[r] -= matrix[r, c] * right[c]
            right[r] /= matrix[r, r]
            farthest = max(farthest, abs(right[r]))
        x += right * min(1.0, FARTHEST_M / max(farthest, 1e-9))
    look(ranged, basis, led, x, way, along, residual)
    best, good = -np.inf, 0.0
    for noisier in NOISIER:
        sigma = noisier * ranged.sigma_m
        total = -mixture_cost(residual, sigma, outliers, shift, spread).sum()
        weighted = weigh(residual, sigma, np.zeros(m), outliers, shift, spread)
        matrix, right = known.copy(), np.zeros(n)
        for i in range(m):
            add(along[i], weighted.information[i], 0.0, matrix, right)
        evidence = total - 0.5 * volume(matrix)
        if evidence > best:
            best, good = evidence, weighted.good.mean()
    off = 0.0
    for r in range(n):
        for c in range(n):
            off += 0.5 * known[r, c] * (x[r] - start[r]) * (x[c] - start[c])
    return TrackFit(way, best - off + 0.5 * volume(known.copy()), x, good)


@njit(cache=True, error_model="numpy")
def look(
    ranged: RangedTrack, basis: Array, led: bool, x: Array, way: Array, along: Array, residual: Array
) -> None:
    """Where numbers put a radio.

    Args:
        ranged: see `fit_track`.
        basis: see `fit_track`.
        led: see `fit_track`.
        x: the numbers, n.
        way: takes it, m × 2 (m).
        along: takes the derivatives of what the ranges should be, m × n.
        residual: takes what the ranges are longer by, m (m).
    """
    for i in range(len(basis)):
        if led:
            cosine, sine = np.cos(x[2]), np.sin(x[2])
            way[i, 0] = x[0] + cosine * basis[i, 0] - sine * basis[i, 1]
            way[i, 1] = x[1] + sine * basis[i, 0] + cosine * basis[i, 1]
        else:
            way[i] = 0.0
            for k in range(basis.shape[1]):
                way[i, 0] += basis[i, k] * x[2 * k]
                way[i, 1] += basis[i, k] * x[2 * k + 1]
        east, north, up = way[i, 0] - ranged.there_m[i, 0], way[i, 1] - ranged.there_m[i, 1], ranged.up_m[i]
        length = np.sqrt(east * east + north * north + up * up + SIGMA_FLOOR_M**2)
        residual[i] = ranged.range_m[i] - length
        if led:
            along[i, 0], along[i, 1] = east / length, north / length
            along[i, 2] = along[i, 1] * (way[i, 0] - x[0]) - along[i, 0] * (way[i, 1] - x[1])
        else:
            for k in range(basis.shape[1]):
                along[i, 2 * k] = basis[i, k] * east / length
                along[i, 2 * k + 1] = basis[i, k] * north / length


@njit(cache=True, error_model="numpy")
def add(along: Array, weight: float, pulled: float, matrix: Array, right: Array) -> None:
    """Add one range to normal equations.

    Args:
        along: its derivatives, n.
        weight: P⁻¹.
        pulled: its residual.
        matrix: upper triangle of the matrix, n × n, changed.
        right: right side, n, changed.
    """
    for r in range(len(along)):
        if along[r] != 0.0:
            own = weight * along[r]
            right[r] += own * pulled
            for c in range(r, len(along)):
                matrix[r, c] += own * along[c]


@njit(cache=True, error_model="numpy")
def volume(matrix: Array) -> float:
    """Logarithm of the determinant of a positive definite matrix, whose upper triangle is factorised here."""
    if not cholesky(matrix, 0, len(matrix)):
        return np.inf
    total = 0.0
    for r in range(len(matrix)):
        total += 2.0 * np.log(matrix[r, r])
    return total
