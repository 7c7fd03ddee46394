"""Loops of the Kirchhoff state, compiled: they take plain arrays and know nothing of nodes or readings.

The matrices have some tens of rows, where calling LAPACK for each little step costs more than the step. Inner
loops run over views from 0 on, because only those become vector instructions.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import MAX_JITTER, Array, Indices

BLOCK = 32
"""Rows that are eliminated one by one before the rest is left to one product of matrices."""


@njit(cache=True, error_model="numpy")
def cholesky(matrix: Array) -> bool:
    """Put U with A = Uᵀ U in the place of A's upper triangle, n × n; what is below it has no meaning after.

    Returns:
        False where A is not positive definite.
    """
    n = len(matrix)
    for first in range(0, n, BLOCK):
        last = min(first + BLOCK, n)
        for k in range(first, last):
            pivot = matrix[k, k]
            if not pivot > 0.0:
                return False
            unscale = 1.0 / np.sqrt(pivot)
            whole = matrix[k, k:]
            for j in range(len(whole)):
                whole[j] *= unscale
            for i in range(k + 1, last):
                pulled, own, row = matrix[k, i], matrix[i, i:], matrix[k, i:]
                for j in range(len(own)):
                    own[j] -= pulled * row[j]
        if last < n:
            done = matrix[first:last, last:].copy()
            matrix[last:, last:] -= np.dot(done.T, done)
    return True


@njit(cache=True, error_model="numpy")
def factorised(matrix: Array, factor: Array, unscale: Array) -> bool:
    """`dense.factorise` within a loop: A = D Uᵀ U D after scaling its diagonal to ones.

    Args:
        matrix: A, n × n.
        factor: takes U, upper triangle, n × n.
        unscale: takes the diagonal of D⁻¹, n.

    Returns:
        False where A is not finite, or far from positive definite.
    """
    n = len(matrix)
    for i in range(n):
        unscale[i] = 1.0 / np.sqrt(matrix[i, i]) if matrix[i, i] > 0.0 else np.nan
    jitter = 0.0
    while jitter <= MAX_JITTER:
        for i in range(n):
            own, scaled = matrix[i], factor[i]
            for j in range(n):
                scaled[j] = own[j] * unscale[i] * unscale[j]
            scaled[i] += jitter
        if cholesky(factor):
            return True
        jitter = 1e-13 if jitter == 0.0 else jitter * 10.0
    return False


@njit(cache=True, error_model="numpy")
def forward(factor: Array, right: Array, first: int) -> None:
    """Put U⁻ᵀ r in the place of r, n, whose numbers before `first` are nil."""
    n = len(right)
    for i in range(first, n):
        right[i] /= factor[i, i]
        known, rest, row = right[i], right[i + 1 :], factor[i, i + 1 :]
        for j in range(len(rest)):
            rest[j] -= row[j] * known


@njit(cache=True, error_model="numpy")
def solved(factor: Array, unscale: Array, right: Array) -> Array:
    """A⁻¹ r, n, of a matrix that has been `factorised`."""
    answer = right * unscale
    forward(factor, answer, 0)
    n = len(answer)
    for i in range(n - 1, -1, -1):
        answer[i] = (answer[i] - np.dot(factor[i, i + 1 :], answer[i + 1 :])) / factor[i, i]
    return answer * unscale


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


@njit(cache=True, error_model="numpy")
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
    back = np.empty((g, d, d))
    for i in range(g):
        back[i] = np.linalg.inv(transition[i])
        for a in range(d):
            for b in range(d):
                by = back[i, b, a]
                if by == 0.0:
                    continue
                pulls[i * d + a] += by * vector[rows[i, b]]
                for j in range(n):
                    turned[i * d + a, j] += by * matrix[rows[i, b], j]
    for r in range(g * d):
        for i in range(g):
            before = turned[r, :][rows[i]]
            for a in range(d):
                total = 0.0
                for b in range(d):
                    total += before[b] * back[i, b, a]
                turned[r, rows[i, a]] = total
    kernel = np.empty((g * d, g * d))
    for r in range(g * d):
        for s in range(r + 1):
            # Where F contracts, its inverse would blow up what rounding leaves of asymmetry.
            mean = 0.5 * (turned[r, flat[s]] + turned[s, flat[r]])
            turned[r, flat[s]] = turned[s, flat[r]] = mean
            kernel[r, s] = kernel[s, r] = mean
    for i in range(g):
        kernel[i * d : (i + 1) * d, i * d : (i + 1) * d] += np.linalg.inv(noise[i])
    for r in range(g * d):
        vector[flat[r]] = pulls[r]
        for j in range(n):
            matrix[flat[r], j] = matrix[j, flat[r]] = turned[r, j]
    return kernel


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
        pulls[r] = vector[flat[r]] * unscale[r]
        for j in range(n):
            edges[r, j] = matrix[flat[r], j] * unscale[r]
    for i in range(k):
        own = 1.0 / factor[i, i]
        pulls[i] *= own
        for j in range(n):
            edges[i, j] *= own
        for r in range(i + 1, k):
            by = factor[i, r]
            pulls[r] -= by * pulls[i]
            for j in range(n):
                edges[r, j] -= by * edges[i, j]
    taken = np.dot(edges.T, edges)
    for i in range(n):
        for j in range(i + 1):
            matrix[i, j] -= taken[i, j]
            matrix[j, i] = matrix[i, j]
    vector[:n] -= np.dot(edges.T, pulls)
    return True
