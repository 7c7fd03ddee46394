"""The ledger's readings as those of a window: which have their places in it, and where, compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion.learned.receivers import LATE_NUMBER
from estimator.fusion.memory.ledger import BEARING, GYRO_BIAS, RANGE, RSSI
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.ends import FREE, UNIT
from estimator.smoothing.keyframes.ground import Ends, Ground, ends_of, selected_ends
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.losses import Losses
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.readings.encounters import candidates
from estimator.smoothing.readings.linearisation import Readings
from estimator.smoothing.readings.selection import choose
from estimator.smoothing.readings.stacked import StackedReadings, arrange

ALTIMETER, RECEIVER = BEARING, BEARING + 1
"""Where altimeters stand among technologies, and receivers."""


class LedgerRows(NamedTuple):
    """Readings as rows of the ledger: pairs m × 11, singles n × 7, drops d × 3."""

    pairs: Array
    singles: Array
    drops: Array


class WindowReadings(NamedTuple):
    """Those of them that have their places in a window.

    Attributes:
        told: the ledger's rows of them.
        rows: one below the other.
        readings: all that their residuals follow from.
        inside: which pairs are ranges or powers inside the building, m.
        strongest: which pairs are the strongest powers of their links for some time, m.
        turns: which rows are gyro biases that standing units tell.
        bearings: which pairs are bearings.
        unsure_m2: what units' own ways make unsure of the ends of pairs, a and b, of singles, and of who
            dropped, × 3 each (m²).
    """

    told: LedgerRows
    rows: StackedReadings
    readings: Readings
    inside: NDArray[np.bool_]
    strongest: NDArray[np.bool_]
    turns: NDArray[np.bool_]
    bearings: Integers
    unsure_m2: tuple[Array, Array, Array, Array]


@njit(cache=True)
def window_readings(
    ledger: LedgerRows,
    since_t: float,
    ground: Ground,
    technology: Integers,
    losses: Losses,
    outside: NDArray[np.bool_],
    headings: Integers,
) -> WindowReadings:
    """The readings of a window.

    Args:
        ledger: all that there are.
        since_t: from which epoch on they are looked at (s).
        ground: of the window.
        technology: see `selection.choose`.
        losses: see `selection.choose`.
        outside: see `selection.choose`.
        headings: see `Readings`.
    """
    pairs, singles, drops = (
        rows_since(ledger.pairs, since_t),
        rows_since(ledger.singles, since_t),
        ledger.drops,
    )
    drops = rows_since(drops, since_t)
    t, nobody = pairs[:, 0].copy(), np.zeros(max(len(singles), len(drops)), dtype=np.bool_)
    first, second, nearest = numbers(pairs, 2), numbers(pairs, 3), np.empty(len(pairs), dtype=np.bool_)
    kinds = ground.nodes.kind
    for i in range(len(pairs)):
        nearest[i] = kinds[first[i]] != UNIT and kinds[second[i]] != UNIT
    a, b = ends_of(ground, first, t, nearest), ends_of(ground, second, t, nearest)
    found = choose(pairs, a.stood, b.stood, technology, losses, STATES * len(ground.spans), outside)
    pairs, a, b = (
        selected_rows(pairs, found.chosen),
        selected_ends(a, found.chosen),
        selected_ends(b, found.chosen),
    )
    extra, inside = found.extra[found.chosen], found.inside[found.chosen]
    on = ends_of(ground, numbers(singles, 1), singles[:, 0].copy(), nobody[: len(singles)])
    usable = on.stood.usable & (on.stood.columns[:, 0] >= 0)
    singles, on = selected_rows(singles, usable), selected_ends(on, usable)
    by = ends_of(ground, numbers(drops, 2), drops[:, 0].copy(), nobody[: len(drops)])
    crumb = ends_of(ground, numbers(drops, 1), drops[:, 0].copy(), nobody[: len(drops)])
    usable = by.stood.usable & crumb.stood.usable
    drops, by, crumb = selected_rows(drops, usable), selected_ends(by, usable), selected_ends(crumb, usable)
    stood = a.stood, b.stood, on.stood, by.stood, crumb.stood
    off = np.full((len(singles), 2), -1, dtype=np.int64)
    for i in range(len(singles)):
        if singles[i, 6] >= 0.0:
            off[i, 0] = technology[ALTIMETER, int(singles[i, 6])]
            receiver = technology[RECEIVER, int(singles[i, 6])]
            if receiver >= 0:
                off[i, 0] = receiver + int(singles[i, 2])
            if receiver >= 0 and on.stood.kind[i] == FREE:
                off[i, 1] = receiver + LATE_NUMBER
    rows = arrange(pairs, singles, drops, found.slab[found.chosen], extra, off, *stood)
    readings = read(pairs, singles, extra, off, ground, (a, b, on, by, crumb), headings)
    turns = np.zeros(len(rows.t), dtype=np.bool_)
    for i in range(len(singles)):
        turns[len(pairs) + i] = readings.axis[i] == GYRO_BIAS
    unsure_m2 = a.unsure_m2, b.unsure_m2, on.unsure_m2, by.unsure_m2
    bearings = np.flatnonzero(readings.kind >= BEARING)
    told = LedgerRows(pairs, singles, drops)
    return WindowReadings(told, rows, readings, inside, peaks(pairs), turns, bearings, unsure_m2)


def technologies_of(layout: Layout) -> Integers:
    """First column of each technology of a window, kinds × sources; −1: there is none.

    After those of the kinds of pairs stand altimeters and receivers.
    """
    found = np.full((RECEIVER + 1, len(layout.state.sources)), -1, dtype=np.int64)
    of_kind = {"range": RANGE, "rssi": RSSI, "altimeter": ALTIMETER, "receiver": RECEIVER}
    for (kind, source), start in layout.technologies.items():
        found[of_kind[kind], source] = layout.width + start
    return found


@njit(cache=True)
def rows_since(rows: Array, since_t: float) -> Array:
    """Rows of the ledger from an epoch on (s)."""
    return selected_rows(rows, rows[:, 0] >= since_t)


@njit(cache=True)
def selected_rows(rows: Array, chosen: NDArray[np.bool_]) -> Array:
    """Some of m rows; the rows themselves where that is all of them."""
    return rows if chosen.all() else rows[chosen]


@njit(cache=True)
def numbers(rows: Array, column: int) -> Integers:
    """A column of whole numbers."""
    return rows[:, column].astype(np.int64)


@njit(cache=True)
def peaks(pairs: Array) -> NDArray[np.bool_]:
    """Which pairs are the strongest powers of their links for some time."""
    found, heard = np.zeros(len(pairs), dtype=np.bool_), np.flatnonzero(pairs[:, 1] == RSSI)
    if len(heard):
        t, link, value = pairs[heard, 0], pairs[heard, 9], pairs[heard, 4]
        found[heard] = candidates(t, link, value)
    return found


@njit(cache=True)
def read(
    pairs: Array,
    singles: Array,
    extra: Integers,
    off: Integers,
    ground: Ground,
    ends: tuple[Ends, Ends, Ends, Ends, Ends],
    headings: Integers,
) -> Readings:
    """All that the residuals of readings follow from, but for how fast who flies goes, and who faces what.

    Args:
        pairs: rows of the ledger, m × 11.
        singles: the same, n × 7.
        extra: columns of each pair's technology and loss, m × 4; −1: it has none.
        off: columns of what each single's altimeter or receiver is off by, and how late, n × 2; −1: none.
        ground: of the window.
        ends: of the pairs, a and b, of the singles, who dropped, and what was dropped.
        headings: see `Readings`.
    """
    a, b, on, by, crumb = ends
    border = len(ground.grid) * STATES * len(ground.spans) - STATES * len(ground.spans)
    at = np.zeros((len(pairs), 4), dtype=np.int64)
    for i in range(len(pairs)):
        for c in range(4):
            if extra[i, c] >= 0:
                at[i, c] = border + extra[i, c]
    where = np.where(off >= 0, border + off, -1)
    return Readings(
        numbers(pairs, 1),
        pairs[:, 4].copy(),
        pairs[:, 7].copy(),
        at,
        np.where(extra[:, 3] >= 0, np.where(pairs[:, 1] == RANGE, -1.0, 1.0), 0.0),
        np.zeros(len(pairs)),
        a.table,
        b.table,
        numbers(singles, 2),
        singles[:, 3].copy(),
        where,
        np.zeros(len(singles)),
        on.table,
        by.table,
        crumb.table,
        headings,
    )
