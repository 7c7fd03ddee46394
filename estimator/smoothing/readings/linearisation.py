"""The rows of a window linearised: loops over readings, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.learned.noise import near_dbm, through_sigma
from estimator.fusion.memory.ledger import BEARING, BODY_BEARING, RANGE
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.graph.scatter import ROW
from estimator.measurements.bearing import bearing_at
from estimator.measurements.range import range_at
from estimator.measurements.rssi import rssi_at
from estimator.smoothing.keyframes.ends import FIXED, UNIT, Table, faced, place_end


class Readings(NamedTuple):
    """The readings of a window as numbers: m pairs, n singles, d drops.

    Attributes:
        kind: of each pair, m.
        value: what was measured, m.
        constant: known part of a power (dB), or heading that a bearing counts from (rad), m.
        extra: where its technology's three numbers and what it loses are in the flat unknowns, m × 4; 0 if it
            has none.
        lost: 1 where a power loses something with others of its crew, −1 where a range is longer, m; else 0.
        ahead: how far ahead of its bearer the other radio lies, of ranges how far behind, m, see `bodies`.
        a: first ends of the pairs.
        b: second ends.
        axis: what a single tells of its node: 0 to 2 the place, above it the number itself, n.
        told: what it tells, n.
        off: where what its altimeter or receiver is off by, and how late, is in the flat unknowns, n × 2; −1:
            it has none.
        speed: how much less it tells for each second that it is late, n (m/s).
        on: ends of the singles.
        by: who dropped, d.
        crumb: what was dropped, d.
        headings: which of the flat unknowns are headings that ends count from.
    """

    kind: Integers
    value: Array
    constant: Array
    extra: Integers
    lost: Array
    ahead: Array
    a: Table
    b: Table
    axis: Integers
    told: Array
    off: Integers
    speed: Array
    on: Table
    by: Table
    crumb: Table
    headings: Integers


class PairPrediction(NamedTuple):
    """What one pair should measure, and its derivatives: by `b` it has those by `a`, the other way."""

    predicted: float
    by_e: float
    by_n: float
    by_u: float
    by_first: float
    by_second: float


@njit(cache=True)
def predict_pair(
    kind: int, value: float, constant: float, first: float, second: float, a: Array, b: Array
) -> PairPrediction:
    """One pair with its ends at a and b, 3 each (m).

    Args:
        kind: see `Readings`.
        value: see `Readings`.
        constant: see `Readings`; of a bearing, all that it counts from (rad).
        first: first state of its technology.
        second: second one.
        a: where it was measured.
        b: what was measured.
    """
    e, n, u = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    if kind >= BEARING:
        found = bearing_at(-e, -n, constant)
        return PairPrediction(found.predicted, found.by_e, found.by_n, 0.0, -1.0, 0.0)
    squared = e * e + n * n + u * u
    if kind == RANGE:
        along = range_at(squared, first, second)
    else:
        along = rssi_at(value, squared, first + constant, second)
    by_e, by_n, by_u = e * along.by_a, n * along.by_a, u * along.by_a
    return PairPrediction(along.predicted, by_e, by_n, by_u, along.by_first, along.by_second)


@njit(cache=True)
def counted_from(kind: int, constant: float, ends: Table, i: int, x: Array) -> float:
    """The constant of one pair: of a bearing in the body frame, with the heading of its unit (rad)."""
    return constant + x[ends.at[i, 3]] if kind == BODY_BEARING and ends.kind[i] == UNIT else constant


@njit(cache=True)
def chain_rule(slope: Array, turned: Array, row: Array) -> None:
    """Derivatives by an end's six numbers (`row`), from those by its place (3)."""
    for c in range(3):
        row[c] = slope[c]
        row[3 + c] = slope[0] * turned[0, c] + slope[1] * turned[1, c] + slope[2] * turned[2, c]


