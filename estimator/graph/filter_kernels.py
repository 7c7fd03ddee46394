"""Loops of the Kirchhoff state, compiled: they take plain arrays and know nothing of nodes or readings."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices
from estimator.graph.triangular import STRIP, factorised, take_rows


@njit(cache=True, error_model="numpy")
def scatter(
    matrix: Array, vector: Array, columns: Indices, jacobian: Array, information: Array, residual: Array
) -> None:
    """Operation 1 of paper A: L += Hᵀ P⁻¹ H and b += Hᵀ P⁻¹ r for m scalar measurements.

    Args:
        matrix: L, n × n or larger, changed.
        vector: b, as long, changed.
        columns: which numbers each measurement depends on, m × k; any where the derivative is 0.
        jacobian: H, m × k.
        information: P⁻¹, m.
        residual: r, m.
    """
    m, k = columns.shape
    for r in range(m):
        for i in range(k):
            if jacobian[r, i] == 0.0:
                continue
            pulled = jacobian[r, i] * information[r]
            row = columns[r, i]
            vector[row] += pulled * residual[r]
            for j in range(k):
                if jacobian[r, j] != 0.0:
                    matrix[row, columns[r, j]] += pulled * jacobian[r, j]


@njit(cache=True, error_model="numpy", nogil=True)
def advance(
    matrix: Array, vector: Array, n: int, rows: Indices, transition: Array, noise: Array
) -> tuple[bool, Array]:
    """`Kirchhoff.advance`, but for the reference: see `carry` and `loosen`.

    Returns:
        False where Q⁻¹ + Eᵀ A E is not positive definite: the second half is still to be done; and that.
    """
    kernel = carry(matrix, vector, n, rows, transition, noise)
    return loosen(matrix, vector, n, rows.ravel(), kernel), kernel


@njit(cache=True, error_model="numpy")
def carry(matrix: Array, vector: Array, n: int, rows: Indices, transition: Array, noise: Array) -> Array:
    """First half of `Kirchhoff.advance`: put A = F⁻ᵀ L F⁻¹ and F⁻ᵀ b in the place of L and b.

    Args:
        matrix: L, n × n or larger.
        vector: b, as long.
        n: rows in use.
        rows: the rows of g moving groups of d numbers, g × d.
        transition: F of each, g × d × d.
        noise: Q of each, g × d × d.

    Returns:
        Q⁻¹ + Eᵀ A E, gd × gd.
    """
    g, d = rows.shape
    flat = rows.ravel()
    turned, pulls = np.zeros((g * d, n)), np.zeros(g * d)
    back, before, known = np.empty((g, d, d)), np.empty(d), np.empty((d, d))
    for i in range(g):
        invert(transition[i], back[i])
        for a in range(d):
            own = turned[i * d + a]
            for b in range(d):
                by, row = back[i, b, a], matrix[rows[i, b]]
                if by == 0.0:
                    continue
                pulls[i * d + a] += by * vector[rows[i, b]]
                for j in range(n):
                    own[j] += by * row[j]
    for r in range(g * d):
        own = turned[r]
        for i in range(g):
            for b in range(d):
                before[b] = own[rows[i, b]]
            for a in range(d):
                total = 0.0
                for b in range(d):
                    total += before[b] * back[i, b, a]
                own[rows[i, a]] = total
    kernel = np.empty((g * d, g * d))
    for r in range(g * d):
        for s in range(r + 1):
            # Where F contracts, its inverse would blow up what rounding leaves of asymmetry.
            mean = 0.5 * (turned[r, flat[s]] + turned[s, flat[r]])
            turned[r, flat[s]] = turned[s, flat[r]] = mean
            kernel[r, s] = kernel[s, r] = mean
    for i in range(g):
        invert(noise[i], known)
        for a in range(d):
            for b in range(d):
                kernel[i * d + a, i * d + b] += known[a, b]
    for r in range(g * d):
        vector[flat[r]] = pulls[r]
        row, own = matrix[flat[r]], turned[r]
        for j in range(n):
            row[j] = own[j]
        for j in range(n):
            matrix[j, flat[r]] = own[j]
    return kernel


@njit(cache=True, error_model="numpy")
def invert(matrix: Array, found: Array) -> None:
    """A⁻¹ of a regular matrix of a few rows, by Gauss and Jordan: sooner done than LAPACK is called.

    Args:
        matrix: A, n × n.
        found: takes the inverse, n × n.
    """
    n, rest = len(matrix), matrix.copy()
    for i in range(n):
        for j in range(n):
            found[i, j] = 1.0 if i == j else 0.0
    for j in range(n):
        best = j
        for i in range(j + 1, n):
            if abs(rest[i, j]) > abs(rest[best, j]):
                best = i
        if best != j:
            for c in range(n):
                rest[j, c], rest[best, c] = rest[best, c], rest[j, c]
                found[j, c], found[best, c] = found[best, c], found[j, c]
        unscale = 1.0 / rest[j, j]
        for c in range(n):
            rest[j, c] *= unscale
            found[j, c] *= unscale
        for i in range(n):
            share = rest[i, j]
            if i != j and share != 0.0:
                for c in range(n):
                    rest[i, c] -= share * rest[j, c]
                    found[i, c] -= share * found[j, c]


@njit(cache=True, error_model="numpy")
def loosen(matrix: Array, vector: Array, n: int, flat: Indices, kernel: Array) -> bool:
    """Second half of `Kirchhoff.advance`: take A E K⁻¹ Eᵀ A off A, and A E K⁻¹ Eᵀ b off b.

    Args:
        matrix: A, n × n or larger, changed.
        vector: b, as long, changed.
        n: rows in use.
        flat: the rows E that move, k.
        kernel: K, k × k.

    Returns:
        False where K is not positive definite: nothing has been changed.
    """
    k = len(flat)
    factor, unscale = np.zeros((k, k)), np.empty(k)
    if not factorised(kernel, factor, unscale):
        return False
    edges, pulls = np.empty((k, n)), np.empty(k)
    for r in range(k):
        row, own = matrix[flat[r]], edges[r]
        for j in range(n):
            own[j] = row[j] * unscale[r]
        take_rows(own, factor[:r, r], edges, 0, 0)
        pulls[r] = vector[flat[r]] * unscale[r]
        for i in range(r):
            pulls[r] -= factor[i, r] * pulls[i]
        last = 1.0 / factor[r, r]
        pulls[r] *= last
        for j in range(n):
            own[j] *= last
    for start in range(0, n, STRIP):
        end = min(start + STRIP, n)
        taken = np.dot(edges[:, start:end].copy().T, edges[:, :end].copy())
        for i in range(start, end):
            own, less = matrix[i], taken[i - start]
            for j in range(i + 1):
                own[j] -= less[j]
            for j in range(i):
                matrix[j, i] = own[j]
    vector[:n] -= np.dot(edges.T, pulls)
    return True
