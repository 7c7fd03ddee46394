"""The curvature of distances, added to the normal equations of a window: a loop over its pairs, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.graph.blocks import add_across, add_block, add_both, multiply, multiply_across
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.measurements.range import range_slope
from estimator.measurements.rssi import ANTENNA_M, rssi_slope
from estimator.smoothing.keyframes.ends import Table, place_end
from estimator.smoothing.keyframes.walks import PLACES, STATES

NOWHERE_M2 = 1e-6


class BentPairs(NamedTuple):
    """What the curvature of m pairs follows from: each array of a call is unpacked by every one of them.

    Attributes:
        kind: see `linearisation.Readings`, as the others.
        extra: the same.
        a: the same.
        b: the same.
    """

    kind: Integers
    extra: Integers
    a: Table
    b: Table


class Numbers(NamedTuple):
    """Where in the normal matrix the numbers of m rows are, at least of the pairs.

    Attributes:
        slab: keyframe of each row, m.
        columns: as `graph.scatter.scatter_rows` takes them, m × c.
    """

    slab: Integers
    columns: Integers


class NormalMatrix(NamedTuple):
    """The normal matrix of a chain without its links: what is measured at an epoch couples no two keyframes.

    Attributes:
        diagonal: of the keyframes, k × n × n.
        wide: border and gradient of each keyframe, k × n × (s + 1).
        corner: of the border, 1 × s × s.
    """

    diagonal: Array
    wide: Array
    corner: Array


@njit(cache=True, nogil=True)
def add_curvature(
    pairs: BentPairs,
    chosen: Integers,
    estimate: Array,
    weight: Array,
    signed: bool,
    placed: Numbers,
    matrix: NormalMatrix,
) -> None:
    """Add the curvature of distances, which Gauss-Newton leaves out: −P⁻¹ r ∂²h/∂x².

    A distance that does not fit its reading bends across the line of sight, and a power that falls with its
    logarithm bends along it as well, the other way. Without this a step goes several times too far wherever
    radios are near each other. Upwards only what is positive is taken: on a level floor a height and its
    mirror image fit alike, and between them the cost bends down. Along the floor negative curvature is needed
    where a whole incident may still turn: it takes away what is positive there.

    Args:
        pairs: of the window.
        chosen: which of them.
        estimate: see `ends.faced`.
        weight: P⁻¹ r of each pair, r as it is weighed, m at least.
        signed: take negative curvature along the floor too; else only what is positive.
        placed: where the rows are in the normal matrix.
        matrix: is changed.
    """
    a, b, by_a, by_b = np.empty(3), np.empty(3), np.zeros((3, 3)), np.zeros((3, 3))
    bend, both = np.empty((3, 3)), np.empty((3, 3))
    pulled_a, pulled_b = np.empty((3, 3)), np.empty((3, 3))
    slab, columns = placed
    diagonal, wide, corner = matrix
    width = diagonal.shape[1]
    # What is taken out of a tuple in the loop is counted in the loop.
    kinds, extra, ends_a, ends_b = pairs
    for i in chosen:
        kind = kinds[i]
        if kind > RSSI:
            continue
        by_a[:], by_b[:] = 0.0, 0.0
        place_end(ends_a, i, estimate, a, by_a)
        place_end(ends_b, i, estimate, b, by_b)
        e, n, u = a[0] - b[0], a[1] - b[1], a[2] - b[2]
        level = e * e + n * n
        if level < NOWHERE_M2:
            continue
        squared = level + u * u
        state = estimate[extra[i, 0 if kind == RANGE else 1], 0]
        across, upwards, along = bends(kind, squared, state, weight[i], signed)
        if across == 0.0 and upwards == 0.0 and along == 0.0:
            continue
        curvature_at(e, n, u, across, upwards, along, bend)
        at, first, second = slab[i], columns[i, 0], columns[i, STATES]
        a_moves, b_moves = 0 <= first < width, 0 <= second < width
        # Many readings are made at their keyframes: from there nothing has been turned.
        a_turns, b_turns = a_moves and turns(by_a), b_moves and turns(by_b)
        if a_moves:
            add_moving(diagonal, at, first, bend, by_a, pulled_a, a_turns, both)
        elif first >= width:
            add_block(corner, 0, first - width, first - width, bend, 1.0)
        if b_moves:
            add_moving(diagonal, at, second, bend, by_b, pulled_b, b_turns, both)
        elif second >= width:
            add_block(corner, 0, second - width, second - width, bend, 1.0)
        if a_moves and b_moves:
            add_both(diagonal, at, first, second, bend, -1.0)
            if a_turns:
                add_both(diagonal, at, second, first + PLACES, pulled_a, -1.0)
            if b_turns:
                add_both(diagonal, at, first, second + PLACES, pulled_b, -1.0)
            if a_turns and b_turns:
                multiply_across(by_a, pulled_b, both)
                add_both(diagonal, at, first + PLACES, second + PLACES, both, -1.0)
        elif a_moves and second >= width:
            add_to_border(wide, at, first, second - width, bend, pulled_a, a_turns)
        elif b_moves and first >= width:
            add_to_border(wide, at, second, first - width, bend, pulled_b, b_turns)
        elif first >= width and second >= width:
            add_both(corner, 0, first - width, second - width, bend, -1.0)


@njit(cache=True, forceinline=True)
def bends(kind: int, squared: float, state: float, weight: float, signed: bool) -> tuple[float, float, float]:
    """Curvature of the cost of a pair across its line of sight along the floor, upwards, and along it (m⁻²).

    Args:
        kind: `RANGE`, or `RSSI`.
        squared: its distance squared (m²).
        state: what its slope depends on: the scale error of ranges, or n.
        weight: P⁻¹ r.
        signed: negative curvature along the floor too; else only what is positive.
    """
    bent = range_slope(squared, state) if kind == RANGE else rssi_slope(squared, state)
    across, along = -weight * bent, 0.0
    if kind == RSSI:
        along = across * (1.0 - 2.0 * squared / (squared + ANTENNA_M * ANTENNA_M))
    upwards = max(across, 0.0)
    return (across, upwards, along) if signed else (upwards, upwards, max(along, 0.0))


@njit(cache=True)
def curvature_at(
    e: float, n: float, u: float, across: float, upwards: float, along: float, bend: Array
) -> None:
    """A curvature that is given along three axes at right angles, by the place of one end.

    Args:
        e: the line of sight, east (m).
        n: the same, north (m).
        u: the same, up (m).
        across: along the horizontal axis across the line of sight.
        upwards: along the other axis across it.
        along: along the line of sight itself.
        bend: takes it, 3 × 3.
    """
    level = e * e + n * n
    squared = level + u * u
    flat, distance = np.sqrt(level), np.sqrt(squared)
    right_e, right_n = -n / flat, e / flat
    over_e, over_n, over_u = -e * u / (flat * distance), -n * u / (flat * distance), flat / distance
    there_e, there_n, there_u = e / distance, n / distance, u / distance
    bend[0, 0] = across * right_e * right_e + upwards * over_e * over_e + along * there_e * there_e
    bend[1, 1] = across * right_n * right_n + upwards * over_n * over_n + along * there_n * there_n
    bend[2, 2] = upwards * over_u * over_u + along * there_u * there_u
    bend[0, 1] = across * right_e * right_n + upwards * over_e * over_n + along * there_e * there_n
    bend[0, 2] = upwards * over_e * over_u + along * there_e * there_u
    bend[1, 2] = upwards * over_n * over_u + along * there_n * there_u
    bend[1, 0], bend[2, 0], bend[2, 1] = bend[0, 1], bend[0, 2], bend[1, 2]


@njit(cache=True)
def turns(turned: Array) -> bool:
    """Whether anything but its first three numbers moves an end: any derivative, 3 × 3, is not 0."""
    size = 0.0
    for r in range(PLACES):
        for c in range(PLACES):
            size += abs(turned[r, c])
    return size > 0.0


@njit(cache=True, forceinline=True)
def add_moving(
    diagonal: Array, at: int, first: int, bend: Array, by: Array, pulled: Array, turned: bool, both: Array
) -> None:
    """Add the block of an end that moves: B, and where T is not nil B T, its transpose, and Tᵀ B T.

    Put where it is called, see `ends.place_end`.

    Args:
        diagonal: of the keyframes, k × n × n, changed.
        at: its keyframe.
        first: the first of its numbers.
        bend: B, curvature by its place, 3 × 3.
        by: T, derivatives of its place by its last three numbers, 3 × 3.
        pulled: takes B T, 3 × 3.
        turned: whether T is not nil.
        both: is used, 3 × 3.
    """
    add_block(diagonal, at, first, first, bend, 1.0)
    if turned:
        multiply(bend, by, pulled)
        add_both(diagonal, at, first, first + PLACES, pulled, 1.0)
        multiply_across(by, pulled, both)
        add_block(diagonal, at, first + PLACES, first + PLACES, both, 1.0)


@njit(cache=True, forceinline=True)
def add_to_border(
    wide: Array, at: int, first: int, lasting: int, bend: Array, pulled: Array, turned: bool
) -> None:
    """Add what couples an end that moves, from its first number on, to one that lasts."""
    add_block(wide, at, first, lasting, bend, -1.0)
    if turned:
        add_across(wide, at, first + PLACES, lasting, pulled, -1.0)
