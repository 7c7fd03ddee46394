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

MOVED = 12
"""Numbers that the places of a pair depend on at most: two ends of six."""
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
    axis, along, slope = np.empty((3, 3)), np.empty(3), np.empty((3, 2 * MOVED))
    at = np.empty(MOVED, dtype=np.uint64)
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
        distance, flat = np.sqrt(squared), np.sqrt(level)
        axis[0, 0], axis[0, 1], axis[0, 2] = -n / flat, e / flat, 0.0
        axis[1, 0], axis[1, 1] = -e * u / (flat * distance), -n * u / (flat * distance)
        axis[1, 2] = flat / distance
        axis[2, 0], axis[2, 1], axis[2, 2] = e / distance, n / distance, u / distance
        along[0], along[1] = across if signed else max(across, 0.0), max(across, 0.0)
        along[2] = 0.0
        if kind == RSSI:
            along[2] = across * (1.0 - 2.0 * squared / (squared + ANTENNA_M * ANTENNA_M))
            along[2] = along[2] if signed else max(along[2], 0.0)
        if along[0] == 0.0 and along[1] == 0.0 and along[2] == 0.0:
            continue
        for way in range(3):
            east, north, up = axis[way, 0], axis[way, 1], axis[way, 2]
            for c in range(3):
                slope[way, c], slope[way, 6 + c] = axis[way, c], -axis[way, c]
                slope[way, 3 + c] = east * by_a[0, c] + north * by_a[1, c] + up * by_a[2, c]
                slope[way, 9 + c] = -(east * by_b[0, c] + north * by_b[1, c] + up * by_b[2, c])
        add_square(columns, i, slope, along, diagonal, wide, corner, slab[i], at)


@njit(cache=True)
def add_square(
    columns: Integers,
    row: int,
    slope: Array,
    along: Array,
    diagonal: Array,
    wide: Array,
    corner: Array,
    slab: int,
    at: NDArray[np.uint64],
) -> None:
    """Add Hᵀ P⁻¹ H of three rows H to the blocks of their keyframe and of the border.

    Args:
        columns: see `add_bends`.
        row: which of them is theirs.
        slope: derivatives, 3 × 12, and room for as many.
        along: P⁻¹, 3.
        diagonal: see `add_bends`.
        wide: see `add_bends`.
        corner: see `add_bends`.
        slab: their keyframe.
        at: room for 12 columns.
    """
    width, count = diagonal.shape[1], 0
    for c in range(MOVED):
        if 0 <= columns[row, c] < width:
            at[count] = columns[row, c]
            for way in range(3):
                slope[way, MOVED + count] = slope[way, c]
            count += 1
    moving = count
    for c in range(MOVED):
        if columns[row, c] >= width:
            at[count] = columns[row, c] - width
            for way in range(3):
                slope[way, MOVED + count] = slope[way, c]
            count += 1
    first, second, third = slope[0, MOVED:], slope[1, MOVED:], slope[2, MOVED:]
    square, beside = diagonal[slab], wide[slab]
    for i in range(moving):
        own, across = square[at[i]], beside[at[i]]
        by_first, by_second, by_third = along[0] * first[i], along[1] * second[i], along[2] * third[i]
        for j in range(moving):
            own[at[j]] += by_first * first[j] + by_second * second[j] + by_third * third[j]
        for j in range(moving, count):
            across[at[j]] += by_first * first[j] + by_second * second[j] + by_third * third[j]
    for i in range(moving, count):
        own = corner[at[i]]
        by_first, by_second, by_third = along[0] * first[i], along[1] * second[i], along[2] * third[i]
        for j in range(moving, count):
            own[at[j]] += by_first * first[j] + by_second * second[j] + by_third * third[j]
