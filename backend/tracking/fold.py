"""One incident's log folded into pictures: the state of the worker, apart from all input and output."""

import math
from collections.abc import Iterator, Sequence
from typing import Self

import msgspec

from backend.live import record
from backend.live.past import SHOWN_WITHIN_S
from backend.live.record import PictureRecord, RecordNotice
from backend.log.base import LoggedBatch, RecordedFrame
from backend.tracking.alarms import alarms_heard
from backend.tracking.board import Board
from backend.tracking.clock_set_back import MonotonicClock
from backend.tracking.recorder import pieces, row_of
from estimator import trackers
from estimator.estimate import Relative
from estimator.measurements import AnyReading
from estimator.trackers.base import Tracker, TrackerSettings

VERSION = 9

STOOD_S = 2.0
"""What was shown for longer is recorded as it was, whatever comes later. Gateways post once a second or more
often: where all of them are behind by as much, seconds are recorded as they become known, and whole."""


class OtherState(Exception):  # noqa: N818 - names the condition
    """A state of another version, or for other settings: the log is folded from its start."""


class State(msgspec.Struct, frozen=True, array_like=True):
    """Everything that folding on from a log entry needs.

    Attributes:
        version: of this format.
        tracker: name of the tracker.
        settings: what the tracker was told.
        seq: newest log entry folded.
        received: when the newest one with readings came, Unix seconds.
        newest_t: incident time, Unix seconds.
        board: what is shown but not fused.
        estimator: the tracker's own state.
        stood: see `IncidentFold`.
        begun: see `IncidentFold`.
        clock: see `IncidentFold`.
    """

    version: int
    tracker: str
    settings: TrackerSettings
    seq: int
    received: float
    newest_t: float | None
    board: Board
    estimator: bytes
    stood: int | None = None
    begun: float = 0.0
    clock: MonotonicClock = msgspec.field(default_factory=MonotonicClock)


class _Version(msgspec.Struct, frozen=True, array_like=True):
    version: int


def _first_known(*times: float | None) -> float:
    return next((t for t in times if t is not None), 0.0)


