"""Late and out-of-order readings: the filter is rolled back to before them and folds again.

Of a reading that comes later than the lag nothing is fused, but what an introduction says of a node for good
(decision 0104).

The estimates are a function of the set of readings inside the lag, not of the order in which they arrived:
each tick is folded from the state before it and its own readings in canonical order. Folding happens when
something is asked for, so many batches cost one pass.

Where late readings go on coming, this would be the work of a whole lag each second. Then what is shown is
folded in a hurry, and the sure chain follows behind them (decision 0052): a function of the log all the same.
It follows once the picture has been told (decision 0111); while nothing comes it goes ahead (decision 0114).
"""

import math
from bisect import bisect_left, insort
from collections.abc import Sequence
from operator import itemgetter
from typing import Self

import msgspec

from estimator.estimate import Notice
from estimator.fusion.canonical_order import tick_of
from estimator.fusion.holding import names_of
from estimator.fusion.memory.state import FusionState
from estimator.inertial.samples import AnyFolded, Samples, in_pieces
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Awaited
from estimator.measurements.node import LateNode, Node
from estimator.smoothing.images.flip_ambiguity import HURRIED
from estimator.trackers.catch_up import PROMPT_TICKS, CatchUp
from estimator.trackers.chain import Chain, hurried
from estimator.trackers.first_reports import FirstReports
from estimator.trackers.lag_record import LagRecord, Leap
from estimator.trackers.late_readings import too_late

LEAPS_KEPT = 8


