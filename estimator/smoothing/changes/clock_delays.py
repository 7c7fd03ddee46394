"""By how much ranges are stamped late against their bearers' steps, told by where these turn and stop.

Along a straight way a range that is a second late looks as if its bearer were a metre behind, and fits. Where
he turns or stops it does not: of ways that are the unit's own, but for a time by which ranges are late, one
fits them. What makes a window suspicious is what it does of it: steps that disagree, and outliers; or that
all ranges are stamped in whole seconds, which nothing but rounding does for long.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.clocks import stamped_by
from estimator.graph.dense import Array
from estimator.smoothing.changes.recent_ranges import DISAGREEING, RecentRanges
from estimator.smoothing.changes.short_tracks import RangedUnit, fit_along_unit, fit_freely
from estimator.smoothing.keyframes.walks import HEADING, SCALE

SPAN_S, SPANS = 20.0, 4
"""By so many seconds at a time it is asked, and by so many of these."""
AHEAD_M = (-0.5, -0.25, 0.25, 0.5)
"""So far ahead of its bearer a radio seems to be through his body, who goes on evenly as if it were late."""
ALL_S = 5.0
"""What is later in all is another fault."""


class Search(NamedTuple):
    """What is looked for, and how clear it has to be.

    Attributes:
        each_s: steps in which ranges are tried to be late (s).
        most_s: how late or early they are at most (s).
        least_s: what is less late is left: it is a step (s).
        spans: so many have to tell of it.
        closely: its unit leaves nothing of its way out in them; the newest one may be shorter.
        clear: log evidence from which on ranges are late.
        again: what a second span says for itself, where more than one tells.
        apart: by how much no span may be likelier at a time of its own.
        asked_s: so often is it asked (s).
    """

    each_s: float
    most_s: float
    least_s: float
    spans: int
    closely: bool
    clear: float
    again: float
    apart: float
    asked_s: float

    def due(self, until_t: float, solved_t: float) -> bool:
        """Whether it is asked at the end of a window, after one that ended at `solved_t` (s)."""
        return until_t // self.asked_s != solved_t // self.asked_s


ANOTHER_CLOCK = Search(
    each_s=0.5,
    most_s=4.0,
    least_s=0.4,
    spans=2,
    closely=False,
    clear=12.0,
    again=3.0,
    apart=np.inf,
    asked_s=10.0,
)
ROUNDED = Search(
    each_s=0.25,
    most_s=1.0,
    least_s=0.15,
    spans=1,
    closely=True,
    clear=3.0,
    again=1.0,
    apart=2.0,
    asked_s=5.0,
)
"""By how much stamps of whole seconds were rounded: by any part of one, beforehand each as likely as none.
Odds of twenty to one tell it, and any window is asked, as soon as it can be. What rounding hides stays the
same: where a span is likelier at a time of its own, it is a fault of the unit."""


class ClockDelay(NamedTuple):
    """How late a radio's ranges are.

    Attributes:
        by_s: so much (s).
        good: share of the ranges that agree then, in the span where fewest do; 0: it is no clock.
    """

    by_s: float
    good: float


Span = tuple[RangedUnit, Array, Array]
"""Ranges, about where they were heard, and what the unit faced then."""
ON_TIME = ClockDelay(0.0, 0.0)


def set_clocks(state: FusionState, hearing: RecentRanges, solved_t: float) -> set[int]:
    """Find radios whose ranges are stamped by another clock, and put their readings to where they belong.

    Args:
        state: the fusion, changed in place; where there is one its window is to be solved again.
        hearing: of the window.
        solved_t: when the window was last solved (s).

    Returns:
        The walks of which one was found.
    """
    found: set[int] = set()
    due = [search for search in (ANOTHER_CLOCK, ROUNDED) if search.due(hearing.until_t, solved_t)]
    if not due or not hearing.enough:
        return found
    for i, walk in enumerate(hearing.problem.layout.walks):
        node = state.life(walk.number)
        if walk.way is None or node.mode != "unit" or node.index != walk.number or node.apart is not None:
            continue
        known_s = state.clocks.get(node.node, 0.0)
        for search in due:
            if not _suspect(hearing, i, node, known_s, search):
                continue
            late = _late(hearing, i, search)
            agreed = late.good > DISAGREEING and search.least_s < abs(late.by_s) <= search.most_s
            if agreed and abs(known_s + late.by_s) < ALL_S:
                _put_right(state, node, late.by_s, search)
                found.add(i)
                break
    return found


def _suspect(hearing: RecentRanges, index: int, node: NodeState, known_s: float, search: Search) -> bool:
    return hearing.in_whole_seconds(index, known_s) if search is ROUNDED else hearing.ill(index, node)


def _late(hearing: RecentRanges, index: int, search: Search) -> ClockDelay:
    """By how much a walk's ranges are late, by all that the window tells."""
    each_s, most_s = search.each_s, search.most_s
    layout = hearing.problem.layout
    states, times = layout.states(hearing.solved.x, index), layout.times[:, index]
    spans, led_t = [], max(hearing.led_since(index, search.closely), layout.walks[index].node.joined_t)
    for span in range(SPANS):
        until_t = hearing.until_t - most_s - SPAN_S * span
        since_t = until_t - SPAN_S
        if search.closely and span == 0:
            since_t = max(since_t, led_t)
        heard = hearing.heard(index, since_t, until_t)
        if heard is not None and since_t >= led_t:
            middle = float(heard.t.mean())
            at = np.array([np.interp(middle, times, states[:, c]) for c in (0, 1, HEADING, SCALE)])
            spans.append((heard.stretched(1.0 + float(at[3])), at[:2], at[2:3]))

    if len(spans) < search.spans:
        return ON_TIME

    def evidence(late_s: float) -> Array:
        return np.array([fit_along_unit(*span, late_s).evidence for span in spans])

    coarse_s = 2.0 * each_s
    told = {late_s: evidence(late_s) for late_s in (-coarse_s, 0.0, coarse_s)}
    if told[0.0].sum() >= max(told[-coarse_s].sum(), told[coarse_s].sum()):
        return ON_TIME
    others = set(np.arange(-most_s, most_s + each_s, coarse_s).tolist()) - told.keys()
    told |= {late_s: evidence(late_s) for late_s in sorted(others)}
    best = max(told, key=lambda late_s: float(told[late_s].sum()))
    told |= {late_s: evidence(late_s) for late_s in (best - each_s, best + each_s)}
    best = max(told, key=lambda late_s: float(told[late_s].sum()))
    by_s = best
    if best - each_s in told and best + each_s in told:
        before, here, after = (float(told[best + step_s].sum()) for step_s in (-each_s, 0.0, each_s))
        by_s += 0.5 * each_s * (after - before) / max(2.0 * here - before - after, 1e-9)
    # Walls that are passed make ranges of one span look late, and those of another one early.
    each = np.sort(told[best] - told[0.0])
    gain, again = float(each.sum()), float(each[-2]) if len(each) > 1 else np.inf
    apart = max(np.max([one[span] for one in told.values()]) - told[best][span] for span in range(len(spans)))
    if not (gain > search.clear and again > search.again and apart < search.apart):
        return ON_TIME
    if max(_worn(spans, ahead_m) for ahead_m in AHEAD_M) >= float(told[best].sum()):
        return ON_TIME
    fits = [(span[0], fit_along_unit(*span, best)) for span in spans]
    # A bad unit is bad at any time: where it is a clock, no way is likelier than the unit's own.
    led = all(fit.evidence > fit_freely(heard, [fit.way_m]).evidence for heard, fit in fits)
    return ClockDelay(by_s, min(fit.good for _, fit in fits) if led else 0.0)


