"""Readings of one tick as a table of numbers: what each is held against, and its linearisation, compiled."""

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.learned.receivers import LATE_NUMBER
from estimator.fusion.memory.ledger import BEARING, RANGE
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import Mixture
from estimator.graph.variable import BODY, Variable
from estimator.measurements.bearing import bearing_at
from estimator.measurements.range import range_at
from estimator.measurements.rssi import rssi_at

ONE = -1
"""Kind of a reading of one number; the others have the kinds of pairs in the ledger."""
WIDTH = 9
"""Numbers that a reading depends on at most: two positions, and three states of a technology."""


class Single(NamedTuple):
    """A reading of one number of one block: an axis of a position, a bias.

    Attributes:
        variable: the block.
        axis: which of its numbers.
        value: what was read.
        sigma: its standard deviation.
        noise: its outliers.
        altimeter: what the altimeter that has read it is off by; None: none has.
        receiver: what the fix that tells it is off by; None: it is none of somebody who flies.
        speed_mps: of the node along that axis, by which a fix that is late is off (m/s).
    """

    variable: Variable
    axis: int
    value: float
    sigma: float
    noise: Mixture
    altimeter: Variable | None = None
    receiver: Variable | None = None
    speed_mps: float = 0.0


class Row(NamedTuple):
    """A reading of one number of one block (an axis of a position, a bias), or one between two nodes.

    Attributes:
        kind: `ONE`, `RANGE`, `RSSI` or `BEARING`.
        a: row of the number that is read; else where the block of the end that measured starts. −1: it is
            fixed, at `a_e`, `a_n`, `a_u`.
        value: what was read.
        sigma: its standard deviation.
        outliers: see `Mixture`.
        shift: see `Mixture`.
        spread: see `Mixture`.
        nominal: claimed or assumed standard deviation.
        b: as `a`, of the other end; of one number, row of how late it was told, −1: it was not.
        extra: where the technology's states start, or those of the unit that a bearing is counted from; row
            of what one number is off by. −1: none.
        constant: what is added to the first of them: reported heading (rad), sent power (dBm).
        source: number of the technology that its noise is learned for; −1: none.
        link: row of its link, see `links`; −1: none.
        a_e: where the end that measured stood at the reading's epoch, east of its block (m).
        a_n: the same, north.
        a_u: the same, up.
        b_e: where the other end stood; of one number, how much less it is for each second that it is late.
        b_n: the same, north.
        b_u: the same, up.
        ahead: how far ahead of its bearer the other radio lies, of a range how far behind, as a cosine.
    """

    kind: int
    a: int
    value: float
    sigma: float
    outliers: float
    shift: float
    spread: float
    nominal: float
    b: int = -1
    extra: int = -1
    constant: float = 0.0
    source: int = -1
    link: int = -1
    a_e: float = 0.0
    a_n: float = 0.0
    a_u: float = 0.0
    b_e: float = 0.0
    b_n: float = 0.0
    b_u: float = 0.0
    ahead: float = 0.0


FIELDS = len(Row._fields)
KIND, A, VALUE, SIGMA, OUTLIERS, SHIFT, SPREAD, NOMINAL, B, EXTRA, CONSTANT, SOURCE, LINK, A_E = range(14)
B_E = A_E + 3
AHEAD = B_E + 3


def table_of(starts: Mapping[Variable, int], singles: Sequence[Single], pairs: Array) -> Array:
    """Readings as a table, m × `FIELDS`, those of one kind one after the other.

    Args:
        starts: first row of each block; the table is valid until one is deleted.
        singles: readings of one number.
        pairs: rows of readings between two nodes, those of one kind one after the other.
    """
    if not singles:
        return pairs
    rows = [
        Row(
            ONE,
            starts[s.variable] + s.axis,
            s.value,
            s.sigma,
            *s.noise,
            s.sigma,
            b=-1 if s.receiver is None else starts[s.receiver] + LATE_NUMBER,
            extra=_off_by(starts, s),
            b_e=s.speed_mps,
        )
        for s in singles
    ]
    return np.concatenate([table_from(rows, FIELDS), pairs])


def _off_by(starts: Mapping[Variable, int], single: Single) -> int:
    if single.receiver is not None:
        return starts[single.receiver] + single.axis
    return -1 if single.altimeter is None else starts[single.altimeter]


