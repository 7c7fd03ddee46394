"""Logs that are read and folded already: who asks about an incident that runs waits for its end only."""

from collections import OrderedDict
from collections.abc import Hashable, Iterator

from backend.log.base import LogReader
from backend.tracking.clock_set_back import OneClock
from backend.tracking.heads import Head
from backend.tracking.log_blocks import Decoded, read_block
from estimator.trackers.heard import Heard

AHEAD = 4
"""So many incidents are read ahead: the newest that run."""
KEPT = 2 * AHEAD
"""So many are kept, those read most recently: who looks back at others costs no running one its place."""

LARGEST = 2_000_000
"""Readings in all of them: each takes some hundred bytes, also once it is folded."""


class KnownLog:
    """A log as far as it is read, folded as far as hardly anything can come late.

    Args:
        head: the incident.

    Attributes:
        seq: newest entry that is read.
        heard: its readings, on one clock.
    """

    def __init__(self, head: Head) -> None:
        self.seq = 0
        self.heard = Heard(head.settings.lag_s, head.settings.origin_wgs84)
        self._clock = OneClock(head.live)

    @property
    def ahead_s(self) -> int:
        """By how much its clock is ahead of the server's now (s)."""
        return self._clock.ahead_s

    def take(self, entry: Decoded) -> bool:
        """Take the next entry; False where it tells of what is folded already: the log is to be read anew."""
        batch, decoded = entry
        readings = self._clock.take(batch, decoded)
        if not self.heard.can_hear(readings):
            return False
        self.heard.hear(readings)
        self.seq = batch.seq
        return True

    def fold_ahead(self) -> None:
        """Fold what is old enough of what was taken."""
        if self._clock.newest_t is not None:
            self.heard.fold_ahead(self._clock.newest_t)


class KnownLogs:
    """The logs that were asked about, or that grow."""

    def __init__(self) -> None:
        self._kept: OrderedDict[Hashable, KnownLog] = OrderedDict()
        self._given_up: set[Hashable] = set()

    def up_to(self, reader: LogReader, head: Head, of: Hashable) -> KnownLog:
        """A log up to its head's newest entry.

        Args:
            reader: of the log.
            head: the incident.
            of: of which database.

        Raises:
            LogUnreadable: the database failed.
        """
        key = _key(head, of)
        known = self._kept.pop(key, None)
        if known is None or not _read_on(known, reader, head):
            known = _read(reader, head)
        known.fold_ahead()
        if known.heard.misdated():
            self._drop(key)
            return _read(reader, head)
        self._given_up.discard(key)
        self._keep(key, known)
        return known

    def read_ahead(self, reader: LogReader, head: Head, of: Hashable) -> bool:
        """Take the next few entries of a log, should somebody ask about it.

        One whose readings come later than it says is not read ahead until it is asked about: it would be read
        from its start again and again.

        Args:
            reader: of the log.
            head: the incident.
            of: of which database.

        Returns:
            Whether there may be more.

        Raises:
            LogUnreadable: the database failed.
        """
        key = _key(head, of)
        if key in self._given_up:
            return False
        known = self._kept.get(key) or KnownLog(head)
        block = read_block(reader, head.incident, known.seq)
        if not all(map(known.take, block)):
            self._drop(key)
            return False
        known.fold_ahead()
        self._keep(key, known)
        return bool(block) and key not in self._given_up

    def give_up(self, head: Head, of: Hashable) -> None:
        """Read a log no more until it is asked about."""
        self._drop(_key(head, of))

    def _keep(self, key: Hashable, known: KnownLog) -> None:
        self._kept[key] = known
        self._kept.move_to_end(key)
        while len(self._kept) > KEPT:
            self._drop(next(iter(self._kept)))
        while sum(len(one.heard) for one in self._kept.values()) > LARGEST:
            self._drop(max(self._kept, key=lambda one: len(self._kept[one].heard)))

    def _drop(self, key: Hashable) -> None:
        self._kept.pop(key, None)
        self._given_up.add(key)


def entries(reader: LogReader, head: Head, after: int = 0) -> Iterator[Decoded]:
    """The entries of a log after one of them, up to its head's newest.

    Raises:
        LogUnreadable: the database failed.
    """
    while after < head.last_seq and (block := read_block(reader, head.incident, after)):
        for batch, readings in block:
            if batch.seq <= head.last_seq:
                yield batch, readings
        after = block[-1][0].seq


def _read(reader: LogReader, head: Head) -> KnownLog:
    """A log up to a head's newest entry, nothing of it folded."""
    known = KnownLog(head)
    _read_on(known, reader, head)
    return known


def _read_on(known: KnownLog, reader: LogReader, head: Head) -> bool:
    """Read to a head's newest entry; False where the log is to be read anew for it."""
    if known.seq > head.last_seq:
        return False
    return all(map(known.take, entries(reader, head, known.seq))) and not known.heard.misdated()


def _key(head: Head, of: Hashable) -> Hashable:
    return of, head.incident, head.tracker, head.settings, head.live
