"""Rows of readings added to the blocks of a chain, compiled."""

import numpy as np
from numba import njit

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array

END, ROW = 6, 15
"""Numbers of an end that moves; columns of a row: two ends, and three numbers that many rows share."""


@njit(cache=True, nogil=True)
def scatter_rows(
    chosen: Integers,
    slab: Integers,
    columns: Integers,
    jacobian: Array,
    information: Array,
    residual: Array,
    diagonal: Array,
    wide: Array,
    corner: Array,
    corner_gradient: Array,
) -> None:
    """Add HᵀP⁻¹H and HᵀP⁻¹r of some of m rows to a chain.

    Args:
        chosen: the rows to be added.
        slab: keyframe of each row, m; any where it touches none.
        columns: which numbers each row depends on, m × c: those of the keyframe first (below its width),
            those of the border after them; −1: unused. Of `ROW` they are those of two ends, six side by
            side of one that moves and three of one that stands, and up to three more; then one by itself.
        jacobian: derivatives, m × c.
        information: P⁻¹, m.
        residual: z − h(x), m.
        diagonal: k × n × n, changed.
        wide: border and gradient of each keyframe, k × n × (s + 1), changed.
        corner: s × s, changed.
        corner_gradient: s, changed.
    """
    width, last = diagonal.shape[1], len(corner_gradient)
    most = columns.shape[1]
    moving, lasting = np.empty(most, dtype=np.uint64), np.empty(most, dtype=np.uint64)
    by_moving, by_lasting = np.empty(most), np.empty(most)
    corners = corner.reshape(1, last, last)
    for r in chosen:
        if ROW <= most <= ROW + 1 and is_anchored(columns, r, width):
            row = columns, jacobian, information, residual
            add_anchored(r, slab[r], *row, diagonal, wide, corners, corner_gradient)
            continue
        m, s = 0, 0
        for a in range(most):
            at, slope = columns[r, a], jacobian[r, a]
            if at < 0 or slope == 0.0:
                continue
            if at < width:
                moving[m], by_moving[m] = at, slope
                m += 1
            else:
                lasting[s], by_lasting[s] = at - width, slope
                s += 1
        square, beside = diagonal[slab[r]], wide[slab[r]]
        for a in range(m):
            own, across = square[moving[a]], beside[moving[a]]
            pulled = by_moving[a] * information[r]
            across[last] += pulled * residual[r]
            for b in range(m):
                own[moving[b]] += pulled * by_moving[b]
            for b in range(s):
                across[lasting[b]] += pulled * by_lasting[b]
        for a in range(s):
            own, pulled = corner[lasting[a]], by_lasting[a] * information[r]
            corner_gradient[lasting[a]] += pulled * residual[r]
            for b in range(s):
                own[lasting[b]] += pulled * by_lasting[b]


@njit(cache=True, forceinline=True)
def is_anchored(columns: Integers, r: int, width: int) -> bool:
    """Whether one end of a row moves, and what it depends on of the border are threes side by side."""
    common = columns[r, 2 * END]
    moves = (0 <= columns[r, 0] < width) != (0 <= columns[r, END] < width)
    threes = columns[r, ROW - 1] == (common + 2 if common >= 0 else -1)
    return bool(moves and threes and (columns.shape[1] == ROW or columns[r, ROW] < 0))


@njit(cache=True, forceinline=True)
def add_anchored(
    r: int,
    slab: int,
    columns: Integers,
    jacobian: Array,
    information: Array,
    residual: Array,
    diagonal: Array,
    wide: Array,
    corners: Array,
    corner_gradient: Array,
) -> None:
    """Add one row that `is_anchored`, as most rows are: threes take half as long as single numbers.

    See `scatter_rows`; `corners` is the corner as the only one of some matrices.
    """
    width, last, only = diagonal.shape[1], np.uint64(len(corner_gradient)), np.uint64(0)
    one = 0 if 0 <= columns[r, 0] < width else END
    other, shared, at = END - one, 2 * END, np.uint64(slab)
    stands, common = columns[r, other] >= 0, columns[r, shared] >= 0
    first = np.uint64(columns[r, one])
    there = np.uint64(columns[r, other] - width if stands else 0)
    beside = np.uint64(columns[r, shared] - width if common else 0)
    # By where the end is that moves, by its last three numbers, by the other end, and by what is shared.
    a, b, c = jacobian[r, one], jacobian[r, one + 1], jacobian[r, one + 2]
    d, e, f = jacobian[r, one + 3], jacobian[r, one + 4], jacobian[r, one + 5]
    g, h, i = jacobian[r, other], jacobian[r, other + 1], jacobian[r, other + 2]
    j, k, m = jacobian[r, shared], jacobian[r, shared + 1], jacobian[r, shared + 2]
    turned = d != 0.0 or e != 0.0 or f != 0.0
    for n in range(END if turned else 3):
        row, pulled = first + np.uint64(n), jacobian[r, one + n] * information[r]
        wide[at, row, last] += pulled * residual[r]
        add_three(diagonal, at, row, first, pulled, a, b, c)
        if turned:
            add_three(diagonal, at, row, first + np.uint64(3), pulled, d, e, f)
        if stands:
            add_three(wide, at, row, there, pulled, g, h, i)
        if common:
            add_three(wide, at, row, beside, pulled, j, k, m)
    for n in range(3 if stands else 0):
        row, pulled = there + np.uint64(n), jacobian[r, other + n] * information[r]
        corner_gradient[row] += pulled * residual[r]
        add_three(corners, only, row, there, pulled, g, h, i)
        if common:
            add_three(corners, only, row, beside, pulled, j, k, m)
    for n in range(3 if common else 0):
        row, pulled = beside + np.uint64(n), jacobian[r, shared + n] * information[r]
        corner_gradient[row] += pulled * residual[r]
        if stands:
            add_three(corners, only, row, there, pulled, g, h, i)
        add_three(corners, only, row, beside, pulled, j, k, m)


@njit(cache=True, forceinline=True)
def add_three(
    targets: Array,
    at: np.uint64,
    row: np.uint64,
    column: np.uint64,
    share: float,
    a: float,
    b: float,
    c: float,
) -> None:
    """Add a share of three numbers to a row of one of some matrices, from a column on."""
    second, third = column + np.uint64(1), column + np.uint64(2)
    x, y, z = targets[at, row, column], targets[at, row, second], targets[at, row, third]
    targets[at, row, column] = x + share * a
    targets[at, row, second], targets[at, row, third] = y + share * b, z + share * c
