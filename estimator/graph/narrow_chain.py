"""Chains of one walk, whose keyframes have six numbers: plain loops are sooner done than BLAS is called.

What BLAS would multiply is summed as BLAS sums it, in order and each product fused with its sum: so a walk
has the same digits by itself as among others (decision 0109).
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array

NARROW = 6


@njit(cache=True)
def eliminate_narrow(first: int, last: int, diagonal: Array, link: Array, wide: Array) -> int:
    """`chain_kernels.eliminate` for keyframes of one block of `NARROW` numbers."""
    length, _, across = wide.shape
    inverse, half = np.empty((NARROW, NARROW)), np.empty((NARROW, NARROW))
    back, done = np.empty((NARROW, NARROW)), np.empty((NARROW, across))
    for j in range(first, last):
        for r in range(NARROW):
            for c in range(NARROW):
                inverse[r, c] = diagonal[j, r, c]
        if not half_inverse_narrow(inverse):
            return j
        for r in range(NARROW):
            for c in range(NARROW):
                diagonal[j, r, c] = inverse[r, c]
            for i in range(across):
                done[r, i], wide[j, r, i] = wide[j, r, i], 0.0
        for r in range(NARROW):
            add_shares(inverse, r, done, wide, j)
        if j == length - 1:
            break
        for r in range(NARROW):
            for i in range(across):
                done[r, i] = wide[j, r, i]
        for r in range(NARROW):
            for a in range(NARROW):
                total = 0.0
                for c in range(r + 1):
                    total += inverse[r, c] * link[j, 0, a, c]
                half[r, a], back[a, r] = total, -total
        for a in range(NARROW):
            add_shares(back, a, half, diagonal, j + 1)
            add_shares(back, a, done, wide, j + 1)
    return last


@njit(cache=True)
def half_inverse_narrow(matrix: Array) -> bool:
    """`chain_kernels.half_inverse` of `NARROW` rows: where their number is known, loops need no views."""
    for j in range(NARROW):
        if not 0.0 < matrix[j, j] < np.inf:
            return False
        scale = 1.0 / np.sqrt(matrix[j, j])
        for c in range(NARROW):
            matrix[j, c] *= scale
        matrix[j, j] = scale
        for i in range(j + 1, NARROW):
            share = matrix[j, i]
            matrix[i, j] = 0.0
            for c in range(j + 1):
                matrix[i, c] -= share * matrix[j, c]
            for c in range(i, NARROW):
                matrix[i, c] -= share * matrix[j, c]
    for j in range(NARROW):
        for c in range(j + 1, NARROW):
            matrix[j, c] = 0.0
    return True


@njit(cache=True, forceinline=True)
def add_shares(shares: Array, row: int, rows: Array, targets: Array, at: int) -> None:
    """Add to a row of one of some matrices shares of `NARROW` rows of another one.

    All of them at once: each sum stays in a register, and the loop along the row is one of vectors.

    Args:
        shares: n × `NARROW`.
        row: which of their rows counts, and which one of the matrix is changed.
        rows: `NARROW` × m.
        targets: k × n × m, changed.
        at: which matrix.
    """
    a, b, c = shares[row, 0], shares[row, 1], shares[row, 2]
    d, e, f = shares[row, 3], shares[row, 4], shares[row, 5]
    for i in range(rows.shape[1]):
        total = a * rows[0, i] + b * rows[1, i] + c * rows[2, i] + d * rows[3, i] + e * rows[4, i]
        targets[at, row, i] += total + f * rows[5, i]


@njit(cache=True)
def selected_inverse_narrow(
    diagonal: Array, link: Array, wide: Array, border_covariance: Array, found: Array, ahead: Array
) -> None:
    """`chain_kernels.selected_inverse` for keyframes of one block of `NARROW` numbers."""
    length, lasting = len(wide), wide.shape[2] - 1
    square, across = (NARROW, NARROW), (NARROW, lasting)
    inverse, turned, covariance = np.empty(square), np.empty(square), np.empty(square)
    to_next, with_next, product = np.empty(square), np.empty(square), np.empty(square)
    border, to_border, with_border = np.empty(across), np.empty(across), np.empty(across)
    on_border, from_border = np.empty(across), np.empty((lasting, NARROW))
    next_covariance, next_border = np.zeros(square), np.zeros(across)
    border_next = np.zeros((lasting, NARROW))  # turned, so that sums over the border are loops of vectors
    for j in range(length - 1, -1, -1):
        for r in range(NARROW):
            for c in range(NARROW):
                inverse[r, c] = turned[c, r] = diagonal[j, r, c]
            for i in range(lasting):
                border[r, i] = wide[j, r, i]
        by_six(turned, border, to_border)
        for r in range(NARROW):
            for i in range(lasting):
                to_border[r, i] = from_border[i, r] = -to_border[r, i]
        by_six(turned, inverse, covariance)
        by_any(to_border, border_covariance, with_border)
        if j < length - 1:
            for r in range(NARROW):
                for c in range(NARROW):
                    turned[c, r] = link[j, 0, r, c]
            by_six(covariance, turned, to_next)
            for r in range(NARROW):
                for c in range(NARROW):
                    to_next[r, c] = turned[c, r] = -to_next[r, c]
            by_six(to_next, next_covariance, with_next)
            to_six(to_border, border_next, product)
            add(product, with_next)
            by_six(to_next, next_border, on_border)
            add(on_border, with_border)
            by_six(with_next, turned, product)
            add(product, covariance)
            for r in range(NARROW):
                for c in range(NARROW):
                    ahead[j, 0, r, c] = with_next[r, c]
        to_six(with_border, from_border, product)
        add(product, covariance)
        for r in range(NARROW):
            for c in range(r + 1):
                mean = 0.5 * (covariance[r, c] + covariance[c, r])
                next_covariance[r, c] = next_covariance[c, r] = mean
                found[j, 0, r, c] = found[j, 0, c, r] = mean
            for i in range(lasting):
                next_border[r, i] = border_next[i, r] = with_border[r, i]


@njit(cache=True, forceinline=True)
def add(more: Array, total: Array) -> None:
    """Add a matrix of `NARROW` rows to another one in its place."""
    for r in range(NARROW):
        for c in range(total.shape[1]):
            total[r, c] += more[r, c]


@njit(cache=True, forceinline=True, fastmath={"contract"})
def by_six(one: Array, other: Array, product: Array) -> None:
    """A product that sums over `NARROW` numbers: of 6 × 6 and 6 × m."""
    for r in range(NARROW):
        a, b, c = one[r, 0], one[r, 1], one[r, 2]
        d, e, f = one[r, 3], one[r, 4], one[r, 5]
        for i in range(product.shape[1]):
            total = 0.0 + a * other[0, i]
            total = total + b * other[1, i]
            total = total + c * other[2, i]
            total = total + d * other[3, i]
            total = total + e * other[4, i]
            product[r, i] = total + f * other[5, i]


@njit(cache=True, forceinline=True, fastmath={"contract"})
def to_six(one: Array, other: Array, product: Array) -> None:
    """A product of `NARROW` columns: of 6 × s and s × 6."""
    for r in range(NARROW):
        a = b = c = d = e = f = 0.0
        for i in range(one.shape[1]):
            share = one[r, i]
            a, b, c = a + share * other[i, 0], b + share * other[i, 1], c + share * other[i, 2]
            d, e, f = d + share * other[i, 3], e + share * other[i, 4], f + share * other[i, 5]
        product[r, 0], product[r, 1], product[r, 2] = a, b, c
        product[r, 3], product[r, 4], product[r, 5] = d, e, f


@njit(cache=True, forceinline=True, fastmath={"contract"})
def by_any(one: Array, other: Array, product: Array) -> None:
    """A product that sums over any numbers, six of them at once: of 6 × s and s × m."""
    k, m = one.shape[1], product.shape[1]
    for r in range(NARROW):
        for i in range(m):
            product[r, i] = 0.0
        at = 0
        while at + NARROW <= k:
            a, b, c = one[r, at], one[r, at + 1], one[r, at + 2]
            d, e, f = one[r, at + 3], one[r, at + 4], one[r, at + 5]
            for i in range(m):
                total = product[r, i] + a * other[at, i]
                total = total + b * other[at + 1, i]
                total = total + c * other[at + 2, i]
                total = total + d * other[at + 3, i]
                total = total + e * other[at + 4, i]
                product[r, i] = total + f * other[at + 5, i]
            at += NARROW
        while at < k:
            for i in range(m):
                product[r, i] = product[r, i] + one[r, at] * other[at, i]
            at += 1
