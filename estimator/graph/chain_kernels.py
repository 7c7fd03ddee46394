"""Inner loops, compiled."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.graph.dense import Array

Integers = NDArray[np.int64]

NARROW = 6
"""Keyframes of one walk are eliminated faster by plain loops than by calls of BLAS."""


@njit(cache=True)
def half_inverse(matrix: Array) -> bool:
    """C⁻¹ of A = C Cᵀ in the place of A, n × n, lower triangle: A⁻¹ = C⁻ᵀ C⁻¹.

    Rows of A and of what becomes C⁻¹ are reduced together, above and below the diagonal.

    Returns:
        False where A is not positive definite and finite: then it is spoilt.
    """
    n = len(matrix)
    for j in range(n):
        pivot = matrix[j]
        if not 0.0 < pivot[j] < np.inf:
            return False
        scale = 1.0 / np.sqrt(pivot[j])
        for c in range(n):
            pivot[c] *= scale
        pivot[j] = scale
        for i in range(j + 1, n):
            row, share = matrix[i], pivot[i]
            row[j] = 0.0
            for c in range(j + 1):
                row[c] -= share * pivot[c]
            for c in range(i, n):
                row[c] -= share * pivot[c]
    for j in range(n):
        matrix[j, j + 1 :] = 0.0
    return True


@njit(cache=True)
def turn_link(blocks: Array, turned: Array) -> None:
    """Eᵀ, n × n, of a link E given as blocks along its diagonal (blocks × b × b); elsewhere 0 as before."""
    count, size, _ = blocks.shape
    for block in range(count):
        at = block * size
        for r in range(size):
            for c in range(size):
                turned[at + r, at + c] = blocks[block, c, r]


@njit(cache=True, nogil=True)
def eliminate(first: int, last: int, diagonal: Array, link: Array, wide: Array) -> int:
    """Operation 3 of paper A (eq. 17) for keyframes `first` to `last` − 1, one after the other.

    What it needs to go back stays in the place of what it used: C⁻¹ in `diagonal`, W = C⁻¹ [B g] in `wide`.
    What the border loses by it, Wᵀ W, is left to be taken off at once.

    Args:
        first: keyframe to begin with.
        last: keyframe to stop before.
        diagonal: D, k × n × n.
        link: E, keyframe j + 1 by keyframe j, blocks along its diagonal, (k − 1) × blocks × b × b.
        wide: B and g, k × n × (s + 1).

    Returns:
        The keyframe that could not be eliminated, as it is after those before it; `last`: there is none.
    """
    length, width, across = wide.shape
    if width == NARROW and link.shape[1] == 1:
        return eliminate_narrow(first, last, diagonal, link, wide)
    inverse, half = np.empty((width, width)), np.empty((width, width))
    done, lost, taken = np.empty((width, across)), np.empty((width, width)), np.empty((width, across))
    turned = np.zeros((width, width))
    for j in range(first, last):
        inverse[:] = diagonal[j]
        if not half_inverse(inverse):
            return j
        diagonal[j] = inverse
        np.dot(inverse, wide[j], done)
        wide[j] = done
        if j < length - 1:
            turn_link(link[j], turned)
            np.dot(inverse, turned, half)
            np.dot(half.T, half, lost)
            np.dot(half.T, done, taken)
            diagonal[j + 1] -= lost
            wide[j + 1] -= taken
    return last


@njit(cache=True)
def eliminate_narrow(first: int, last: int, diagonal: Array, link: Array, wide: Array) -> int:
    """`eliminate` for keyframes of one block of `NARROW` numbers."""
    length, _, across = wide.shape
    inverse, half = np.empty((NARROW, NARROW)), np.empty((NARROW, NARROW))
    back, done = np.empty((NARROW, NARROW)), np.empty((NARROW, across))
    for j in range(first, last):
        for r in range(NARROW):
            for c in range(NARROW):
                inverse[r, c] = diagonal[j, r, c]
        if not half_inverse(inverse):
            return j
        for r in range(NARROW):
            for c in range(NARROW):
                diagonal[j, r, c] = inverse[r, c]
            for i in range(across):
                done[r, i], wide[j, r, i] = wide[j, r, i], 0.0
        for r in range(NARROW):
            add_narrow(inverse, r, done, wide, j)
        if j == length - 1:
            break
        for r in range(NARROW):
            for i in range(across):
                done[r, i] = wide[j, r, i]
            for a in range(NARROW):
                total = 0.0
                for c in range(r + 1):
                    total += inverse[r, c] * link[j, 0, a, c]
                half[r, a], back[a, r] = total, -total
        for a in range(NARROW):
            add_narrow(back, a, half, diagonal, j + 1)
            add_narrow(back, a, done, wide, j + 1)
    return last


@njit(cache=True, forceinline=True)
def add_narrow(shares: Array, row: int, rows: Array, targets: Array, at: int) -> None:
    """Add to a row of one of some matrices shares of `NARROW` rows.

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