def _worn(spans: Sequence[Span], ahead_m: float) -> float:
    """Evidence where ranges are on time, and what bodies do makes them seem otherwise."""
    fits = [fit_along_unit(heard.worn(ahead_m), at_m, turn_rad) for heard, at_m, turn_rad in spans]
    return sum(fit.evidence for fit in fits)


def _put_right(state: FusionState, node: NodeState, late_s: float, search: Search) -> None:
    """Let a radio's readings count from earlier by so much; what was thought of its unit is undone."""
    name, known_s = node.node, state.clocks.get(node.node, 0.0) + late_s
    state.clocks[name] = known_s
    pairs, steps = state.ledger.table("pairs").copy(), state.ledger.table("steps")
    ends = np.unique(pairs[pairs[:, 1] <= RSSI][:, 2:4].astype(np.intp), axis=0)
    for a, b in ends.tolist():
        if node.index in (a, b) and stamped_by(state.owners[a], state.owners[b], state.nodes) == name:
            mine = (pairs[:, 1] <= RSSI) & (pairs[:, 2] == a) & (pairs[:, 3] == b)
            pairs[mine, 0] -= late_s
    state.ledger.replace("pairs", pairs[np.argsort(pairs[:, 0], kind="stable")])
    slipped = (steps[:, 1] == node.index) & (steps[:, 0] == steps[:, 2]) & (steps[:, 6] == physics.SLIP_M**2)
    state.ledger.replace("steps", steps[~slipped])
    state.keep(replace(node, walk_factors=(1.0, 1.0)))
    state.due = True
    what = "late" if known_s > 0.0 else "early"
    off = f"{abs(known_s):.1f} s {what} against its steps"
    if search is ROUNDED:
        text = f"ranges of {name} are stamped in whole seconds, {off}: that is allowed for, let it tell parts"
        state.say("conflict", state.newest_t, name, text, once=f"whole seconds of {name}")
        return
    text = f"ranges of {name} are stamped {off}: the clock of a gateway is off; that is allowed for, set it"
    state.say("conflict", state.newest_t, name, text)
