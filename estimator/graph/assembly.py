"""Rows of readings put into groups, and motions added to the blocks of a chain, compiled."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.graph.chain_kernels import NARROW, Integers
from estimator.graph.dense import Array


@njit(cache=True)
def couple(columns: Integers, width: int, size: int, label: Integers, touched: NDArray[np.bool_]) -> None:
    """Give blocks that share a row one label, the lowest of theirs, and tell what each touches of the border.

    Args:
        columns: which numbers each row depends on, m × c: those of a keyframe first (below `width`), those of
            the border after them; −1: unused.
        width: columns of a keyframe, in blocks of `size`.
        size: columns of a block.
        label: of each block, changed.
        touched: blocks × s, changed: of one block of a row that has several.
    """
    m, most = columns.shape
    for r in range(m):
        first = -1
        for a in range(most):
            if 0 <= columns[r, a] < width:
                block = columns[r, a] // size
                if first < 0:
                    first = block
                elif label[block] != label[first]:
                    low, high = min(label[block], label[first]), max(label[block], label[first])
                    for i in range(len(label)):
                        if label[i] == high:
                            label[i] = low
        if first >= 0:
            for a in range(most):
                if columns[r, a] >= width:
                    touched[first, columns[r, a] - width] = True


@njit(cache=True)
def localise(
    columns: Integers, width: int, size: int, group_of: Integers, place: Integers
) -> tuple[Integers, Integers, Integers]:
    """Columns of rows in the numbering of their groups, and which rows are of each group.

    Args:
        columns: as `couple` takes them.
        width: columns of a keyframe.
        size: columns of a block.
        group_of: group of each block.
        place: column of each group's numbering, groups × all columns; what touches nothing that moves is of
            the last group.

    Returns:
        The columns, m × c; the rows, group after group and in order, m; where each group begins among these,
        and where the last one ends, groups + 1.
    """
    m, most = columns.shape
    found, group = np.full((m, most), -1, dtype=np.int64), np.full(m, len(place) - 1)
    ends = np.zeros(len(place) + 1, dtype=np.int64)
    for r in range(m):
        for a in range(most):
            if 0 <= columns[r, a] < width:
                group[r] = group_of[columns[r, a] // size]
                break
        for a in range(most):
            if columns[r, a] >= 0:
                found[r, a] = place[group[r], columns[r, a]]
        ends[group[r] + 1] += 1
    for g in range(len(place)):
        ends[g + 1] += ends[g]
    order, following = np.empty(m, dtype=np.int64), ends.copy()
    for r in range(m):
        order[following[group[r]]] = r
        following[group[r]] += 1
    return found, order, ends


@njit(cache=True)
def add_part(at: Integers, part: Array, part_gradient: Array, corner: Array, gradient: Array) -> None:
    """Add what one group says of some of the border's numbers to what is known of all of them.

    Args:
        at: which of them, m.
        part: m × m.
        part_gradient: m.
        corner: s × s, changed.
        gradient: s, changed.
    """
    for i in range(len(at)):
        gradient[at[i]] += part_gradient[i]
        for j in range(len(at)):
            corner[at[i], at[j]] += part[i, j]


@njit(cache=True, nogil=True)
def add_motion(
    block: int,
    first: int,
    transition: Array,
    information: Array,
    residual: Array,
    diagonal: Array,
    link: Array,
    wide: Array,
) -> None:
    """Add the motion of one node to a chain: x' − F x = r with information Q⁻¹, step after step.

    Args:
        block: which of the keyframe's blocks of six numbers is the node's.
        first: keyframe that its first step leaves from.
        transition: F, m × 6 × 6.
        information: Q⁻¹, m × 6 × 6.
        residual: r, m × 6.
        diagonal: k × n × n, changed.
        link: (k − 1) × blocks × 6 × 6, changed.
        wide: k × n × (s + 1), its last column changed.
    """
    at, last = np.uint64(block * NARROW), wide.shape[2] - 1
    pulled = np.empty((NARROW, NARROW))  # Fᵀ Q⁻¹
    for step in range(len(residual)):
        before, after = first + step, first + step + 1
        # Most of F is nil: to look where takes longer than sums of six in registers.
        for r in range(NARROW):
            a, b, c = transition[step, 0, r], transition[step, 1, r], transition[step, 2, r]
            d, e, f = transition[step, 3, r], transition[step, 4, r], transition[step, 5, r]
            for i in range(NARROW):
                total = a * information[step, 0, i] + b * information[step, 1, i]
                total += c * information[step, 2, i]
                total += d * information[step, 3, i]
                total += e * information[step, 4, i]
                pulled[r, i] = total + f * information[step, 5, i]
        for r in range(NARROW):
            row = at + np.uint64(r)
            a, b, c = pulled[r, 0], pulled[r, 1], pulled[r, 2]
            d, e, f = pulled[r, 3], pulled[r, 4], pulled[r, 5]
            for i in range(NARROW):
                total = a * transition[step, 0, i] + b * transition[step, 1, i]
                total += c * transition[step, 2, i]
                total += d * transition[step, 3, i]
                total += e * transition[step, 4, i]
                diagonal[before, row, at + np.uint64(i)] += total + f * transition[step, 5, i]
            for i in range(NARROW):
                diagonal[after, row, at + np.uint64(i)] += information[step, r, i]
                link[before, block, i, r] -= pulled[r, i]
            here, there = wide[before, row, last], wide[after, row, last]
            for i in range(NARROW):
                here += pulled[r, i] * residual[step, i]
                there -= information[step, r, i] * residual[step, i]
            wide[before, row, last], wide[after, row, last] = here, there
