"""Telling the web process of one incident's pictures: not too often, and the newest always."""

import time
from collections.abc import Callable

import msgspec

from backend.coordination.base import Answer, Picture
from backend.live import record
from backend.live.record import EMPTY, PictureRecord, RecordNotice
from backend.log.base import RecordedFrame

OWN_EVERY_S = 1.0
"""While more is to be folded, what is recorded is shown: a picture for its own sake is made only after so
long without one. It solves the window of a second that has just begun, which the next entry changes."""

Publish = Callable[[Picture | Answer], None]


class Publication:
    """Publishes one incident's pictures.

    Args:
        incident: whose.
        publish: sends to the web process.
        shown_hz: how often a picture may be published.
    """

    def __init__(self, incident: str, publish: Publish, shown_hz: float) -> None:
        self._incident = incident
        self._publish = publish
        self._every_s = 1.0 / shown_hz
        self._shown_at = 0.0
        self._shown_seq: int | None = None
        self._shown = EMPTY
        self._still = False

    def lacks(self, seq: int) -> bool:
        """The web process has not been told of a log entry."""
        return seq != self._shown_seq

    def due_s(self, *, behind: bool = False) -> float:
        """In how many seconds the next picture may be published; not more than 0: now.

        Args:
            behind: one that is made for it alone, while more is to be folded.
        """
        every_s = max(OWN_EVERY_S, self._every_s) if behind else self._every_s
        return self._shown_at + every_s - time.monotonic()

    def begin(self) -> None:
        """A picture is being made: the next one is due so long after this moment."""
        self._shown_at = time.monotonic()

    def show(
        self, seq: int, row: int | None, since_t: float | None, picture: PictureRecord, encoded: bytes
    ) -> None:
        """Publish a picture.

        Args:
            seq: newest log entry in it.
            row: newest second whose row was made.
            since_t: since when this is what is known, Unix seconds.
            picture: what is known.
            encoded: the same as bytes.
        """
        self._shown_seq, self._shown = seq, picture
        self._publish(Picture(self._incident, seq, encoded, row, since_t=since_t))

    def show_recorded(self, row: RecordedFrame, seq: int, newest: int | None, since_t: float) -> None:
        """Publish what was known at the end of a second, if it is new and one is due: it costs no more.

        Args:
            row: of that second.
            seq: newest log entry that is whole in it.
            newest: newest second whose row was made.
            since_t: see `show`.
        """
        if self.due_s() <= 0 and (self._shown_seq is None or seq > self._shown_seq):
            self.begin()
            self.show(seq, newest, since_t, record.decode(row.record), row.record)

    def again(self) -> None:
        """The web process may have missed what was published: the newest picture is told once more."""
        if self._still:
            self.stand_still()
        self._shown_seq = None

    def stand_still(self, seq: int | None = None) -> None:
        """Publish the last good picture with a notice that it stands still.

        Args:
            seq: log entry at which the estimator broke.
        """
        if not self._still:
            text = (
                f"The estimator broke at log entry {seq} or shortly before: this picture stands still. "
                "The worker's own log tells more."
            )
            notice = RecordNotice(code="estimator_failed", t=self._shown.t or 0.0, text=text)
            self._shown = msgspec.structs.replace(self._shown, notices=(*self._shown.notices, notice))
            self._still = True
            self._still_seq = self._shown_seq or 0
        self._publish(Picture(self._incident, self._still_seq, record.encode(self._shown), failed=True))
