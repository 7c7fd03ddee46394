"""The rows of a window linearised: loops over readings, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.ledger import BEARING, BODY_BEARING, RANGE, RSSI
from estimator.graph.dense import Array
from estimator.graph.kernels import Integers
from estimator.measurements.bearing import predict_bearing
from estimator.measurements.range import PairJacobian, predict_range, range_slope
from estimator.measurements.rssi import ANTENNA_M, predict_rssi, rssi_slope
from estimator.smoothing.ends import FIXED, UNIT, Table, place_end, place_ends

ANY = 14
"""Numbers that one row depends on at most: two ends of six, two of a technology."""
NOWHERE_M2 = 1e-6


class Readings(NamedTuple):
    """The readings of a window as numbers: m pairs, n singles, d drops.

    Attributes:
        kind: of each pair, m.
        value: what was measured, m.
        constant: known part of a power (dB), or heading that a bearing counts from (rad), m.
        extra: where its technology's two numbers are in the flat unknowns, m × 2; 0 if it has none.
        a: first ends of the pairs.
        b: second ends.
        axis: what a single tells of its node: 0 to 2 the place, above it the number itself, n.
        told: what it tells, n.
        on: ends of the singles.
        by: who dropped, d.
        crumb: what was dropped, d.
    """

    kind: Integers
    value: Array
    constant: Array
    extra: Integers
    a: Table
    b: Table
    axis: Integers
    told: Array
    on: Table
    by: Table
    crumb: Table


class Bends(NamedTuple):
    """What bent readings add to the curvature, as rows of their own without a residual.

    Attributes:
        pair: which pair each is of.
        jacobian: derivatives, count × 14.
        information: count.
    """

    pair: Integers
    jacobian: Array
    information: Array


@njit(cache=True)
def predict_pairs(readings: Readings, a: Array, b: Array, x: Array) -> PairJacobian:
    """What each pair should measure, with both ends at a and b, m × 3 each (m)."""
    m = len(readings.kind)
    predicted, by_a, by_b = np.empty(m), np.empty((m, 3)), np.empty((m, 3))
    by_extra = np.empty((m, 2))
    for kind in (RANGE, RSSI, BEARING, BODY_BEARING):
        mine = np.flatnonzero(readings.kind == kind)
        if len(mine) == 0:
            continue
        first, second = x[readings.extra[mine, 0]], x[readings.extra[mine, 1]]
        if kind == RANGE:
            found = predict_range(a[mine], b[mine], first, second)
        elif kind == RSSI:
            found = predict_rssi(a[mine], b[mine], first + readings.constant[mine], second)
        else:
            heading = np.zeros(len(mine))
            if kind == BODY_BEARING:
                for i in range(len(mine)):
                    heading[i] = readings.constant[mine[i]]
                    if readings.a.kind[mine[i]] == UNIT:
                        heading[i] += x[readings.a.at[mine[i], 3]]
            found = predict_bearing(a[mine], b[mine], heading)
        for i in range(len(mine)):
            row = mine[i]
            predicted[row] = found.predicted[i]
            by_a[row], by_b[row], by_extra[row] = found.by_a[i], found.by_b[i], found.by_extra[i]
    return PairJacobian(predicted, by_a, by_b, by_extra)


@njit(cache=True)
def pull(slope: Array, turned: Array, row: Array) -> None:
    """Derivatives by an end's six numbers (`row`), from those by its place (3)."""
    for c in range(3):
        row[c] = slope[c]
        row[3 + c] = slope[0] * turned[0, c] + slope[1] * turned[1, c] + slope[2] * turned[2, c]


@njit(cache=True)
def residuals(readings: Readings, x: Array) -> Array:
    """Residuals z − h(x) of all rows at an estimate x, flat; bearings not yet wrapped."""
    m, n, d = len(readings.kind), len(readings.axis), len(readings.by.kind)
    found = np.empty(m + n + 3 * d)
    a, b = place_ends(readings.a, x), place_ends(readings.b, x)
    found[:m] = readings.value - predict_pairs(readings, a.place, b.place, x).predicted
    on = place_ends(readings.on, x)
    for i in range(n):
        axis = readings.axis[i]
        here = on.place[i, axis] if axis < 3 else x[readings.on.at[i, axis]]
        found[m + i] = readings.told[i] - here
    by, crumb = place_ends(readings.by, x), place_ends(readings.crumb, x)
    for i in range(d):
        for c in range(3):
            found[m + n + 3 * i + c] = by.place[i, c] - crumb.place[i, c]
    return found