def table_from(rows: Sequence[Sequence[float]], width: int) -> Array:
    """Rows of so many numbers, as a table."""
    return np.fromiter(chain.from_iterable(rows), np.float64, len(rows) * width).reshape(-1, width)


@njit(cache=True, error_model="numpy")
def columns_of(table: Array) -> Indices:
    """Which numbers each reading depends on, m × 9: of a, b and extra; −1 where there is none."""
    m = len(table)
    columns = np.full((m, WIDTH), -1)
    for r in range(m):
        if table[r, KIND] == ONE:
            columns[r, 0], columns[r, 6] = int(table[r, A]), int(table[r, EXTRA])
            columns[r, 7] = int(table[r, B])
            continue
        for at, field, length in ((0, A, 3), (3, B, 3), (6, EXTRA, 2)):
            start = int(table[r, field])
            if start >= 0:
                for i in range(length):
                    columns[r, at + i] = start + i
        if table[r, AHEAD] != 0.0:
            columns[r, 8] = int(table[r, EXTRA]) + BODY
    return columns


@njit(cache=True, error_model="numpy")
def linearise(table: Array, columns: Indices, x: Array, jacobian: Array, residual: Array) -> None:
    """Residuals and derivatives at an estimate.

    Args:
        table: of m readings.
        columns: which numbers each depends on, m × 9.
        x: the estimate, n.
        jacobian: takes the derivatives, m × 9; 0 where there is no number.
        residual: takes z − h(x), m.
    """
    for r in range(len(table)):
        kind, value = table[r, KIND], table[r, VALUE]
        first, second, ahead = table[r, CONSTANT], 0.0, 0.0
        if columns[r, 6] >= 0:
            first += x[columns[r, 6]]
        if columns[r, 7] >= 0:
            second = x[columns[r, 7]]
        if columns[r, 8] >= 0:
            ahead = table[r, AHEAD] * x[columns[r, 8]]
        for i in range(WIDTH):
            jacobian[r, i] = 0.0
        if kind == ONE:
            jacobian[r, 0] = 1.0
            if columns[r, 6] >= 0:
                jacobian[r, 6] = 1.0
            if columns[r, 7] >= 0:
                jacobian[r, 7] = -table[r, B_E]
            residual[r] = value - (table[r, A_E] + x[columns[r, 0]]) - first + table[r, B_E] * second
            continue
        e, n, u = (
            apart(table, columns, x, r, 0),
            apart(table, columns, x, r, 1),
            apart(table, columns, x, r, 2),
        )
        if kind == BEARING:
            seen = bearing_at(-e, -n, first)
            by_e, by_n, by_u, by_first, by_second = seen.by_e, seen.by_n, 0.0, -1.0, 0.0
            off = value - seen.predicted - ahead
            residual[r] = np.remainder(off + np.pi, 2.0 * np.pi) - np.pi
        else:
            squared = e * e + n * n + u * u
            got = (
                range_at(squared, first, second) if kind == RANGE else rssi_at(value, squared, first, second)
            )
            by_e, by_n, by_u = e * got.by_a, n * got.by_a, u * got.by_a
            by_first, by_second = got.by_first, got.by_second
            residual[r] = value - got.predicted - ahead
        if columns[r, 0] >= 0:
            jacobian[r, 0], jacobian[r, 1], jacobian[r, 2] = by_e, by_n, by_u
        if columns[r, 3] >= 0:
            jacobian[r, 3], jacobian[r, 4], jacobian[r, 5] = -by_e, -by_n, -by_u
        if columns[r, 6] >= 0:
            jacobian[r, 6] = by_first
        if columns[r, 7] >= 0:
            jacobian[r, 7] = by_second
        if columns[r, 8] >= 0:
            jacobian[r, 8] = table[r, AHEAD]


@njit(cache=True, error_model="numpy", forceinline=True)
def apart(table: Array, columns: Indices, x: Array, r: int, axis: int) -> float:
    """How far the end of a reading that measured is from the other one along an axis (m).

    Args:
        table: of m readings.
        columns: which numbers each depends on, m × 9.
        x: the estimate, n.
        r: which reading.
        axis: 0 to 2.
    """
    here, there = table[r, A_E + axis], table[r, B_E + axis]
    if columns[r, axis] >= 0:
        here += x[columns[r, axis]]
    if columns[r, 3 + axis] >= 0:
        there += x[columns[r, 3 + axis]]
    return float(here - there)
