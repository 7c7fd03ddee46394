"""What an incident has told: folded ahead as far as hardly anything can still come late.

Who asks about a whole incident, while it runs, then waits for its end to be folded only.
"""

import math
from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Sequence

from estimator.fusion.canonical_order import UNTIL_T, in_order
from estimator.fusion.holding import PAIRS, names_of
from estimator.fusion.memory.state import FusionState
from estimator.inertial.samples import AnyFolded, in_pieces
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Awaited
from estimator.measurements.imu import Imu
from estimator.smoothing.first_pass import TICK_S, FirstPass, end_of_tick
from estimator.smoothing.results.tracks import Lifetimes
from estimator.trackers.first_reports import FirstReports

LONGEST_S = 86_400.0
"""No incident lasts longer: a reading farther than a day from the others has a wrong epoch."""


class Heard:
    """Readings of one incident, the older ones folded already: what they make is as if all had come at once.

    Args:
        lag_s: they may be late by so much (s).
        origin_wgs84: latitude (°), longitude (°), height (m) of the local origin, if known.
    """

    def __init__(self, lag_s: float, origin_wgs84: tuple[float, float, float] | None = None) -> None:
        self._lag_s = lag_s
        self._pass = FirstPass(origin_wgs84)
        self._until_t = -math.inf
        self._epochs = array("d")
        self._lifetimes: dict[str, tuple[float, float]] = {}
        self._first = FirstReports()
        self._early: list[AnyFolded] = []
        self._waiting: list[AnyFolded] = []

    def __len__(self) -> int:
        """How many have been heard; raw samples count by pieces."""
        return len(self._early) + len(self._epochs) + len(self._waiting)

    def can_hear(self, readings: Sequence[AnyReading]) -> bool:
        """Whether they all tell of what is not folded yet. Where not, all is to be heard anew, in order."""
        return all(_begins(reading) >= self._until_t for reading in readings)

    def hear(self, readings: Sequence[AnyReading]) -> None:
        """Take readings, in any order of epochs.

        Args:
            readings: they are, all such as `can_hear` tells.
        """
        self._waiting += in_pieces(readings)
        self._waiting += [one for one in self._first.awaited(readings) if one.t >= self._until_t]

    def fold_ahead(self, newest_t: float) -> None:
        """Fold what is older than the lag, but for what is of another day: its epoch is rather wrong.

        Args:
            newest_t: an epoch that is past, by a clock that can be trusted (s).
        """
        until_t = end_of_tick(newest_t - self._lag_s) - TICK_S
        if until_t <= self._until_t or (self._epochs and self._epochs[-1] <= newest_t - LONGEST_S):
            # What was folded is of another day: nothing goes on from there.
            return
        self._waiting = in_order(self._waiting)
        early = bisect_right(self._waiting, newest_t - LONGEST_S, key=UNTIL_T)
        ready = self._waiting[early : bisect_left(self._waiting, until_t, key=UNTIL_T)]
        self._early += self._waiting[:early]
        del self._waiting[: early + len(ready)]
        self._pass.fold(ready)
        self._epochs.extend(map(UNTIL_T, ready))
        _extend(self._lifetimes, ready)
        self._until_t = until_t

    def misdated(self) -> bool:
        """Whether of what was folded, or left out, an epoch turns out to be wrong, or right after all.

        Then all is to be heard anew, and nothing to be folded ahead.
        """
        since_t, until_t = self._day(sorted(self._waiting, key=UNTIL_T))
        wrong = bool(self._epochs) and not since_t < self._epochs[0] <= self._epochs[-1] < until_t
        return wrong or any(reading.until_t > since_t for reading in self._early)

    def ended(self) -> tuple[FusionState, Lifetimes]:
        """What is known where nothing more comes: the state after the first pass, and who was heard when.

        Both may be changed: this goes on without what is not folded yet. What is folded is not `misdated`.
        """
        rest = in_order(self._waiting)
        since_t, until_t = self._day(rest)
        rest = rest[bisect_right(rest, since_t, key=UNTIL_T) : bisect_left(rest, until_t, key=UNTIL_T)]
        lifetimes = dict(self._lifetimes)
        _extend(lifetimes, rest)
        return self._pass.ended(rest), lifetimes

    def _day(self, waiting: Sequence[AnyFolded]) -> tuple[float, float]:
        """Epochs between which the incident lies (s): a day to both sides of its middle reading's.

        Args:
            waiting: what is not folded yet, by epoch.
        """
        middle, middle_t = len(self) // 2, 0.0
        early = sorted(self._early, key=UNTIL_T)
        if middle < len(early):
            middle_t = early[middle].until_t
        elif middle < len(early) + len(self._epochs):
            middle_t = self._epochs[middle - len(early)]
        elif waiting:
            middle_t = waiting[middle - len(early) - len(self._epochs)].until_t
        return middle_t - LONGEST_S, middle_t + LONGEST_S


def _begins(reading: AnyReading) -> float:
    """From when on a reading is folded; raw samples piece by piece."""
    return reading.t if isinstance(reading, Imu) else reading.until_t


def _extend(lifetimes: dict[str, tuple[float, float]], readings: Sequence[AnyFolded]) -> None:
    """Take note of who was heard in readings, which come in order of epoch."""
    since, until = dict[str, float](), dict[str, float]()
    for reading in readings:
        t = reading.t
        if isinstance(reading, PAIRS):
            # Nearly all are such: of one epoch, before which nothing of what comes later begins but samples.
            a, b = reading.a, reading.b
            until[a] = until[b] = t
            if a not in since:
                since[a] = t
            if b not in since:
                since[b] = t
            continue
        if type(reading) is Awaited:
            continue
        until_t = reading.until_t
        for name in names_of(reading):
            until[name] = until_t
            if name not in since or t < since[name]:
                since[name] = t
    for name, first_t in since.items():
        known = lifetimes.get(name)
        lifetimes[name] = first_t if known is None else min(first_t, known[0]), until[name]
