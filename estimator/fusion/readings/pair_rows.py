"""Readings between two nodes as rows of numbers, for the ledger and for the graph; compiled."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.learned import link_correlation
from estimator.fusion.learned.noise import link_sigma, through_sigma
from estimator.fusion.memory.ledger import BEARING, BODY_BEARING, COLUMNS, RANGE, RSSI
from estimator.fusion.motion import recent_places
from estimator.fusion.readings import echoes
from estimator.fusion.rows import rows
from estimator.graph.dense import Array
from estimator.measurements.body import ahead_of

T, VALUE, SIGMA, CONSTANT, TECHNOLOGY, LINK, A, B = range(8)
"""Columns of a reading between two nodes: its epoch; what was read; its claimed or assumed sigma; sent power
(dBm) or reported heading (rad); rows of its technology, of its link (−1: none), of the end that measured and
of the other one."""
PAIR = 8
WIDTH = len(COLUMNS["pairs"])


class Technology(NamedTuple):
    """What is known of a technology in this tick, as a row of numbers.

    Attributes:
        kind: of its readings in the ledger.
        source: its number in the ledger.
        start: first row of its states; −1: it has none.
        factor: learned standard deviation over the claimed or assumed one.
        shared: share of the variance that successive readings on one link have in common.
        outliers: see `Mixture`.
        shift: see `Mixture`.
        spread: see `Mixture`.
    """

    kind: int
    source: int
    start: int
    factor: float
    shared: float
    outliers: float
    shift: float
    spread: float


KIND, SOURCE, START, FACTOR, SHARED, OUTLIERS, SHIFT, SPREAD = range(8)


class PairRows(NamedTuple):
    """What readings between two nodes have become.

    Attributes:
        entered: rows of the ledger, m × its columns.
        table: those between decided nodes as `rows.Row` has them, those of one kind one after the other.
        epochs: of these (s).
    """

    entered: Array
    table: Array
    epochs: Array


@njit(cache=True, error_model="numpy")
def pair_rows(
    pairs: Array, technologies: Array, ends: Array, marks: Array, newest: Array, x: Array
) -> PairRows:
    """Put the readings of a tick into rows, and follow their links.

    Args:
        pairs: the readings m × `PAIR`, in order of epoch.
        technologies: theirs, see `Technology`.
        ends: their nodes, see `recent_places.TrailEnd`.
        marks: of the nodes' trails, k × 4.
        newest: the newest reading on each link, see `links`; changed.
        x: the reference of the graph, n.
    """
    m = len(pairs)
    entered, table, held = np.empty((m, WIDTH)), np.empty((m, rows.FIELDS)), np.empty(m, dtype=np.bool_)
    first, epochs = np.zeros(BEARING + 2, dtype=np.intp), np.empty(m)
    for r in range(m):
        a, b = ends[int(pairs[r, A])], ends[int(pairs[r, B])]
        held[r] = a[recent_places.DECIDED] != 0.0 and b[recent_places.DECIDED] != 0.0
        if held[r]:
            first[1 + kind_of(technologies[int(pairs[r, TECHNOLOGY])])] += 1
    first = first.cumsum()
    for r in range(m):
        pair, technology = pairs[r], technologies[int(pairs[r, TECHNOLOGY])]
        a, b, link = ends[int(pair[A])], ends[int(pair[B])], int(pair[LINK])
        alike, echo_m = 1.0, 0.0
        if link >= 0:
            waited_s = pair[T] - newest[link, link_correlation.T]
            link_correlation.follow(newest[link], pair[T], way_m(a, pair[T]) + way_m(b, pair[T]))
            alike = newest[link, link_correlation.ALIKE]
            newest[link, link_correlation.DRIFTS] = drifts(a) or drifts(b)
            if technology[KIND] == RANGE:
                most_m = echoes.farthest_m(a, b, waited_s, technology[FACTOR] * pair[SIGMA])
                echo_m = echoes.hear(newest[link], waited_s, pair[VALUE], most_m)
        told = entered[r]
        told[0], told[1], told[2], told[3] = (
            pair[T],
            technology[KIND],
            a[recent_places.BLOCK],
            b[recent_places.BLOCK],
        )
        told[4], told[5], told[6] = pair[VALUE], pair[SIGMA], technology[SOURCE]
        told[7], told[8], told[9], told[10] = pair[CONSTANT], alike, pair[LINK], echo_m
        if held[r]:
            kind = kind_of(technology)
            epochs[first[kind]] = pair[T]
            fill(table[first[kind]], pair, technology, a, b, alike, newest, marks, x)
            if echo_m > 0.0:
                row = table[first[kind]]
                row[rows.OUTLIERS], row[rows.SHIFT], row[rows.SPREAD] = echoes.noise(echo_m, alike)
            first[kind] += 1
    return PairRows(entered, table[: first[BEARING]], epochs[: first[BEARING]])


@njit(cache=True, error_model="numpy")
def kind_of(technology: Array) -> int:
    """Kind of a technology's rows: to the graph both kinds of bearings are one."""
    return min(int(technology[KIND]), BEARING)