@njit(cache=True, nogil=True)
def residuals(readings: Readings, numbers: Array, first: int, last: int, found: Array) -> None:
    """Residuals z − h(x) of some rows at an estimate; bearings not yet wrapped.

    Args:
        readings: of the window.
        numbers: the estimate, see `ends.faced`.
        first: the first of the rows.
        last: the one after the last of them.
        found: takes them, rows.
    """
    m, n, x = len(readings.kind), len(readings.axis), numbers[:, 0]
    a, b, turned = np.empty(3), np.empty(3), np.zeros((3, 3))
    # What is taken out of a tuple in the loop is counted in the loop.
    ends_a, ends_b, kinds, extra = readings.a, readings.b, readings.kind, readings.extra
    value, constants, ahead = readings.value, readings.constant, readings.ahead
    lost = readings.lost
    for i in range(first, min(last, m)):
        place_end(ends_a, i, numbers, a, turned)
        place_end(ends_b, i, numbers, b, turned)
        constant = counted_from(kinds[i], constants[i], ends_a, i, x)
        seen = predict_pair(kinds[i], value[i], constant, x[extra[i, 0]], x[extra[i, 1]], a, b)
        found[i] = value[i] - seen.predicted - ahead[i] * x[extra[i, 2]] - lost[i] * x[extra[i, 3]]
    on, by, crumb = readings.on, readings.by, readings.crumb
    for i in range(max(first - m, 0), min(last - m, n)):
        axis = readings.axis[i]
        place_end(on, i, numbers, a, turned)
        here = a[axis] if axis < 3 else x[on.at[i, axis]]
        if readings.off[i, 0] >= 0:
            here += x[readings.off[i, 0]]
        if readings.off[i, 1] >= 0:
            here -= readings.speed[i] * x[readings.off[i, 1]]
        found[m + i] = readings.told[i] - here
    for k in range(max(first - m - n, 0), min(last - m - n, 3 * len(by.kind))):
        i, c = k // 3, k % 3
        place_end(by, i, numbers, a, turned)
        place_end(crumb, i, numbers, b, turned)
        found[m + n + k] = a[c] - b[c]


@njit(cache=True, nogil=True)
def jacobians(readings: Readings, numbers: Array, first: int, last: int, found: Array) -> None:
    """Derivatives of some rows by what each depends on.

    Args:
        readings: of the window.
        numbers: the estimate, see `ends.faced`.
        first: the first of the rows.
        last: the one after the last of them.
        found: takes them, rows × 16, or 15 where nothing is lost; zeros before. Numpy is given memory for it
            in large pages, a compiled loop would wait for thousands of small ones.
    """
    m, n, x = len(readings.kind), len(readings.axis), numbers[:, 0]
    a, b, by_a, by_b = np.empty(3), np.empty(3), np.zeros((3, 3)), np.zeros((3, 3))
    slope = np.empty(3)
    ends_a, ends_b, kinds, extra = readings.a, readings.b, readings.kind, readings.extra
    value, constants, ahead = readings.value, readings.constant, readings.ahead
    lost = readings.lost
    for i in range(first, min(last, m)):
        kind = kinds[i]
        by_a[:], by_b[:] = 0.0, 0.0
        place_end(ends_a, i, numbers, a, by_a)
        place_end(ends_b, i, numbers, b, by_b)
        constant = counted_from(kind, constants[i], ends_a, i, x)
        seen = predict_pair(kind, value[i], constant, x[extra[i, 0]], x[extra[i, 1]], a, b)
        if ends_a.kind[i] != FIXED:
            slope[0], slope[1], slope[2] = seen.by_e, seen.by_n, seen.by_u
            chain_rule(slope, by_a, found[i, :6])
        if ends_b.kind[i] != FIXED:
            slope[0], slope[1], slope[2] = -seen.by_e, -seen.by_n, -seen.by_u
            chain_rule(slope, by_b, found[i, 6:12])
        if kind < BEARING:
            found[i, 12], found[i, 13], found[i, 14] = seen.by_first, seen.by_second, ahead[i]
            if found.shape[1] > ROW:
                found[i, ROW] = lost[i]
        elif kind == BODY_BEARING and ends_a.kind[i] == UNIT:
            found[i, 3] += seen.by_first
    on, by, crumb = readings.on, readings.by, readings.crumb
    for i in range(max(first - m, 0), min(last - m, n)):
        row, axis = found[m + i], readings.axis[i]
        row[axis] = 1.0
        if readings.off[i, 0] >= 0:
            row[12] = 1.0
        if axis < 3:
            by_a[:] = 0.0
            place_end(on, i, numbers, a, by_a)
            row[3:6] = by_a[axis]
        if readings.off[i, 1] >= 0:
            row[13] = -readings.speed[i]
    for k in range(max(first - m - n, 0), min(last - m - n, 3 * len(by.kind))):
        row, i, c = found[m + n + k], k // 3, k % 3
        by_a[:], by_b[:] = 0.0, 0.0
        place_end(by, i, numbers, a, by_a)
        place_end(crumb, i, numbers, b, by_b)
        if by.kind[i] != FIXED:
            row[c], row[3:6] = -1.0, -by_a[c]
        if crumb.kind[i] != FIXED:
            row[6 + c], row[9:12] = 1.0, by_b[c]


