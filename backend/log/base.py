"""The event log's interface: what is appended, what is read, and what the worker keeps beside it."""

from collections.abc import Iterator, Sequence
from typing import Protocol

import msgspec

from backend.errors import FieldError, Unavailable


class NewBatch(msgspec.Struct, frozen=True, kw_only=True):
    """A batch on its way into the log.

    Attributes:
        incident: its incident.
        gateway: who posted it.
        batch: with `gateway` the idempotency key.
        received: when it came, Unix seconds.
        sent: when the gateway says it sent it, Unix seconds.
        body: the JSON body as it came (decompressed).
        accepted: how many readings go to the estimator.
        rejected: the readings that were set aside, by index.
    """

    incident: str
    gateway: str
    batch: str
    received: float
    sent: float | None
    body: bytes
    accepted: int
    rejected: tuple[FieldError, ...] = ()


class Appended(msgspec.Struct, frozen=True):
    """What became of a batch.

    Attributes:
        seq: its place in the incident's log.
        accepted: how many of its readings go to the estimator.
        duplicate: it was in the log already.
        rejected: the readings that were set aside when it first came.
    """

    seq: int
    accepted: int
    duplicate: bool
    rejected: tuple[FieldError, ...]


class LoggedBatch(msgspec.Struct, frozen=True, kw_only=True):
    """One row of the log.

    Attributes:
        seq: its place in the incident's log.
        gateway: who posted it.
        batch: its name.
        received: when it came, Unix seconds.
        sent: when the gateway sent it, Unix seconds.
        body: the JSON body as it came.
        rejected: the readings that were set aside, by index.
    """

    seq: int
    gateway: str
    batch: str
    received: float
    sent: float | None
    body: bytes
    rejected: tuple[FieldError, ...]


class RecordedFrame(msgspec.Struct, frozen=True, kw_only=True):
    """What was known at one whole second of incident time.

    Attributes:
        second: the second, Unix seconds.
        seq: the newest log entry that had been folded.
        received: when that entry came, Unix seconds.
        record: the picture, encoded by `backend.live.record`.
    """

    second: int
    seq: int
    received: float
    record: bytes


class Snapshot(msgspec.Struct, frozen=True, kw_only=True):
    """The estimator's state of one incident after a log entry.

    Attributes:
        seq: the newest log entry that is in it.
        state: the state, encoded by `backend.tracking`.
        made_with: the tracker and what it was told, encoded by `backend.tracking`; None: not known.
    """

    seq: int
    state: bytes
    made_with: str | None = None


class LoggedStretch(msgspec.Struct, frozen=True, kw_only=True):
    """What the estimator of an incident was told from one change of settings on.

    Attributes:
        number: it counts up by one from 0, what the incident was opened with.
        after_seq: the newest log entry when it was set.
        since: when it was set, Unix seconds.
        settings: all of them, as JSON.
        origin: of the local coordinates, as JSON; None: not known.
    """

    number: int
    after_seq: int
    since: float
    settings: str
    origin: str | None


class StaleEpoch(Exception):  # noqa: N818 - names the condition, as the field does
    """A write under a lease that another worker has taken since."""


class LogUnwritable(Unavailable):
    """The log cannot be written now: disk full, database away."""


class LogUnreadable(Unavailable):
    """The log cannot be read now: database away, or locked for too long."""


class LogWriter(Protocol):
    """Appends to the log for many requests at once."""

    async def append(self, batch: NewBatch) -> Appended:
        """Append a batch; returns when it is durable.

        Raises:
            NotFound: there is no such incident.
            Conflict: the incident is closed.
            TooBusy: too much is waiting already.
            LogUnwritable: the database cannot be written; nothing is acknowledged.
        """


class LogReader(Protocol):
    """Reads the log; safe to use from any thread."""

    def batches(self, incident: str, after: int = 0, limit: int | None = None) -> Iterator[LoggedBatch]:
        """Batches with `seq` > `after` in `seq` order, in one consistent read per fetched block."""

    def stretches(self, incident: str, after: int = -1) -> list[LoggedStretch]:
        """What the incident was set to, in order: those with `number` > `after`.

        Read after entries of the log, they hold every change that was made before these came.
        """

    def frame_at(self, incident: str, t: float, received_by: float | None = None) -> RecordedFrame | None:
        """The newest recorded frame with second ≤ `t` (and received ≤ `received_by`)."""

    def frames(
        self, incident: str, start: float | None = None, end: float | None = None
    ) -> Iterator[RecordedFrame]:
        """Recorded frames with start ≤ second ≤ end, in order."""

    def frame_span(self, incident: str) -> tuple[int, int] | None:
        """First and last recorded second; None if there is none."""

    def snapshot(self, incident: str) -> Snapshot | None:
        """The newest snapshot of an incident."""


class DerivedWriter(Protocol):
    """What the worker writes beside the log; every write names the epoch of its lease."""

    def save(
        self, incident: str, epoch: int, frames: Sequence[RecordedFrame], snapshot: Snapshot | None
    ) -> None:
        """Store recorded frames and, if given, the snapshot in one transaction; repeats replace.

        Raises:
            StaleEpoch: another worker holds the incident now.
            LogUnwritable: the database cannot be written.
        """
