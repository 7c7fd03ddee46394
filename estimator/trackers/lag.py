"""Late and out-of-order readings: the filter is rolled back to before them and folds again.

The estimates are a function of the set of readings inside the lag, not of the order in which they arrived:
each tick is folded from the state before it and its own readings in canonical order. Folding happens when
something is asked for, so many batches cost one pass.
"""

import math
from bisect import bisect_left, insort
from collections.abc import Sequence
from operator import itemgetter
from typing import Self

import msgspec

from estimator.estimate import Notice
from estimator.fusion.memory.state import FusionState
from estimator.fusion.order import end_of_tick, place_of, tick_of
from estimator.fusion.tick import fold_tick, names_of
from estimator.inertial.samples import AnyFolded, Samples, in_pieces
from estimator.measurements import AnyReading
from estimator.smoothing.window import keep_up

AGES_S, SPACINGS_S = (4.0, 16.0), (0.0, 4.0, 16.0)
"""Up to each age, and beyond the last, checkpoints are kept so far apart: a reading late by x is folded anew
over about x, no more."""


class LagRecord(msgspec.Struct, frozen=True, array_like=True):
    """`Lag` in plain values, but for its states: the oldest and the newest one are kept beside it.

    Attributes:
        newest_t: see `Lag`.
        too_late: see `Lag`.
        received: see `Lag`.
        readings: readings of each tick.
        checkpoints: tick of each state kept.
        notices: noticed in each tick.
        given: notices of each tick that were taken.
        loose: notices not taken yet that belong to no tick.
        late: see `Lag`.
    """

    newest_t: float | None
    too_late: int
    received: int
    readings: list[tuple[int, list[AnyFolded]]]
    checkpoints: list[int]
    notices: dict[int, list[Notice]]
    given: dict[int, list[Notice]]
    loose: list[Notice]
    late: dict[str, int] = msgspec.field(default_factory=dict)


