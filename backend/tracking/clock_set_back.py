"""A server's clock that was put back: what came before and after it, on one clock that only goes on.

By the clock before, time has passed that is still to come by the one after: until it has come, whatever is
reported would be too late to be fused.
"""

import math
from collections.abc import Sequence
from typing import TypeVar

import msgspec

from backend.live.record import PictureRecord
from backend.log.base import LoggedBatch
from estimator.measurements import Alarm, AnyReading, Displacement

Part = TypeVar("Part", bound=msgspec.Struct)

PUT_BACK_S = 60.0
"""By less, readings come late and are fused all the same; clocks of gateways may be this wrong as well."""

GATHERED_S = 10.0
"""What a gateway gathers before it posts is no older; more would make others seem older than they are."""

_TIMES = {
    "nodes": ("t", "moved_t", "battery_t", "air_t", "temperature_t", "motionless_t"),
    "alarms": ("t",),
    "notices": ("t",),
    "set_aside": ("t", "since_t"),
    "clocks": ("t",),
}


class MonotonicClock(msgspec.Struct):
    """The server's clock, made monotonic: it goes on where that is put back.

    Attributes:
        ahead_s: by how much it is ahead of the server's (s), whole seconds.
        received: when the newest entry with readings came, by this clock (s).
    """

    ahead_s: int = 0
    received: float = 0.0

    def hear(self, received: float, readings: Sequence[AnyReading], newest_t: float | None) -> int:
        """Take note of an entry.

        The clock of a gateway has to have gone back too: where those are right, nothing is in the future.

        Args:
            received: when it came, by the server's clock, Unix seconds.
            readings: of it, by that clock as well.
            newest_t: the newest epoch before it by this clock, none later than it came; None: there is none.

        Returns:
            By how much the server's clock was put back before it came (s); 0 where it was not.
        """
        back_s = 0
        if newest_t is not None and received < (known_t := newest_t - self.ahead_s) - PUT_BACK_S:
            timed = [reading for reading in readings if not isinstance(reading, Alarm)]
            newest = max((reading.until_t for reading in timed), default=math.inf)
            if received - PUT_BACK_S <= newest < known_t - PUT_BACK_S:
                waited_s = self.received - self.ahead_s - received
                back_s = math.ceil(
                    max(waited_s, min(known_t - min(map(_start, timed)), waited_s + GATHERED_S))
                )
                self.ahead_s += back_s
        if readings:
            self.received = max(self.received, received + self.ahead_s)
        return back_s

    def of(self, readings: Sequence[AnyReading]) -> Sequence[AnyReading]:
        """Readings with their epochs by this clock."""
        return [_later(reading, self.ahead_s) for reading in readings] if self.ahead_s else readings

    def told(self, record: PictureRecord) -> PictureRecord:
        """A picture with its times by the server's clock as it goes now."""
        if not self.ahead_s:
            return record
        parts = {
            name: tuple(earlier(part, self.ahead_s, times) for part in getattr(record, name))
            for name, times in _TIMES.items()
        }
        return earlier(msgspec.structs.replace(record, **parts), self.ahead_s)


class OneClock:
    """All entries of a log on one clock, one after the other.

    Args:
        live: the incident goes by the server's clock; the others go by their readings, whatever that does.

    Attributes:
        newest_t: the newest epoch so far by this clock, of a live incident none later than it came; None:
            nothing has come.
    """

    def __init__(self, live: bool) -> None:
        self._live = live
        self._clock = MonotonicClock()
        self.newest_t: float | None = None

    @property
    def ahead_s(self) -> int:
        """By how much it is ahead of the server's now (s)."""
        return self._clock.ahead_s

    def take(self, batch: LoggedBatch, readings: Sequence[AnyReading]) -> Sequence[AnyReading]:
        """The readings of the next entry, by this clock.

        Args:
            batch: the entry.
            readings: of it that are used.
        """
        if not readings:
            return readings
        if self._live:
            self._clock.hear(batch.received, readings, self.newest_t)
        newest_t = max(reading.until_t for reading in readings) + self.ahead_s
        if self._live:
            newest_t = min(batch.received + self.ahead_s, newest_t)
        self.newest_t = newest_t if self.newest_t is None else max(newest_t, self.newest_t)
        return self._clock.of(readings)


def earlier(part: Part, by_s: float, times: Sequence[str] = ("t",)) -> Part:
    """What is told by this clock, by one that is behind it by so much (s).

    Args:
        part: it is.
        by_s: by how much.
        times: its fields that are epochs (s), or None.
    """
    known = {name: getattr(part, name) for name in times}
    return msgspec.structs.replace(part, **{name: t - by_s for name, t in known.items() if t is not None})


def _start(reading: AnyReading) -> float:
    return reading.from_t if isinstance(reading, Displacement) and reading.from_t is not None else reading.t


def _later(reading: AnyReading, by_s: float) -> AnyReading:
    if isinstance(reading, Displacement) and reading.from_t is not None:
        return msgspec.structs.replace(reading, t=reading.t + by_s, from_t=reading.from_t + by_s)
    return msgspec.structs.replace(reading, t=reading.t + by_s)