class IncidentFold:
    """Folds the log of one incident, entry by entry; the same log gives the same rows, bit for bit.

    Args:
        tracker: name of the tracker.
        settings: what it is told.
        live: the incident goes by the server's clock: nothing is newer than when it came.

    Attributes:
        seq: newest log entry folded, or begun.
        whole: it is folded to its end.
        received: when the newest one with readings came, Unix seconds.
        clock: by which `newest_t`, `stood` and `begun` are told: the server's, but that it is never put back.
        newest_t: incident time, Unix seconds.
        row: newest second whose row was made; None: none since the beginning, or since it was restored.
        stood: newest second whose row is what stood on the screens until something came later; None: none.
        begun: when what came first for the second that is to be recorded next was received, Unix seconds.
    """

    def __init__(self, tracker: str, settings: TrackerSettings, live: bool = False) -> None:
        self._name = tracker
        self._live = live
        self._settings = settings
        self._tracker: Tracker = trackers.create(tracker, settings)
        self._asked = self._tracker
        self._board = Board()
        self._picture: PictureRecord | None = None
        self.seq = 0
        self.whole = True
        self.received = 0.0
        self.clock = MonotonicClock()
        self.newest_t: float | None = None
        self.row: int | None = None
        self.stood: int | None = None
        self.begun = 0.0

    def fold(self, batch: LoggedBatch, readings: Sequence[AnyReading]) -> Iterator[RecordedFrame | None]:
        """Fold one log entry, a piece at each step, so that the caller can let others have their turn.

        Args:
            batch: the entry.
            readings: those of its readings that go to the estimator.

        Yields:
            After each piece, the row that it completed, or None.
        """
        self.whole = False
        self._asked = self._tracker
        if self._live:
            self._hear(batch, readings)
            readings = self.clock.of(readings)
        came_t = batch.received + self.clock.ahead_s
        known_t = came_t if self._live else math.inf
        readings = alarms_heard(readings, came_t if self._live else batch.sent)
        if readings and (stood := self.stands(batch.received)) is not None:
            # The second may go on in what comes now, and would be recorded as of when that came.
            yield stood
        for piece in pieces(readings, self.newest_t, known_t):
            row, second = None, self._second
            if second is not None and piece.newest_t > second:
                row = self._made(second)
            self._tracker.fold(piece.readings, known_t)
            self._board.fold(piece.readings, known_t)
            self.newest_t = piece.newest_t
            if self._second != second:
                self.begun = came_t
            self._picture = None
            self.seq, self.received = batch.seq, batch.received
            yield row
        if self._live:
            self._board.hear_clock(batch, readings, came_t)
            self._picture = None
        if batch.rejected:
            if not self._live:
                came_t = _first_known(self.newest_t, batch.sent, batch.received)
            self._board.set_aside(batch, came_t, readings)
            self._picture = None
        self.seq = batch.seq
        self.whole = True

    def _hear(self, batch: LoggedBatch, readings: Sequence[AnyReading]) -> None:
        back_s = self.clock.hear(batch.received, readings, self.newest_t)
        if back_s:
            text = f"The server's clock was put back by {back_s} s: times told before were by that clock."
            t = batch.received + self.clock.ahead_s
            self._board.tell(RecordNotice(code="clock_put_back", t=t, text=text))

    def stands(self, until: float) -> RecordedFrame | None:
        """The row of what stood on the screens until a moment (Unix s) at which it is told otherwise."""
        second, until_t = self._second, until + self.clock.ahead_s
        if not self._live or second is None or not self._stood_long(second, until_t):
            return None
        self.stood, self.begun = second, until_t
        self._asked = self._tracker
        return self._made(second)

    def take_over(self, before: Self | None, since: float) -> None:
        """Go on where another fold of the same entries stands, which was told otherwise.

        Args:
            before: the other; None: it could not go on.
            since: the moment from which on what this one makes of them is known, Unix seconds.
        """
        if before is not None:
            self.stood, self.begun = before.stood, before.begun
        self.received = max(self.received, since)

    def _stood_long(self, second: int, received: float) -> bool:
        return received > max(second, self.begun) + STOOD_S

    @property
    def since_t(self) -> float | None:
        """The moment since which what is known now has been shown, Unix seconds; None before the first."""
        second = self._second
        return None if second is None else self._since_t(second - self.clock.ahead_s, self.received)

    def since_t_of(self, row: RecordedFrame) -> float:
        """The same of what a row tells."""
        return self._since_t(row.second, row.received)

    def _since_t(self, second: int, received: float) -> float:
        return max(second, received - SHOWN_WITHIN_S) if self._live else second

    @property
    def _second(self) -> int | None:
        """The second under which what is known now is recorded; None before the first reading."""
        second = row_of(self.newest_t)
        return second if second is None or self.stood is None else max(second, self.stood + 1)

    def _made(self, second: int) -> RecordedFrame:
        # Here and nowhere else: when a picture is published depends on the wall clock, rows do not.
        self._board.notice(self._tracker.take_notices())
        self._picture = None
        self.row = second - self.clock.ahead_s
        return self._row(second)

    def prepare(self) -> None:
        """Do now what the next picture needs: trackers put their work off until something is asked."""
        self._tracker.counts()

    def settling(self) -> bool:
        """Fold a little of what `settle` tells, while nothing comes; False: it needs little more."""
        return self._asked is self._tracker and self._tracker.settle()

    def settle(self) -> bool:
        """Nothing comes for now: let what was folded in a hurry be told as it is without one.

        Rows of seconds that are over are not touched: when nobody posts is no function of the log.

        Returns:
            Something was.
        """
        settled = self._tracker.settled() if self._asked is self._tracker else None
        if settled is None:
            return False
        self._asked, self._picture = settled, None
        return True

    def picture(self) -> PictureRecord:
        """What is known now."""
        if self._picture is None:
            picture = self._board.picture(self._asked.estimates(), self.newest_t)
            self._picture = self.clock.told(picture)
        return self._picture

    def last_row(self) -> RecordedFrame | None:
        """The row of the second that incident time is in, None before the first; more folding replaces it."""
        second = self._second
        return None if second is None else self._row(second)

    def _row(self, second: int) -> RecordedFrame:
        return RecordedFrame(
            second=second - self.clock.ahead_s,
            seq=self.seq,
            received=self.received,
            record=record.encode(self.picture()),
        )

    def relative(self, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a`; None where either has no decided position.

        Raises:
            KeyError: a node is not known.
        """
        return self._asked.relative(a, b)

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
                self.stood,
                self.begun,
                self.clock,
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
        fold._tracker = fold._asked = restored
        fold._board = state.board
        fold.seq, fold.received, fold.newest_t = state.seq, state.received, state.newest_t
        fold.stood, fold.begun, fold.clock = state.stood, state.begun, state.clock
        return fold
