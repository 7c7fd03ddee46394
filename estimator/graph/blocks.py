"""Blocks of 3 × 3 numbers, multiplied and added to matrices, compiled."""

from numba import njit

from estimator.graph.dense import Array

SIDE = 3


@njit(cache=True)
def add_block(targets: Array, at: int, row: int, column: int, block: Array, sign: float) -> None:
    """Add ±`block`, 3 × 3, to one of some matrices, from a row and a column on.

    A view of the matrix would be counted, again and again, and that takes longer than the sum.
    """
    for r in range(SIDE):
        for c in range(SIDE):
            targets[at, row + r, column + c] += sign * block[r, c]


@njit(cache=True)
def add_across(targets: Array, at: int, row: int, column: int, block: Array, sign: float) -> None:
    """The same with the block's transpose."""
    for r in range(SIDE):
        for c in range(SIDE):
            targets[at, row + r, column + c] += sign * block[c, r]


@njit(cache=True)
def add_both(targets: Array, at: int, row: int, column: int, block: Array, sign: float) -> None:
    """The same to a symmetric matrix: the block, and across the diagonal its transpose."""
    add_block(targets, at, row, column, block, sign)
    add_across(targets, at, column, row, block, sign)


@njit(cache=True)
def multiply(one: Array, other: Array, product: Array) -> None:
    """Put A B in the place of `product`, 3 × 3 each."""
    for r in range(SIDE):
        for c in range(SIDE):
            product[r, c] = one[r, 0] * other[0, c] + one[r, 1] * other[1, c] + one[r, 2] * other[2, c]


@njit(cache=True)
def multiply_across(one: Array, other: Array, product: Array) -> None:
    """Put Aᵀ B in the place of `product`, 3 × 3 each."""
    for r in range(SIDE):
        for c in range(SIDE):
            product[r, c] = one[0, r] * other[0, c] + one[1, r] * other[1, c] + one[2, r] * other[2, c]