class Lag:
    """Readings of the last `lag_s` in ticks, and states of the filter to roll back to.

    Attributes:
        lag_s: readings later than this behind the newest epoch are counted, not fused (s).
        newest_t: newest epoch so far, but none that was still to come; None before the first reading.
        too_late: readings that came too late.
        received: all readings.
        late: of those that came too late, how many name each node first.
    """

    def __init__(self, lag_s: float, state: FusionState) -> None:
        self.lag_s = lag_s
        self.newest_t: float | None = None
        self.too_late = 0
        self.received = 0
        self.late: dict[str, int] = {}
        self._ticks: list[int] = []
        self._readings: dict[int, list[AnyFolded]] = {}
        self._checkpoints: list[tuple[int, FusionState]] = [(-1, state)]
        self._folded = -1
        self._notices: dict[int, list[Notice]] = {}
        self._given: dict[int, list[Notice]] = {}
        self._loose: list[Notice] = []

    @classmethod
    def of(cls, lag_s: float, record: LagRecord, states: Sequence[FusionState]) -> Self:
        """The lag that a record and its states were made of."""
        lag = cls(lag_s, states[0])
        lag.newest_t, lag.too_late, lag.received = record.newest_t, record.too_late, record.received
        lag.late = dict(record.late)
        lag._ticks = [tick for tick, _ in record.readings]
        lag._readings = {tick: list(readings) for tick, readings in record.readings}
        lag._checkpoints = list(zip(record.checkpoints, states, strict=True))
        lag._folded = record.checkpoints[-1]
        lag._notices, lag._given, lag._loose = record.notices, record.given, record.loose
        return lag

    def record(self) -> tuple[LagRecord, list[FusionState]]:
        """A record of everything, and the states that belong to it.

        Only the oldest and the newest checkpoint go in: those between are folded anew when they are needed.
        """
        self.state()
        checkpoints = (
            self._checkpoints if len(self._checkpoints) < 3 else [self._checkpoints[0], self._checkpoints[-1]]
        )
        record = LagRecord(
            self.newest_t,
            self.too_late,
            self.received,
            [(tick, list(self._readings[tick])) for tick in self._ticks],
            [tick for tick, _ in checkpoints],
            self._notices,
            self._given,
            self._loose,
            dict(self.late),
        )
        return record, [state for _, state in checkpoints]

    def add(self, readings: Sequence[AnyReading], known_t: float = math.inf) -> None:
        """Take readings in; those beyond the lag are counted and noticed.

        Args:
            readings: in any order of epochs.
            known_t: when they came, by a clock that can be trusted (s): by no later epoch others are late.
        """
        missed: dict[str, AnyFolded] = {}
        self.received += len(readings)
        in_order = sorted(((r.until_t, r) for r in in_pieces(readings)), key=itemgetter(0))
        for until_t, reading in in_order:
            if self.newest_t is not None and until_t < self.newest_t - self.lag_s:
                if not isinstance(reading, Samples) or reading.last:
                    node = names_of(reading)[0]
                    self.too_late += 1
                    self.late[node] = self.late.get(node, 0) + 1
                    missed[node] = reading
                continue
            newest_t = min(until_t, known_t)
            self.newest_t = newest_t if self.newest_t is None else max(self.newest_t, newest_t)
            tick = tick_of(until_t)
            if tick not in self._readings:
                self._readings[tick] = []
                insort(self._ticks, tick)
            self._readings[tick].append(reading)
            if tick <= self._folded:
                self._roll_back(tick)
        for node, newest in missed.items():
            self._loose.append(
                Notice(code="too_late", t=newest.t, node=node, text=_too_late(self.late[node], self.lag_s))
            )

    def _roll_back(self, tick: int) -> None:
        while self._checkpoints[-1][0] >= tick:
            self._checkpoints.pop()
        self._folded = self._checkpoints[-1][0]

    def state(self) -> FusionState:
        """The filter after all readings so far; not to be changed."""
        first = bisect_left(self._ticks, self._folded + 1)
        for tick in self._ticks[first:]:
            before = self._checkpoints[-1][1]
            after = before.copy()
            in_order = sorted(self._readings[tick], key=place_of)
            fold_tick(after, end_of_tick(tick), in_order)
            keep_up(after, end_of_tick(tick))
            self._notices[tick] = list(after.notices)
            self._checkpoints.append((tick, after))
            self._folded = tick
            self._thin(tick)
        self._commit()
        return self._checkpoints[-1][1]

    def _thin(self, newest: int) -> None:
        """Leave checkpoints out as they age; the two newest always stay."""
        now, before = end_of_tick(newest), (0.0, 0.0)
        thinned: list[tuple[int, FusionState]] = []
        for i, checkpoint in enumerate(self._checkpoints[:-2]):
            end = end_of_tick(checkpoint[0])
            spacing = SPACINGS_S[bisect_left(AGES_S, now - end)]
            if spacing == 0.0:
                thinned += self._checkpoints[i:]
                break
            bucket = (spacing, end // spacing)
            # The oldest of each bucket stays, so that what has grown old enough to be thinned is not lost
            # again.
            if bucket != before:
                before = bucket
                thinned.append(checkpoint)
        else:
            thinned += self._checkpoints[-2:]
        self._checkpoints = thinned

    def _commit(self) -> None:
        """Forget readings that nothing can come before any more, and the checkpoints under them."""
        if self.newest_t is None:
            return
        horizon = tick_of(self.newest_t - self.lag_s)
        base = bisect_left(self._checkpoints, horizon, key=lambda c: c[0]) - 1
        if base <= 0:
            return
        del self._checkpoints[:base]
        done = bisect_left(self._ticks, self._checkpoints[0][0] + 1)
        for tick in self._ticks[:done]:
            del self._readings[tick]
            self._loose.extend(self._fresh(tick))
            self._notices.pop(tick, None)
            self._given.pop(tick, None)
        del self._ticks[:done]

    def _fresh(self, tick: int) -> list[Notice]:
        given = self._given.get(tick, [])
        return [n for n in self._notices.get(tick, []) if n not in given]

    def take_notices(self) -> list[Notice]:
        """What was noticed since the last call; folding a tick anew does not repeat what was said of it."""
        self.state()
        taken, self._loose = self._loose, []
        for tick in self._ticks:
            fresh = self._fresh(tick)
            if fresh:
                taken.extend(fresh)
                self._given.setdefault(tick, []).extend(fresh)
        return taken


def _too_late(count: int, lag_s: float) -> str:
    """What is said of a node: a notice takes the place of the one before, so that it counts all so far."""
    came = "1 reading so far came" if count == 1 else f"{count} readings so far came"
    return f"{came} more than {lag_s:g} s late and {'is' if count == 1 else 'are'} not fused"
