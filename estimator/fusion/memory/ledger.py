"""What has been fused, as tables of numbers: what a window or a whole incident is solved again from."""

from collections.abc import Sequence
from itertools import chain
from typing import Literal, Self

import numpy as np

from estimator.graph.dense import Array

Table = Literal["pairs", "singles", "steps", "drops", "begins", "stands", "poses"]

COLUMNS: dict[Table, tuple[str, ...]] = {
    "pairs": ("t", "kind", "a", "b", "value", "sigma", "source", "constant", "alike", "link", "echo"),
    "singles": ("t", "node", "axis", "value", "sigma", "noise", "source"),
    "steps": ("t", "node", "start_t", "e", "n", "u", "across2", "up2", "turn2", "bias2", "scale2", "given"),
    "drops": ("t", "node", "by"),
    "begins": ("t", "node", "unit", "role", "e", "n", "u", "se", "sn", "su", "turn", "turn_sigma"),
    "stands": ("t", "node", "e", "n", "u", "se", "sn", "su"),
    "poses": ("t", "node", "unit", "e", "n", "u", "a", "b", "c"),
}
"""pairs: readings between two nodes, `echo` what a range is too long by, as `echoes` tells (m); singles:
fixes, heights and gyro biases, `axis` 0 to 5 of the six numbers of a moving node; steps: displacements with
the variances that they add; drops: who laid what; begins and stands: how moving and standing nodes entered,
with their priors; poses: where moving nodes were thought to be. Nodes are told by the number of their
block."""

ASSUMED, CLAIMED, UNSEEN = 0.0, 1.0, 2.0
"""Whose a step's noise is, its `given`: assumed of units, and learned; claimed by its unit, or found; that of
a bearer who goes on while his unit tells nothing."""
ACROSS2, SCALE2, GIVEN = (COLUMNS["steps"].index(name) for name in ("across2", "scale2", "given"))

RANGE, RSSI, BEARING, BODY_BEARING = range(4)
"""Kinds of pairs; the last two are bearings in the local frame and in the body frame of `a`."""
UNTOLD_POWER = "rssi "
"""Technology of signals whose radios do not tell what they send with; names of the others begin with it."""
ECHO = COLUMNS["pairs"].index("echo")
GYRO_BIAS = 4
"""Axis of a single that tells a gyro bias."""

MERGED = 64
"""Chunks of a table, the newest of which are joined to one when there are more."""


class Ledger:
    """Append-only tables in chunks that are never changed, so that copies share them.

    Args:
        complete: nothing is ever forgotten: the whole incident is to be solved from it.

    Attributes:
        chunks: the tables' closed chunks, each m × its columns.
    """

    def __init__(self, complete: bool = False) -> None:
        self.complete = complete
        self.chunks: dict[Table, tuple[Array, ...]] = dict.fromkeys(COLUMNS, ())
        self._open: dict[Table, list[tuple[float, ...]]] = {}

    def copy(self) -> Self:
        """An independent copy."""
        twin = object.__new__(type(self))
        twin.complete, twin.chunks = self.complete, dict(self.chunks)
        # Rows stay open until somebody asks for them: an array for each tick's few would cost more than they.
        twin._open = {name: list(rows) for name, rows in self._open.items()}
        return twin

    def add(self, table: Table, *row: float) -> None:
        """Append one row."""
        rows = self._open.get(table)
        if rows is None:
            rows = self._open[table] = []
        rows.append(row)

    def extend(self, table: Table, rows: Array) -> None:
        """Append rows, m × the table's columns, which nobody changes afterwards."""
        self._close(table)
        self._append(table, rows)

    def _close(self, name: Table) -> None:
        rows = self._open.pop(name, None)
        if rows is not None:
            width = len(COLUMNS[name])
            told = np.fromiter(chain.from_iterable(rows), np.float64, len(rows) * width)
            self._append(name, told.reshape(-1, width))

    def _append(self, name: Table, rows: Array) -> None:
        chunks = (*self.chunks[name], rows)
        if len(chunks) > MERGED:
            # Older ones are joined only where they are no longer than the rest: copying all each time would
            # take ever longer.
            first = MERGED // 2
            size = sum(len(chunk) for chunk in chunks[first:])
            while first > 0 and len(chunks[first - 1]) <= size:
                first -= 1
                size += len(chunks[first])
            chunks = (*chunks[:first], np.concatenate(chunks[first:]))
        self.chunks[name] = chunks

    def table(self, name: Table) -> Array:
        """All rows of a table, m × columns, in the order in which they were added."""
        self._close(name)
        chunks = self.chunks[name]
        if not chunks:
            return np.zeros((0, len(COLUMNS[name])))
        if len(chunks) > 1:
            self.chunks[name] = chunks = (np.concatenate(chunks),)
        return chunks[0]

    def replace(self, name: Table, rows: Array) -> None:
        """Put other rows in the place of a whole table."""
        self._open.pop(name, None)
        self.chunks[name] = (rows,) if len(rows) else ()

    def forget(self, before_t: float, tables: Sequence[Table]) -> None:
        """Leave out rows of epochs before `before_t`."""
        for name in () if self.complete else tables:
            rows = self.table(name)
            self.replace(name, rows[rows[:, 0] >= before_t])


def own_rows(table: Array, number: int) -> Array:
    """A node's rows of a table of the ledger, in order of epoch; the table itself where that is all of them.

    Args:
        table: m × c: epochs first (s), then the node's number.
        number: of the node.
    """
    own = table[:, 1] == number
    rows = table if own.all() else table[own]
    t = rows[:, 0]
    return rows if (t[:-1] <= t[1:]).all() else rows[np.argsort(t, kind="stable")]
