"""One incident's log folded through its stretches: each entry by what was set when it came."""

from collections.abc import Generator, Iterable, Iterator
from typing import Self

import structlog

from backend.errors import Unavailable
from backend.log.base import LoggedStretch, LogReader, RecordedFrame, Snapshot
from backend.tracking.fold import IncidentFold, OtherState
from backend.tracking.heads import MadeWith, told_by
from backend.tracking.log_blocks import Decoded, read_block

Step = tuple[RecordedFrame | None, bool]
"""A row that is complete now, if any; and whether all is folded that was begun."""

log = structlog.get_logger(__name__)


class _StillBroken(Exception):  # noqa: N818 - names the condition
    """Something was set, but nothing that the tracker which broke is told."""


class Course:
    """Folds entries, and where the tracker is told otherwise, those before anew: rows stay as they were made.

    The same log and the same stretches give the same rows, bit for bit.

    Args:
        reader: of the log.
        incident: whose.
        live: it goes by the server's clock.
        fold: what is folded so far.
        made_with: what it was told.

    Attributes:
        fold: see above; another one after a change.
        made_with: see above.
    """

    def __init__(
        self, reader: LogReader, incident: str, live: bool, fold: IncidentFold, made_with: MadeWith
    ) -> None:
        self.fold = fold
        self.made_with = made_with
        self._reader = reader
        self._incident = incident
        self._live = live
        self._coming: list[LoggedStretch] = []

    @classmethod
    def begin(cls, reader: LogReader, incident: str, live: bool, snapshot: Snapshot | None = None) -> Self:
        """A course that goes on from a stored state, or from the beginning where there is none to go on from.

        Raises:
            LogUnreadable: the database failed.
        """
        stretches = [told_by(one.settings, one.origin, one.number) for one in reader.stretches(incident)]
        if snapshot is not None:
            number = 0 if snapshot.made_with is None else MadeWith.stored(snapshot.made_with).stretch
            told = stretches[number]
            try:
                fold = IncidentFold.restore(snapshot.state, told.tracker, told.settings, live)
                return cls(reader, incident, live, fold, told)
            except OtherState as why:
                log.warning("the log is folded from its start", incident=incident, why=str(why))
        told = stretches[0]
        return cls(reader, incident, live, IncidentFold(told.tracker, told.settings, live), told)

    @property
    def at(self) -> tuple[int, int]:
        """The newest log entry and the newest stretch that are folded."""
        return self.fold.seq, self.made_with.stretch

    @property
    def passing(self) -> bool:
        """Other settings are known to follow: what is known by these is not what is known now."""
        return bool(self._coming)

    def read(self) -> list[Decoded]:
        """The next entries of the log; what was set before they came is noted.

        Raises:
            LogUnreadable: the database failed.
        """
        block = read_block(self._reader, self._incident, self.fold.seq)
        # In this order: what was set before an entry was committed is there when the entry is.
        self._coming = self._reader.stretches(self._incident, after=self.made_with.stretch)
        return block

    def steps(self, block: Iterable[Decoded]) -> Iterator[Step]:
        """Fold what was read, step by step, so that the caller can let others have their turn.

        A tracker that breaks has made its last row; where another is told to follow, that one goes on.

        Raises:
            LogUnreadable: the database failed.
            Exception: the last tracker broke.
        """
        block, broken = list(block), False
        while True:
            try:
                if broken:
                    yield from self._enter(broken=True)
                yield from self._through(block)
            except Unavailable:
                raise
            except Exception as error:
                if not self._coming:
                    raise
                log.warning("the estimator failed", incident=self._incident, at=self.at, error=repr(error))
                broken = True
            else:
                return

    def _through(self, block: list[Decoded]) -> Iterator[Step]:
        for batch, readings in block:
            while self._coming and self._coming[0].after_seq < batch.seq:
                yield from self._enter()
            if batch.seq <= self.fold.seq:
                continue  # folded on entering a stretch, after a tracker that broke
            for row in self.fold.fold(batch, readings):
                yield row, False
            yield None, True
        while self._coming and self._coming[0].after_seq <= self.fold.seq:
            yield from self._enter()

    def _enter(self, *, broken: bool = False) -> Iterator[Step]:
        """Go on in the next stretch; it stays among those to come until all is folded by its settings."""
        stretch = self._coming[0]
        told = told_by(stretch.settings, stretch.origin, stretch.number)
        try:
            if not told.tells_as(self.made_with):
                self.fold = yield from self._told_otherwise(told, stretch, broken=broken)
            elif broken:
                raise _StillBroken
        except Unavailable:
            raise
        except Exception:
            self._entered(told)
            raise
        self._entered(told)
        yield None, True

    def _entered(self, told: MadeWith) -> None:
        self.made_with = told
        del self._coming[0]

    def _told_otherwise(
        self, told: MadeWith, stretch: LoggedStretch, *, broken: bool
    ) -> Generator[Step, None, IncidentFold]:
        """All entries so far, folded by other settings; of this folding no rows are made."""
        if not broken and (stood := self.fold.stands(stretch.since)) is not None:
            yield stood, False
        fold = IncidentFold(told.tracker, told.settings, self._live)
        while fold.seq < stretch.after_seq:
            for batch, readings in read_block(self._reader, self._incident, fold.seq):
                if batch.seq > stretch.after_seq:
                    break
                for _ in fold.fold(batch, readings):
                    yield None, False
        fold.take_over(None if broken else self.fold, stretch.since)
        return fold