@njit(cache=True)
def separations(readings: Readings, x: Array) -> Array:
    """Vector from the second end of each pair to the first at an estimate x, flat, m × 3 (m)."""
    m = len(readings.kind)
    found, a, b, turned = np.empty((m, 3)), np.empty(3), np.empty(3), np.zeros((3, 3))
    ends_a, ends_b = readings.a, readings.b
    numbers = faced(x, readings.headings)
    for i in range(m):
        place_end(ends_a, i, numbers, a, turned)
        place_end(ends_b, i, numbers, b, turned)
        for c in range(3):
            found[i, c] = a[c] - b[c]
    return found


@njit(cache=True)
def scale_sigmas(
    readings: Readings,
    x: Array,
    through: NDArray[np.bool_],
    held: bool,
    strongest: NDArray[np.bool_],
    alike: Array,
    alone: Array,
    sigma: Array,
) -> None:
    """Set the sigmas of readings through floors and of encounters, in place.

    Args:
        readings: of the window.
        x: the estimate, flat.
        through: which pairs may go through a floor, m.
        held: they are thought to; else those of them do whose ends are that far apart at the estimate.
        strongest: which are the strongest powers of their links for some time, m.
        alike: which number in its row of alike readings each one is, m at least.
        alone: standard deviation that each would have were there none alike, m at least.
        sigma: standard deviations of all rows, m at least, changed.
    """
    way, kinds, extra = separations(readings, x), readings.kind, readings.extra
    value, constants = readings.value, readings.constant
    for i in range(len(kinds)):
        e, n, u = way[i, 0], way[i, 1], way[i, 2]
        if through[i] and (held or abs(u) > physics.FLOOR_M):
            sigma[i] = through_sigma(sigma[i], kinds[i] != RANGE, alike[i])
        close = strongest[i] and np.sqrt(e * e + n * n + u * u) <= physics.ENCOUNTER_M
        if close and value[i] >= near_dbm(x[extra[i, 0]] + constants[i], x[extra[i, 1]]):
            sigma[i] *= min(physics.NEAR_SIGMA_DB / alone[i], 1.0)


@njit(cache=True)
def add_reckoning_noise(jacobian: Array, a: Array, b: Array, on: Array, by: Array, sigma: Array) -> None:
    """Add to the noise of all readings the dead reckoning noise of their ends since their keyframes.

    Args:
        jacobian: of the rows, m × c.
        a: variances of the first ends of the pairs, × 3 (m²); see `ends.Ends`.
        b: those of the second ends.
        on: those of the ends of the singles.
        by: those of who dropped.
        sigma: standard deviations, m, changed.
    """
    pairs, singles = len(a), len(on)
    for i in range(pairs + singles + 3 * len(by)):
        variance = sigma[i] ** 2
        for c in range(3):
            if i < pairs:
                variance += jacobian[i, c] ** 2 * a[i, c] + jacobian[i, 6 + c] ** 2 * b[i, c]
            elif i < pairs + singles:
                variance += jacobian[i, c] ** 2 * on[i - pairs, c]
            else:
                variance += jacobian[i, c] ** 2 * by[(i - pairs - singles) // 3, c]
        sigma[i] = np.sqrt(variance)