class Lag:
    """Readings of the last `lag_s` in ticks, and states of the filter to roll back to.

    Attributes:
        lag_s: readings later than this behind the newest epoch are counted, not fused (s).
        newest_t: newest epoch so far, but none that was still to come; None before the first reading.
        too_late: readings that came too late; of introductions the tracker takes what they say for good.
        received: all readings.
        late: of those that came too late, how many name each node first.
        leaps: the newest leaps of the newest epoch.
    """

    def __init__(self, lag_s: float, state: FusionState) -> None:
        self.lag_s = lag_s
        self.newest_t: float | None = None
        self.too_late = 0
        self.received = 0
        self.late: dict[str, int] = {}
        self.leaps: list[Leap] = []
        self._ticks: list[int] = []
        self._readings: dict[int, list[AnyFolded]] = {}
        self._sure = Chain([(-1, state)])
        self._hurry = CatchUp()
        self._first = FirstReports()
        self._shown: Chain | None = None
        self._behind = False
        self._notices: dict[int, list[Notice]] = {}
        self._given: dict[int, list[Notice]] = {}
        self._loose: list[Notice] = []

    @classmethod
    def of(cls, lag_s: float, record: LagRecord, states: Sequence[FusionState]) -> Self:
        """The lag that a record and its states were made of."""
        lag = cls(lag_s, states[0])
        lag.newest_t, lag.too_late, lag.received = record.newest_t, record.too_late, record.received
        lag.late, lag.leaps = dict(record.late), list(record.leaps)
        lag._ticks = [tick for tick, _ in record.readings]
        lag._readings = {tick: list(readings) for tick, readings in record.readings}
        first = len(record.checkpoints)
        lag._sure = Chain(list(zip(record.checkpoints, states[:first], strict=True)))
        lag._hurry, lag._first = record.hurry, record.first
        if record.shown:
            lag._shown = Chain(list(zip(record.shown, states[first:], strict=True)), HURRIED)
        lag._notices, lag._given, lag._loose = record.notices, record.given, record.loose
        return lag

    def record(self) -> tuple[LagRecord, list[FusionState]]:
        """A record of everything, and the states that belong to it, at most two of each chain."""
        self._ask_all()
        sure, shown = self._sure.ends(), [] if self._shown is None else self._shown.ends()
        record = LagRecord(
            self.newest_t,
            self.too_late,
            self.received,
            [(tick, list(self._readings[tick])) for tick in self._ticks],
            [tick for tick, _ in sure],
            self._notices,
            self._given,
            self._loose,
            dict(self.late),
            list(self.leaps),
            msgspec.structs.replace(self._hurry),
            FirstReports(dict(self._first.since_t)),
            [tick for tick, _ in shown],
        )
        return record, [state for _, state in (*sure, *shown)]

    def add(self, readings: Sequence[AnyReading], known_t: float = math.inf) -> None:
        """Take readings in; of those beyond the lag introductions are late, others are counted and noticed.

        Args:
            readings: in any order of epochs.
            known_t: when they came, by a clock that can be trusted (s): by no later epoch others are late.
        """
        self._follow()
        missed: dict[str, AnyFolded] = {}
        room: tuple[int, int] | None = None
        tick = 0
        together_t, together = math.nan, list[AnyFolded]()
        self.received += len(readings)
        in_order = [(r.until_t, r) for r in in_pieces(readings)]
        in_order.sort(key=itemgetter(0))
        for until_t, reading in in_order:
            self._hurry.meet(reading)
            if until_t == together_t:
                # What goes for the one before goes for all of its epoch.
                together.append(reading)
                self._hurry.hear(names_of(reading)[0], tick)
                continue
            if self.newest_t is not None and until_t < self.newest_t - self.lag_s:
                if isinstance(reading, Node):
                    self._take_late(reading, self.newest_t)
                elif not isinstance(reading, Samples) or reading.last:
                    node = names_of(reading)[0]
                    self.too_late += 1
                    self.late[node] = self.late.get(node, 0) + 1
                    missed[node] = reading
                    if self._ticks and self._hurry.foresee(node, tick_of(until_t), self._ticks[-1]):
                        # What was folded since, with windows of all that is asked, would be folded anew.
                        self._sure.roll_back(self._hurry.since + 1)
                continue
            tick, now = tick_of(until_t), tick_of(self._go_on(reading, until_t, known_t))
            if room != (tick, now):
                room = tick, now
                self._make_room(tick, now)
            together_t, together = until_t, self._readings[tick]
            together.append(reading)
            self._hurry.hear(names_of(reading)[0], tick)
        for awaited in self._first.awaited(readings):
            self._await(awaited)
        for node, newest in missed.items():
            text = too_late(self.late[node], self.lag_s, self.leaps, newest.until_t)
            self._loose.append(Notice(code="too_late", t=newest.t, node=node, text=text))

    def _await(self, awaited: Awaited) -> None:
        """Have it known when a unit's first report began that it was to come; it makes no reading late."""
        if self.newest_t is not None and awaited.t >= self.newest_t - self.lag_s:
            tick = tick_of(awaited.t)
            self._make_room(tick, tick_of(self.newest_t), late=False)
            self._readings[tick].append(awaited)

    def _take_late(self, reading: Node, now_t: float) -> None:
        """Take an introduction that came too late as of the oldest epoch that can still be folded."""
        late = LateNode.of(reading, now_t - self.lag_s)
        tick = tick_of(late.t)
        self._make_room(tick, tick_of(now_t))
        self._readings[tick].append(late)

    def _go_on(self, reading: AnyFolded, until_t: float, known_t: float) -> float:
        """Let the newest epoch be no older than that of a reading (s), note where it leaps, and return it.

        Where it is no later than a clock that can be trusted, nobody is to blame for a leap: time has passed.
        """
        before_t, t = self.newest_t, min(until_t, known_t)
        if before_t is not None and t <= before_t:
            return before_t
        if math.isinf(known_t) and (before_t is None or t > before_t + self.lag_s):
            self.leaps.append(Leap(names_of(reading)[0], before_t, t))
            del self.leaps[:-LEAPS_KEPT]
        self.newest_t = t
        return t

    def _make_room(self, tick: int, now: int, late: bool = True) -> None:
        """Roll back to before a tick that readings are of, where they come late, and make it one of those.

        Args:
            tick: of the readings.
            now: tick of incident time, with them.
            late: where they are, what is folded anew counts towards a hurry.
        """
        newest = self._ticks[-1] if self._ticks else tick
        self._hurry.advance(now, max(newest, tick))
        if not late or self._hurry.note_reading(tick, newest) or not self._hurry.hurrying:
            self._shown = None
        self._sure.roll_back(tick)
        if self._shown is not None:
            self._shown.roll_back(tick)
        if tick not in self._readings:
            self._readings[tick] = []
            insort(self._ticks, tick)

    def state(self) -> FusionState:
        """The filter after all readings so far; not to be changed.

        In a hurry the sure chain is left behind, so that nobody waits for it.
        """
        hurry = self._hurry
        if hurry.hurrying and self._shown is None:
            self._extend(self._sure, hurry.since)
            ticks = self._after(hurry.since, hurry.until)
            self._shown = hurried(self._sure, ticks, self._readings, self._notices)
        self._behind = True
        if self._shown is None:
            self._follow()
            return self._sure.state
        self._extend(self._shown)
        return self._shown.state

    def _follow(self) -> None:
        """Let the sure chain follow as far as it goes, where something was asked since it last did."""
        if self._behind:
            self._behind = False
            self._extend(self._sure, self._hurry.front)
            self._commit()

    def _ask_all(self) -> None:
        """Have all folded that can be."""
        self.state()
        self._follow()

    def settle(self) -> bool:
        """Fold the next tick of what `settled` tells, but none that may change any second now.

        The sure chain has it before its turn, unless something comes late.

        Returns:
            There is another one; False where there is no hurry.
        """
        self._ask_all()
        if not self._hurry.hurrying:
            return False
        ticks = self._unsettled(self._ticks[-1] - PROMPT_TICKS)
        for tick in ticks[:1]:
            self._sure.fold_ahead(tick, self._readings[tick])
        return len(ticks) > 1

    def settled(self) -> FusionState | None:
        """What `state` would be if there were no hurry, which goes on; None: there is none."""
        self._ask_all()
        if not self._hurry.hurrying:
            return None
        for tick in self._unsettled():
            self._sure.fold_ahead(tick, self._readings[tick])
        return self._sure.ahead[-1][1] if self._sure.ahead else self._sure.state

    def _unsettled(self, until: int | None = None) -> list[int]:
        """The ticks that the sure chain has not folded, before their turn or not, up to one of them."""
        ahead = self._sure.ahead
        return self._after(ahead[-1][0] if ahead else self._sure.folded, until)

    def _extend(self, chain: Chain, until: int | None = None) -> None:
        """Fold on to a tick, with it, or to the newest one."""
        chain.extend(self._after(chain.folded, until), self._readings, self._notices)

    def _after(self, tick: int, until: int | None = None) -> list[int]:
        end = len(self._ticks) if until is None else bisect_left(self._ticks, until + 1)
        return self._ticks[bisect_left(self._ticks, tick + 1) : end]

    def _commit(self) -> None:
        """Forget readings that nothing can come before any more, and the checkpoints under them."""
        if self.newest_t is None:
            return
        horizon = tick_of(self.newest_t - self.lag_s)
        checkpoints = self._sure.checkpoints
        base = bisect_left(checkpoints, horizon, key=lambda c: c[0]) - 1
        if base <= 0:
            return
        del checkpoints[:base]
        done = bisect_left(self._ticks, checkpoints[0][0] + 1)
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
        self._ask_all()
        taken, self._loose = self._loose, []
        for tick in self._ticks:
            fresh = self._fresh(tick)
            if fresh:
                taken.extend(fresh)
                self._given.setdefault(tick, []).extend(fresh)
        return taken
