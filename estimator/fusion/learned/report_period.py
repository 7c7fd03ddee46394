"""How a unit reports that never says since when: at what period, whether also while its bearer stands."""

from typing import NamedTuple, Self

import msgspec

from estimator.estimate import Vector3

SPANS, SPANS_LEAST = 16, 6
"""Times between reports that tell a period, and how many it takes."""
USUAL = 0.8
"""So many of them are whole numbers of periods, of a unit that reports at a period."""
OFF = 0.15
"""How far a whole number of periods may be off, in periods: epochs are rounded, and senders wait."""
WHOLE = 5.0
"""So many periods are still told from one more or less: a period is known to some per cent."""
STANDS = 2
"""So many reports of no way in a row are those of a unit that reports while its bearer stands."""
RECENT_S, RECENT = 4.0, 16
"""What a report may be a copy of is as old, and one of so many."""
PAUSE_S = 10.0
"""No unit that leads anybody reports so seldom: a longer time between two reports is no usual one."""
ODDS_MOST = 7.0
"""No habit is surer than this log odds: units are started anew."""


class Reported(NamedTuple):
    """A report.

    Attributes:
        t: its epoch (s).
        own_s: the time that it tells of (s).
        delta_m: displacement (m).
        heading_rad: the unit's heading; None: not told.
    """

    t: float
    own_s: float
    delta_m: Vector3
    heading_rad: float | None


class Cadence(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """What the reports of a unit that never says since when have shown.

    Attributes:
        spans_s: times between the newest ones (s).
        recent: the newest ones.
        stood: so many of the newest ones in a row told of no way.
        stands: it has reported while its bearer stood.
        losing: log odds that what it walks while none of its reports comes is in none that comes later.
    """

    spans_s: tuple[float, ...] = ()
    recent: tuple[Reported, ...] = ()
    stood: int = 0
    stands: bool = False
    losing: float = 0.0

    @property
    def usual_s(self) -> float | None:
        """The time between two reports without their copies by up to three gateways (s); None: not known."""
        spans_s = sorted(span for span in self.spans_s if span <= PAUSE_S)
        return spans_s[3 * len(spans_s) // 4] if spans_s else None

    @property
    def middle_s(self) -> float | None:
        """The median time between two reports (s): a unit's own, if few are lost. None: not known."""
        return sorted(self.spans_s)[len(self.spans_s) // 2] if self.spans_s else None

    @property
    def period_s(self) -> float | None:
        """The period at which it reports (s), lost ones counted; None: it has none, or none is known yet."""
        if len(self.spans_s) < SPANS_LEAST:
            return None
        period_s = sorted(self.spans_s)[len(self.spans_s) // 6]
        if period_s <= 0.0:
            return None
        whole = sum(is_whole(span / period_s) for span in self.spans_s)
        return period_s if whole >= USUAL * len(self.spans_s) else None

    def after(self, told: Reported, *, still: bool, losing: float = 0.0) -> Self:
        """What is known after another report.

        Args:
            told: the report.
            still: it tells of no way.
            losing: log odds by which it tells that what nothing came of was lost.
        """
        t = told.t
        spans = (*self.spans_s, t - self.recent[-1].t)[-SPANS:] if self.recent else ()
        stood = self.stood + 1 if still else 0
        old = 0
        while old < len(self.recent) and self.recent[old].t < t - RECENT_S:
            old += 1
        recent = (*self.recent[old:], told)[-RECENT:]
        odds = min(max(self.losing + losing, -ODDS_MOST), ODDS_MOST)
        return type(self)(spans, recent, stood, self.stands or stood >= STANDS, odds)


def is_whole(periods: float) -> bool:
    """Whether a time is that of some whole periods: of many, which are not told apart, it always is."""
    return periods > WHOLE or (periods > 1.0 - OFF and abs(periods - round(periods)) <= OFF)
