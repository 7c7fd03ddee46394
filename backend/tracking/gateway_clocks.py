"""Whose clock is behind: told by newest epochs that are as old as before whenever they come."""

from collections.abc import Iterator, Mapping, Sequence

import msgspec

from backend.live.record import ClockOf, RecordClock
from backend.log.base import LoggedBatch
from estimator.measurements import Alarm, AnyReading

BEHIND_S = 20.0
"""No radio link takes so long batch after batch, and whoever is heard by it is shown as stale by then."""

SPAN_S = 10.0
"""Of so long the least counts: one batch that was sent again after seconds tells nothing of the clock."""

STEADY_S = 2.0
"""What a gateway has held back comes faster than it was measured, and is less old from one span to the next;
what a clock is behind by stays."""

KEPT = 64
"""A gateway that makes up names fills no more than this."""


class GatewayClock(msgspec.Struct):
    """How old the newest epochs of one gateway's batches are when they come.

    Attributes:
        t: when the newest batch came, by the incident's clock, Unix seconds.
        began: the same of the first batch of the span that goes on.
        least_s: the least that a newest epoch of this span was behind (s).
        before_s: the same of the span before (s); None: there is none since one was not behind.
        behind_s: by how much its clock is behind (s); None: it is not, or not for long enough.
        clock_of: whose clock it is: the gateway's, but where it has told rightly when it sent, its units'.
    """

    t: float
    began: float
    least_s: float
    before_s: float | None = None
    behind_s: float | None = None
    clock_of: ClockOf = "gateway"

    def hear(self, came_t: float, late_s: float, sent_late_s: float | None) -> None:
        """Take note of a batch.

        Args:
            came_t: when it came, Unix seconds.
            late_s: by how much its newest epoch lies before that (s).
            sent_late_s: the same of when it was sent, as the gateway says (s); None: it does not say.
        """
        self.t = came_t
        if late_s < BEHIND_S:
            self.before_s = self.behind_s = None
            self.began, self.least_s = came_t, late_s
        elif came_t < self.began + SPAN_S:
            self.least_s = min(self.least_s, late_s)
        else:
            steady = self.before_s is not None and abs(self.least_s - self.before_s) <= STEADY_S
            self.behind_s = float(round(self.least_s)) if steady else None
            own = sent_late_s is None or sent_late_s >= BEHIND_S
            self.clock_of = "gateway" if own else "units"
            self.before_s = self.least_s if self.least_s >= BEHIND_S else None
            self.began, self.least_s = came_t, late_s


def after_batch(
    before: Mapping[str, GatewayClock], batch: LoggedBatch, readings: Sequence[AnyReading], came_t: float
) -> dict[str, GatewayClock]:
    """The clocks of gateways after a batch of one of them.

    Args:
        before: the same before it, by gateway, the longest silent first.
        batch: what came.
        readings: of it, by the incident's clock; alarms tell nothing, their epochs are changed.
        came_t: when it came, by the incident's clock, Unix seconds.
    """
    after = dict(before)
    epochs = [reading.until_t for reading in readings if not isinstance(reading, Alarm)]
    if not epochs:
        return after
    late_s = came_t - max(epochs)
    clock = after.pop(batch.gateway, None) or GatewayClock(t=came_t, began=came_t, least_s=late_s)
    clock.hear(came_t, late_s, None if batch.sent is None else batch.received - batch.sent)
    after[batch.gateway] = clock
    for gateway in list(after)[:-KEPT]:
        del after[gateway]
    return after


def behind(clocks: Mapping[str, GatewayClock]) -> Iterator[RecordClock]:
    """The clocks that are behind."""
    for gateway, clock in clocks.items():
        if clock.behind_s is not None:
            yield RecordClock(gateway=gateway, t=clock.t, behind_s=clock.behind_s, clock_of=clock.clock_of)