@njit(cache=True)
def jacobians(readings: Readings, x: Array) -> Array:
    """Derivatives of all rows by what each depends on, at an estimate x, flat: 14 of each."""
    m, n, d = len(readings.kind), len(readings.axis), len(readings.by.kind)
    found = np.zeros((m + n + 3 * d, ANY))
    a, b = place_ends(readings.a, x), place_ends(readings.b, x)
    slopes = predict_pairs(readings, a.place, b.place, x)
    for i in range(m):
        row, kind = found[i], readings.kind[i]
        if readings.a.kind[i] != FIXED:
            pull(slopes.by_a[i], a.turned[i], row[:6])
        if readings.b.kind[i] != FIXED:
            pull(slopes.by_b[i], b.turned[i], row[6:12])
        if kind < BEARING:
            row[12], row[13] = slopes.by_extra[i, 0], slopes.by_extra[i, 1]
        elif kind == BODY_BEARING and readings.a.kind[i] == UNIT:
            row[3] += slopes.by_extra[i, 0]
    on = place_ends(readings.on, x)
    for i in range(n):
        row, axis = found[m + i], readings.axis[i]
        row[axis] = 1.0
        if axis < 3:
            row[3:6] = on.turned[i, axis]
    by, crumb = place_ends(readings.by, x), place_ends(readings.crumb, x)
    for i in range(d):
        for c in range(3):
            row = found[m + n + 3 * i + c]
            if readings.by.kind[i] != FIXED:
                row[c], row[3:6] = -1.0, -by.turned[i, c]
            if readings.crumb.kind[i] != FIXED:
                row[6 + c], row[9:12] = 1.0, crumb.turned[i, c]
    return found


@njit(cache=True)
def bends(
    readings: Readings, chosen: Integers, x: Array, information: Array, residual: Array, signed: bool
) -> Bends:
    """The curvature of distances, which Gauss-Newton leaves out: −P⁻¹ r ∂²h/∂x².

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
    """
    m, count = len(chosen), 0
    pair, known, jacobian = np.empty(3 * m, dtype=np.int64), np.empty(3 * m), np.zeros((3 * m, ANY))
    a, b, by_a, by_b = np.empty(3), np.empty(3), np.zeros((3, 3)), np.zeros((3, 3))
    axis, along = np.empty((3, 3)), np.empty(3)
    for i in chosen:
        if readings.kind[i] > RSSI:
            continue
        by_a[:], by_b[:] = 0.0, 0.0
        place_end(readings.a, i, x, a, by_a)
        place_end(readings.b, i, x, b, by_b)
        e, n, u = a[0] - b[0], a[1] - b[1], a[2] - b[2]
        level, squared = e * e + n * n, e * e + n * n + u * u
        if level < NOWHERE_M2:
            continue
        state = x[readings.extra[i, 0 if readings.kind[i] == RANGE else 1]]
        slope = range_slope(squared, state) if readings.kind[i] == RANGE else rssi_slope(squared, state)
        across = -information[i] * residual[i] * slope
        distance, flat = np.sqrt(squared), np.sqrt(level)
        axis[0] = (-n / flat, e / flat, 0.0)
        axis[1] = (-e * u / (flat * distance), -n * u / (flat * distance), flat / distance)
        axis[2] = (e / distance, n / distance, u / distance)
        along[0], along[1] = across if signed else max(across, 0.0), max(across, 0.0)
        along[2] = 0.0
        if readings.kind[i] == RSSI:
            along[2] = across * (1.0 - 2.0 * squared / (squared + ANTENNA_M * ANTENNA_M))
            along[2] = along[2] if signed else max(along[2], 0.0)
        for way in range(3):
            if along[way] == 0.0:
                continue
            pair[count], known[count] = i, along[way]
            if readings.a.kind[i] != FIXED:
                pull(axis[way], by_a, jacobian[count, :6])
            if readings.b.kind[i] != FIXED:
                pull(-axis[way], by_b, jacobian[count, 6:12])
            count += 1
    return Bends(pair[:count], jacobian[:count], known[:count])
