"""The curvature of distances, added to the normal equations of a window: a loop over its pairs, compiled."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion.ledger import RANGE, RSSI
from estimator.graph.dense import Array
from estimator.graph.kernels import Integers
from estimator.measurements.range import range_slope
from estimator.measurements.rssi import ANTENNA_M, rssi_slope
from estimator.smoothing.ends import place_end
from estimator.smoothing.linear import Readings
from estimator.smoothing.walks import STATES

NOWHERE_M2 = 1e-6


@njit(cache=True)
def add_bends(
    readings: Readings,
    chosen: Integers,
    x: Array,
    information: Array,
    residual: Array,
    signed: bool,
    slab: Integers,
    columns: Integers,
    diagonal: Array,
    wide: Array,
    corner: Array,
) -> None:
    """Add the curvature of distances, which Gauss-Newton leaves out: −P⁻¹ r ∂²h/∂x².

    A distance that does not fit its reading bends across the line of sight, and a power that falls with its
    logarithm bends along it as well, the other way. Without this a step goes several times too far wherever
    radios are near each other. Upwards only what is positive is taken: on a level floor a height and its
    mirror image fit alike, and between them the cost bends down. Along the floor negative curvature is needed
    where a whole incident may still turn: it takes away what is positive there.

    Args:
        readings: of the window.
        chosen: which pairs.
        x: the estimate, flat.
        information: P⁻¹ of each pair, m at least.
        residual: z − h(x) as it is weighed, m at least.
        signed: take negative curvature along the floor too; else only what is positive.
        slab: keyframe of each pair, m at least.
        columns: as `graph.scatter.scatter_rows` takes them, m at least.
        diagonal: k × n × n, changed.
        wide: border and gradient of each keyframe, k × n × (s + 1); the border is changed.
        corner: s × s, changed.
    """
    a, b, by_a, by_b = np.empty(3), np.empty(3), np.zeros((3, 3)), np.zeros((3, 3))
    bend, pulled_a, pulled_b = np.empty((3, 3)), np.empty((3, STATES)), np.empty((3, STATES))
    at_a, at_b = np.empty(STATES, dtype=np.uint64), np.empty(STATES, dtype=np.uint64)
    width = diagonal.shape[1]
    # What is taken out of a tuple in the loop is counted in the loop.
    ends_a, ends_b, kinds, extra = readings.a, readings.b, readings.kind, readings.extra
    for i in chosen:
        kind = kinds[i]
        if kind > RSSI:
            continue
        by_a[:], by_b[:] = 0.0, 0.0
        place_end(ends_a, i, x, a, by_a)
        place_end(ends_b, i, x, b, by_b)
        e, n, u = a[0] - b[0], a[1] - b[1], a[2] - b[2]
        level, squared = e * e + n * n, e * e + n * n + u * u
        if level < NOWHERE_M2:
            continue
        state = x[extra[i, 0 if kind == RANGE else 1]]
        bent = range_slope(squared, state) if kind == RANGE else rssi_slope(squared, state)
        across = -information[i] * residual[i] * bent
        along = 0.0
        if kind == RSSI:
            along = across * (1.0 - 2.0 * squared / (squared + ANTENNA_M * ANTENNA_M))
        upwards = max(across, 0.0)
        if not signed:
            across, along = upwards, max(along, 0.0)
        if across == 0.0 and upwards == 0.0 and along == 0.0:
            continue
        bend_at(e, n, u, across, upwards, along, bend)
        first, second = columns[i, 0], columns[i, STATES]
        square, beside = diagonal[slab[i]], wide[slab[i]]
        for c in range(STATES):
            at_a[c], at_b[c] = columns[i, c], columns[i, STATES + c]
        if 0 <= first < width:
            pull(bend, by_a, pulled_a)
            add_between(square, at_a, at_a, by_a, pulled_a, 1.0)
        if 0 <= second < width:
            pull(bend, by_b, pulled_b)
            add_between(square, at_b, at_b, by_b, pulled_b, 1.0)
            if 0 <= first < width:
                add_between(square, at_a, at_b, by_a, pulled_b, -1.0)
                add_between(square, at_b, at_a, by_b, pulled_a, -1.0)
        if first >= width:
            add_lasting(corner, first - width, first - width, bend, 1.0)
            if 0 <= second < width:
                add_beside(beside, at_b, first - width, pulled_b)
        if second >= width:
            add_lasting(corner, second - width, second - width, bend, 1.0)
            if 0 <= first < width:
                add_beside(beside, at_a, second - width, pulled_a)
            elif first >= width:
                add_lasting(corner, first - width, second - width, bend, -1.0)
                add_lasting(corner, second - width, first - width, bend, -1.0)


@njit(cache=True)
def bend_at(e: float, n: float, u: float, across: float, upwards: float, along: float, bend: Array) -> None:
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
def pull(bend: Array, turned: Array, pulled: Array) -> None:
    """`pulled`, B [1 T], 3 × 6, of a curvature B (3 × 3) and the derivatives T (3 × 3) of an end's place."""
    for r in range(3):
        for c in range(3):
            pulled[r, c] = bend[r, c]
            pulled[r, 3 + c] = (
                bend[r, 0] * turned[0, c] + bend[r, 1] * turned[1, c] + bend[r, 2] * turned[2, c]
            )


@njit(cache=True)
def add_between(
    square: Array,
    rows: NDArray[np.uint64],
    columns: NDArray[np.uint64],
    turned: Array,
    pulled: Array,
    sign: float,
) -> None:
    """Add ±[1 T]ᵀ `pulled` to the block of two moving ends.

    Args:
        square: of their keyframe, n × n, changed.
        rows: the numbers of one end, 6.
        columns: those of the other, 6.
        turned: T of the one.
        pulled: see `pull`, of the other.
        sign: 1 or −1.
    """
    for r in range(3):
        own, turns = rows[r], rows[3 + r]
        for c in range(STATES):
            square[own, columns[c]] += sign * pulled[r, c]
            square[turns, columns[c]] += sign * (
                turned[0, r] * pulled[0, c] + turned[1, r] * pulled[1, c] + turned[2, r] * pulled[2, c]
            )


@njit(cache=True)
def add_beside(beside: Array, rows: NDArray[np.uint64], start: int, pulled: Array) -> None:
    """Add −`pulled`ᵀ to a keyframe's border: between a moving end and one that stands.

    Args:
        beside: n × (s + 1), changed.
        rows: the numbers of the moving end, 6.
        start: first column of the one that stands.
        pulled: see `pull`, of the moving end.
    """
    for c in range(STATES):
        for r in range(3):
            beside[rows[c], start + r] -= pulled[r, c]


@njit(cache=True)
def add_lasting(corner: Array, row: int, column: int, bend: Array, sign: float) -> None:
    """Add ±B to the corner, at the first row and column of two ends that stand."""
    for r in range(3):
        for c in range(3):
            corner[row + r, column + c] += sign * bend[r, c]