@njit(cache=True, nogil=True)
def take_off(first: int, last: int, wide: Array, corner: Array, gradient: Array) -> float:
    """Take off the border what it has lost by `eliminate`, Wᵀ W.

    Args:
        first: keyframe that was eliminated first.
        last: keyframe after the one that was last.
        wide: W, k × n × (s + 1).
        corner: s × s, changed.
        gradient: s, changed.

    Returns:
        What the gradient loses beside them, gᵀ D⁻¹ g of the keyframes.
    """
    width, across = wide.shape[1:]
    done = wide[first:last].reshape((last - first) * width, across)
    taken = np.dot(done.T, done)
    for r in range(across - 1):
        gradient[r] -= taken[r, across - 1]
        for c in range(across - 1):
            corner[r, c] -= taken[r, c]
    return float(taken[across - 1, across - 1])


@njit(cache=True, nogil=True)
def substitute(diagonal: Array, link: Array, wide: Array, fixed: Array, steps: Array) -> None:
    """Steps of all keyframes (k × n) after `eliminate`, from the end back, for a step of the border (s)."""
    length, width, across = wide.shape
    size = link.shape[2]
    tail, carried = np.ones(across), np.empty(width)
    tail[: across - 1] = -fixed
    rights = np.dot(wide.reshape(length * width, across), tail).reshape(length, width)
    for j in range(length - 1, -1, -1):
        if j < length - 1:
            for c in range(width):
                block = c // size
                at, total = block * size, 0.0
                for i in range(size):
                    total += link[j, block, i, c - at] * steps[j + 1, at + i]
                carried[c] = total
            for r in range(width):
                total = 0.0
                for c in range(r + 1):
                    total += diagonal[j, r, c] * carried[c]
                rights[j, r] -= total
        for c in range(width):
            steps[j, c] = 0.0
        for r in range(width):
            for c in range(r + 1):
                steps[j, c] += diagonal[j, r, c] * rights[j, r]


@njit(cache=True, nogil=True)
def selected_inverse(
    diagonal: Array, link: Array, wide: Array, border_covariance: Array, found: Array, ahead: Array
) -> None:
    """After `eliminate`: covariance of each block at each keyframe, and with itself at the next one.

    Args:
        diagonal: as `eliminate` leaves it, k × n × n.
        link: E, as `eliminate` takes it.
        wide: as `eliminate` leaves it, k × n × (s + 1).
        border_covariance: s × s.
        found: k × blocks × b × b, changed.
        ahead: rows of a keyframe, columns of the next, (k − 1) × blocks × b × b, changed.
    """
    length, width, across = wide.shape
    count, size, lasting = found.shape[1], found.shape[2], across - 1
    border, to_border = np.empty((width, lasting)), np.empty((width, lasting))
    with_border, next_border = np.empty((width, lasting)), np.zeros((width, lasting))
    on_border, turned = np.empty((width, lasting)), np.zeros((width, width))
    covariance, next_covariance = np.empty((width, width)), np.zeros((width, width))
    to_next, with_next = np.empty((width, width)), np.empty((width, width))
    product = np.empty((width, width))
    for j in range(length - 1, -1, -1):
        border[:] = wide[j, :, :lasting]
        np.dot(diagonal[j].T, border, to_border)
        turn_sign(to_border)
        np.dot(to_border, border_covariance, with_border)
        np.dot(diagonal[j].T, diagonal[j], covariance)
        if j < length - 1:
            turn_link(link[j], turned)
            np.dot(covariance, turned, to_next)
            turn_sign(to_next)
            np.dot(to_next, next_covariance, with_next)
            np.dot(to_border, next_border.T, product)
            add(product, with_next)
            np.dot(to_next, next_border, on_border)
            add(on_border, with_border)
            np.dot(with_next, to_next.T, product)
            add(product, covariance)
            for block in range(count):
                own = slice(block * size, (block + 1) * size)
                ahead[j, block] = with_next[own, own]
        np.dot(with_border, to_border.T, product)
        add(product, covariance)
        for r in range(width):
            for c in range(r + 1):
                mean = 0.5 * (covariance[r, c] + covariance[c, r])
                next_covariance[r, c] = next_covariance[c, r] = mean
        for block in range(count):
            own = slice(block * size, (block + 1) * size)
            found[j, block] = next_covariance[own, own]
        with_border, next_border = next_border, with_border


@njit(cache=True)
def turn_sign(matrix: Array) -> None:
    """−A in the place of A."""
    for r in range(len(matrix)):
        for c in range(matrix.shape[1]):
            matrix[r, c] = -matrix[r, c]


@njit(cache=True)
def add(more: Array, total: Array) -> None:
    """Add a matrix to another one in its place."""
    for r in range(len(total)):
        for c in range(total.shape[1]):
            total[r, c] += more[r, c]
