"""Triangular factors of matrices of some tens or hundreds of rows, and what is solved with them, compiled.

Calling LAPACK for each little step costs more than the step. Inner loops run over views from 0 on, because
only those become vector instructions.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import MAX_JITTER, Array, Indices

BLOCK = 32
"""Rows that are eliminated one by one before the rest is left to products of matrices."""
STRIP = 64
"""Rows of such a product: only what lies above the diagonal is needed, and one product would make all."""


@njit(cache=True, error_model="numpy")
def cholesky(matrix: Array, begin: int, end: int) -> bool:
    """Put rows of U with A = Uᵀ U in the place of those of A's upper triangle, n × n.

    What is below it has no meaning after.

    Args:
        matrix: A, whose rows before `begin` are those of U already.
        begin: the first row to be eliminated.
        end: the one after the last. In the place of the rest is then what A is left with there (paper A,
            eq. 17), upper triangle.

    Returns:
        False where A is not positive definite.
    """
    n = len(matrix)
    for first in range(begin, end, BLOCK):
        last = min(first + BLOCK, end)
        for i in range(first, last):
            own = matrix[i, i:]
            take_rows(own, matrix[first:i, i], matrix, first, i)
            if not own[0] > 0.0:
                return False
            unscale = 1.0 / np.sqrt(own[0])
            for j in range(len(own)):
                own[j] *= unscale
        for start in range(last, n, STRIP):
            stop = min(start + STRIP, n)
            taken = np.dot(matrix[first:last, start:stop].copy().T, matrix[first:last, start:].copy())
            for i in range(stop - start):
                own, less = matrix[start + i, start + i :], taken[i, i:]
                for j in range(len(own)):
                    own[j] -= less[j]
    return True


@njit(cache=True, error_model="numpy", forceinline=True)
def take_rows(own: Array, shares: Array, matrix: Array, top: int, left: int) -> None:
    """Take shares of a matrix's rows off another row, one after the other.

    Four at a time, so that it is read and written less often. Put where it is called: a call would count its
    arrays, which takes longer than a short row.

    Args:
        own: n, changed.
        shares: of each row, k.
        matrix: its k rows from `top` on, and their n numbers from `left` on.
        top: the first row.
        left: the first column.
    """
    n, k = len(own), len(shares)
    at = 0
    while at + 4 <= k:
        one, two, three, four = shares[at], shares[at + 1], shares[at + 2], shares[at + 3]
        row = top + at
        first, second = matrix[row, left:], matrix[row + 1, left:]
        third, fourth = matrix[row + 2, left:], matrix[row + 3, left:]
        for j in range(n):
            own[j] = own[j] - one * first[j] - two * second[j] - three * third[j] - four * fourth[j]
        at += 4
    while at < k:
        one, first = shares[at], matrix[top + at, left:]
        for j in range(n):
            own[j] -= one * first[j]
        at += 1


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
            own, scaled, others = matrix[i, i:], factor[i, i:], unscale[i:]
            for j in range(n - i):
                scaled[j] = own[j] * unscale[i] * others[j]
            scaled[0] += jitter
        if cholesky(factor, 0, n):
            return True
        jitter = 1e-13 if jitter == 0.0 else jitter * 10.0
    return False


@njit(cache=True, error_model="numpy")
def halved(matrix: Array, order: Indices, first: int, factor: Array, unscale: Array, left: Array) -> bool:
    """`factorised` with the rows in another order, and what is left of the matrix half-way (paper A, eq. 17).

    Args:
        matrix: A, n × n or larger.
        order: which rows of it count, n.
        first: how many of these are eliminated first.
        factor: takes U, upper triangle, n × n.
        unscale: takes the diagonal of D⁻¹, n.
        left: takes what the others are left with then, k × k.

    Returns:
        False where A is not finite, or far from positive definite.
    """
    n, jitter = len(order), 0.0
    for i in range(n):
        own = matrix[order[i], order[i]]
        unscale[i] = 1.0 / np.sqrt(own) if own > 0.0 else np.nan
    while jitter <= MAX_JITTER:
        for i in range(n):
            row = matrix[order[i]]
            for j in range(i, n):
                factor[i, j] = row[order[j]] * unscale[i] * unscale[j]
            factor[i, i] += jitter
        if cholesky(factor, 0, first):
            for i in range(first, n):
                for j in range(i, n):
                    whole = factor[i, j] / (unscale[i] * unscale[j])
                    left[i - first, j - first] = left[j - first, i - first] = whole
            if cholesky(factor, first, n):
                return True
        jitter = 1e-13 if jitter == 0.0 else jitter * 10.0
    return False


@njit(cache=True, error_model="numpy")
def forward(factor: Array, right: Array) -> None:
    """Put U⁻ᵀ r in the place of r, n."""
    n = len(right)
    for i in range(n):
        right[i] /= factor[i, i]
        known = right[i]
        for j in range(i + 1, n):
            right[j] -= factor[i, j] * known


@njit(cache=True, error_model="numpy")
def forward_all(factor: Array, rights: Array, first: Indices) -> None:
    """`forward` of many: put U⁻ᵀ r in the place of each column r of `rights`, n × m.

    Args:
        factor: U, upper triangle, n × n.
        rights: n × m, changed.
        first: before it the numbers of each are nil, m, ascending.
    """
    n, m = rights.shape
    for start in range(0, n, BLOCK):
        end, begun = min(start + BLOCK, n), 0
        while begun < m and first[begun] < end:
            begun += 1
        if begun == 0:
            continue
        for i in range(start, end):
            own = rights[i, :begun]
            take_rows(own, factor[start:i, i], rights, start, 0)
            last = factor[i, i]
            for j in range(begun):
                own[j] /= last
        if end < n:
            taken = np.dot(factor[start:end, end:].copy().T, rights[start:end, :begun].copy())
            for i in range(end, n):
                own, less = rights[i, :begun], taken[i - end]
                for j in range(begun):
                    own[j] -= less[j]


@njit(cache=True, error_model="numpy")
def backward(factor: Array, right: Array) -> None:
    """Put U⁻¹ r in the place of r, n, for the first n rows of U."""
    n = len(right)
    for i in range(n - 1, -1, -1):
        total = right[i]
        for j in range(i + 1, n):
            total -= factor[i, j] * right[j]
        right[i] = total / factor[i, i]


@njit(cache=True, error_model="numpy")
def solved(factor: Array, unscale: Array, right: Array) -> Array:
    """A⁻¹ r, n, of a matrix that has been `factorised`."""
    answer = right * unscale
    forward(factor, answer)
    backward(factor, answer)
    return answer * unscale


@njit(cache=True, error_model="numpy")
def inverted(matrix: Array, found: Array) -> bool:
    """A⁻¹ of a symmetric positive definite matrix, exactly symmetric.

    Args:
        matrix: A, n × n or larger.
        found: takes the inverse, n × n.

    Returns:
        False where A is not finite, or far from positive definite.
    """
    n = len(found)
    factor, unscale, half = np.zeros((n, n)), np.empty(n), np.zeros((n, n))
    if not factorised(matrix[:n, :n], factor, unscale):
        return False
    for i in range(n):
        half[i, i] = unscale[i]
    forward_all(factor, half, np.arange(n))
    product = np.dot(half.T, half)
    for i in range(n):
        for j in range(i, n):
            found[i, j] = found[j, i] = product[i, j]
    return True
