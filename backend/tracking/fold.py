"""One incident's log folded into pictures: the state of the worker, apart from all input and output."""

import math
from collections.abc import Iterator, Sequence
from typing import Self

import msgspec

from backend.live import record
from backend.live.record import PictureRecord
from backend.log.base import LoggedBatch, RecordedFrame
from backend.tracking.board import Board
from backend.tracking.recorder import pieces, row_of
from estimator import trackers
from estimator.estimate import Relative
from estimator.measurements import AnyReading
from estimator.trackers.base import Tracker, TrackerSettings

VERSION = 3


class OtherState(Exception):  # noqa: N818 - names the condition
    """A state of another version, or for other settings: the log is folded from its start."""


class State(msgspec.Struct, frozen=True, array_like=True):
    """Everything that folding on from a log entry needs.

    Attributes:
        version: of this format.
        tracker: name of the tracker.
        settings: what the tracker was told.
        seq: newest log entry folded.
        received: when it came, Unix seconds.
        newest_t: incident time, Unix seconds.
        board: what is shown but not fused.
        estimator: the tracker's own state.
    """

    version: int
    tracker: str
    settings: TrackerSettings
    seq: int
    received: float
    newest_t: float | None
    board: Board
    estimator: bytes


class _Version(msgspec.Struct, frozen=True, array_like=True):
    version: int


class IncidentFold:
    """Folds the log of one incident, entry by entry; the same log gives the same rows, bit for bit.

    Args:
        tracker: name of the tracker.
        settings: what it is told.
        live: the incident goes by the server's clock: nothing is newer than when it came.

    Attributes:
        seq: newest log entry folded, or begun.
        whole: it is folded to its end.
        received: when it came, Unix seconds.
        newest_t: incident time, Unix seconds.
        row: newest second whose row was made; None: none since the beginning, or since it was restored.
    """

    def __init__(self, tracker: str, settings: TrackerSettings, live: bool = False) -> None:
        self._name = tracker
        self._live = live
        self._settings = settings
        self._tracker: Tracker = trackers.create(tracker, settings)
        self._board = Board()
        self._picture: PictureRecord | None = None
        self.seq = 0
        self.whole = True
        self.received = 0.0
        self.newest_t: float | None = None
        self.row: int | None = None

    def fold(self, batch: LoggedBatch, readings: Sequence[AnyReading]) -> Iterator[RecordedFrame | None]:
        """Fold one log entry, a piece at each step, so that the caller can let others have their turn.

        Args:
            batch: the entry.
            readings: those of its readings that go to the estimator.

        Yields:
            After each piece, the row that it completed, or None.
        """
        self.whole = False
        known_t = batch.received if self._live else math.inf
        for piece in pieces(readings, self.newest_t, known_t):
            row = None
            if piece.row is not None:
                # Here and nowhere else: when a picture is published depends on the wall clock, rows do not.
                self._board.notice(self._tracker.take_notices())
                self._picture = None
                row = self._row(piece.row)
                self.row = piece.row
            self._tracker.fold(piece.readings, known_t)
            self._board.fold(piece.readings, known_t)
            self.newest_t = piece.newest_t
            self._picture = None
            self.seq, self.received = batch.seq, batch.received
            yield row
        self.seq, self.received = batch.seq, batch.received
        self.whole = True

    def prepare(self) -> None:
        """Do now what the next picture needs: trackers put their work off until something is asked."""
        self._tracker.counts()

    def picture(self) -> PictureRecord:
        """What is known now."""
        if self._picture is None:
            self._picture = self._board.picture(self._tracker.estimates(), self.newest_t)
        return self._picture

    def last_row(self) -> RecordedFrame | None:
        """The row of the second that incident time is in, None before the first; more folding replaces it."""
        second = row_of(self.newest_t)
        return None if second is None else self._row(second)

    def _row(self, second: int) -> RecordedFrame:
        return RecordedFrame(
            second=second, seq=self.seq, received=self.received, record=record.encode(self.picture())
        )

    def relative(self, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a`; None where either has no decided position.

        Raises:
            KeyError: a node is not known.
        """
        return self._tracker.relative(a, b)

    def state(self) -> bytes:
        """The whole state; to be taken between entries only."""
        return msgspec.msgpack.encode(
            State(
                VERSION,
                self._name,
                self._settings,
                self.seq,
                self.received,
                self.newest_t,
                self._board,
                self._tracker.snapshot(),
            )
        )

    @classmethod
    def restore(cls, encoded: bytes, tracker: str, settings: TrackerSettings, live: bool = False) -> Self:
        """The fold that goes on where `state` was taken.

        Raises:
            OtherState: it was written by another version or for other settings.
        """
        try:
            version = msgspec.msgpack.decode(encoded, type=_Version).version
            if version != VERSION:
                raise OtherState(f"the state is of version {version}, not {VERSION}")
            state = msgspec.msgpack.decode(encoded, type=State)
            if (state.tracker, state.settings) != (tracker, settings):
                raise OtherState("the incident's estimator was given other settings since")
            restored = trackers.restore(tracker, state.estimator)
        except (msgspec.DecodeError, ValueError) as error:
            raise OtherState(str(error)) from error
        fold = cls(tracker, settings, live)
        fold._tracker, fold._board = restored, state.board
        fold.seq, fold.received, fold.newest_t = state.seq, state.received, state.newest_t
        return fold
