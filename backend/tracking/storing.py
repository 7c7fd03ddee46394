"""Rows and states on their way into the database: batched, fenced, and kept where it cannot be written."""

import asyncio
import time

import structlog

from backend.log.base import DerivedWriter, LogUnwritable, RecordedFrame, Snapshot
from backend.tracking.heads import MadeWith

SAVE_EVERY_S = 1.0
SAVE_SOON_S = 0.2
SNAPSHOT_EVERY_S = 30.0
SNAPSHOT_EVERY_BATCHES = 2_000
LONGEST_PAUSE_S = 10.0
MAX_WAITING_BYTES = 64 * 1024 * 1024
"""Rows that may wait for a database that cannot be written; beyond, folding waits: the log holds the rest."""

log = structlog.get_logger(__name__)


class Keeper:
    """Stores one incident's rows and states.

    Args:
        writer: where to.
        incident: whose.
        epoch: of the lease under which it is written.
        settled: seconds before this one are recorded already and stay as they were shown.
        at: newest log entry and newest stretch of the stored state.

    Attributes:
        snapshot_at: the same, of the state that is stored by now.
    """

    def __init__(
        self, writer: DerivedWriter, incident: str, epoch: int, settled: int | None, at: tuple[int, int]
    ) -> None:
        self._writer = writer
        self._incident = incident
        self._epoch = epoch
        self._settled = settled
        self._waiting: dict[int, RecordedFrame] = {}
        self._bytes = 0
        self._saved_at = self._snapshot_at = time.monotonic()
        self._pause_s = 0.0
        self.snapshot_at = at

    def take(self, row: RecordedFrame, *, put_back: bool = False) -> None:
        """Have a row stored; it replaces one of the same second.

        Args:
            row: it is.
            put_back: the server's clock was put back before it: rows of later seconds may be older.
        """
        if not put_back and self._settled is not None and row.second < self._settled:
            return
        self._waiting[row.second] = row
        self._bytes += len(row.record)

    @property
    def full(self) -> bool:
        """Too much waits: folding has to wait too."""
        return self._bytes > MAX_WAITING_BYTES

    @property
    def empty(self) -> bool:
        """Nothing waits."""
        return not self._waiting

    def rests_s(self, *, soon: bool = False) -> float:
        """For how long it rests after the last save, or the last attempt (s).

        Args:
            soon: nothing more is to be folded, so nothing is gained by collecting more rows.
        """
        every_s = SAVE_SOON_S if soon else SAVE_EVERY_S
        return max(0.0, self._saved_at + max(every_s, self._pause_s) - time.monotonic())

    def wants_snapshot(self, at: tuple[int, int], *, idle: bool) -> bool:
        """Whether a new state is worth its while: much was folded since the last one, or there is time."""
        if at == self.snapshot_at:
            return False
        return (
            idle
            or at[1] != self.snapshot_at[1]
            or at[0] - self.snapshot_at[0] >= SNAPSHOT_EVERY_BATCHES
            or time.monotonic() - self._snapshot_at >= SNAPSHOT_EVERY_S
        )

    async def save(self, snapshot: Snapshot | None) -> bool:
        """Store all rows that wait, and a state taken after them, in one transaction.

        Returns:
            False where the database cannot be written; the rows wait for the next time.

        Raises:
            StaleEpoch: another worker holds the incident now.
        """
        rows = dict(self._waiting)
        try:
            await asyncio.to_thread(
                self._writer.save, self._incident, self._epoch, list(rows.values()), snapshot
            )
        except LogUnwritable as error:
            self._pause_s = min(max(SAVE_EVERY_S, 2 * self._pause_s), LONGEST_PAUSE_S)
            log.warning(
                "pictures cannot be stored, they are kept",
                incident=self._incident,
                rows=len(rows),
                error=str(error),
            )
            return False
        finally:
            self._saved_at = time.monotonic()
        for second, row in rows.items():
            if self._waiting.get(second) is row:  # else a newer one has come meanwhile
                del self._waiting[second]
        self._bytes = sum(len(row.record) for row in list(self._waiting.values()))
        self._pause_s = 0.0
        if snapshot is not None:
            made_with = snapshot.made_with
            stretch = 0 if made_with is None else MadeWith.stored(made_with).stretch
            self.snapshot_at = snapshot.seq, stretch
            self._snapshot_at = time.monotonic()
        return True