@njit(cache=True, error_model="numpy")
def fill(
    row: Array,
    pair: Array,
    technology: Array,
    a: Array,
    b: Array,
    alike: float,
    newest: Array,
    marks: Array,
    x: Array,
) -> None:
    """Fill the row of a reading between two decided nodes, see `rows.Row`."""
    sigma, source, link, extra = pair[SIGMA], technology[SOURCE], pair[LINK], technology[START]
    walls_m = scatter_m2 = doubt_m2 = 0.0
    at_a, at_b = recent_places.offset(a, marks, x, pair[T]), recent_places.offset(b, marks, x, pair[T])
    if kind_of(technology) == BEARING:
        source = link = -1.0
        if technology[KIND] == BODY_BEARING:
            extra = a[recent_places.STATES]
    else:
        known = technology[FACTOR], technology[SHARED], pair[SIGMA]
        through = abs(up_m(a, x) + at_a[2] - up_m(b, x) - at_b[2]) > physics.FLOOR_M
        through = through and a[recent_places.OUTSIDE] == 0.0 and b[recent_places.OUTSIDE] == 0.0
        if link >= 0 and not through:
            on = newest[int(link)]
            walls_m, scatter_m2 = on[link_correlation.WALLS_M], on[link_correlation.SCATTER_M2]
            doubt_m2 = on[link_correlation.DOUBT_M2]
        if technology[KIND] == RSSI and link >= 0 and (drifts(a) or drifts(b)) and not through:
            sigma = link_correlation.power_sigma(newest[int(link)], *known)
        else:
            sigma = link_sigma(*known, alike, scatter_m2, doubt_m2)
        if through:
            # It tells nothing of what its technology is like where no floor is between.
            sigma = through_sigma(sigma, technology[KIND] == RSSI, alike)
            source = link = -1.0
        unsure_m = math.hypot(
            recent_places.turned_m(at_a) if a[recent_places.TURNED] != 0.0 else 0.0,
            recent_places.turned_m(at_b) if b[recent_places.TURNED] != 0.0 else 0.0,
        )
        if unsure_m > 0.0 and technology[KIND] != RSSI:
            sigma = math.hypot(sigma, unsure_m)
            source = link = -1.0
    kind, ahead = kind_of(technology), 0.0
    if technology[START] >= 0 and kind != BEARING:
        ahead = ahead_between(kind, a, b, at_a, at_b, x)
    row[rows.KIND], row[rows.VALUE], row[rows.CONSTANT] = kind, pair[VALUE] - walls_m, pair[CONSTANT]
    row[rows.AHEAD] = ahead
    row[rows.A], row[rows.B], row[rows.EXTRA] = a[recent_places.START], b[recent_places.START], extra
    row[rows.SIGMA], row[rows.NOMINAL] = sigma, pair[SIGMA]
    row[rows.OUTLIERS], row[rows.SHIFT] = technology[OUTLIERS], technology[SHIFT]
    row[rows.SPREAD], row[rows.SOURCE], row[rows.LINK] = technology[SPREAD], source, link
    for axis in range(3):
        row[rows.A_E + axis], row[rows.B_E + axis] = at_a[axis], at_b[axis]


@njit(cache=True, error_model="numpy")
def ahead_between(kind: int, a: Array, b: Array, at_a: Vector3, at_b: Vector3, x: Array) -> float:
    """How far ahead of its bearer the other radio lies, of a range how far behind, as a cosine.

    Args:
        kind: of the reading.
        a: the end that measured, see `TrailEnd`.
        b: the other one.
        at_a: where the first stood at the reading's epoch from its block, or, fixed, where it stands (m).
        at_b: the same of the other one.
        x: the reference of the graph, n.
    """
    way_e, way_n = at_b[0] - at_a[0], at_b[1] - at_a[1]
    start_a, start_b = int(a[recent_places.START]), int(b[recent_places.START])
    if start_a >= 0:
        way_e, way_n = way_e - x[start_a], way_n - x[start_a + 1]
    if start_b >= 0:
        way_e, way_n = way_e + x[start_b], way_n + x[start_b + 1]
    one, other = recent_places.faced(a, x), recent_places.faced(b, x)
    cosine = ahead_of(one[0] - other[0], one[1] - other[1], way_e, way_n)
    return -cosine if kind == RANGE else cosine


@njit(cache=True, error_model="numpy")
def up_m(end: Array, x: Array) -> float:
    """Height of a node's block; 0 where it is fixed (m)."""
    start = int(end[recent_places.START])
    return x[start + 2] if start >= 0 else 0.0


@njit(cache=True, error_model="numpy")
def way_m(end: Array, t: float) -> float:
    """How far a node has walked by `t`, for what its readings have in common (m).

    Without PDR the way is what the readings themselves tell: were they trusted less where it stands still, it
    would seem to stand still ever after. So it is thought to walk slowly all the time.
    """
    return physics.FREE_WAY_MPS * t if drifts(end) else end[recent_places.WAY_M]


@njit(cache=True, error_model="numpy")
def drifts(end: Array) -> bool:
    """Whether a node moves, and no unit tells how."""
    return bool(end[recent_places.MOVES] == recent_places.DRIFTS)
