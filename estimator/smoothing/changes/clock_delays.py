"""By how much ranges are stamped late against their bearers' steps, told by where these turn and stop.

Along a straight way a range that is a second late looks as if its bearer were a metre behind, and fits. Where
he turns or stops it does not: of ways that are the unit's own, but for a time by which ranges are late, one
fits them. What makes a window suspicious is what it does of it: steps that disagree, and outliers.
"""

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
from estimator.smoothing.changes.short_tracks import fit_along_unit, fit_freely
from estimator.smoothing.keyframes.walks import HEADING

EACH_S, MOST_S = 0.5, 4.0
"""Steps in which it is looked for how late ranges are, and how late or early they are at most."""
SPAN_S, SPANS, SPANS_LEAST = 20.0, 4, 2
CLEAR, AGAIN = 12.0, 3.0
"""Log evidence from which on ranges are stamped by another clock, and what a second span says for itself."""
LEAST_S, ALL_S, ASKED_S = 0.4, 5.0, 10.0
"""What is less late is left: it is a step; what is later is another fault; and so often is it asked."""


class ClockDelay(NamedTuple):
    """How late a radio's ranges are.

    Attributes:
        by_s: so much (s).
        good: share of the ranges that agree then, in the span where fewest do; 0: it is no clock.
    """

    by_s: float
    good: float


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
    if hearing.until_t // ASKED_S == solved_t // ASKED_S:
        return found
    for i, walk in enumerate(hearing.problem.layout.walks):
        node = state.life(walk.number)
        if walk.way is None or node.mode != "unit" or node.index != walk.number or node.apart is not None:
            continue
        if not hearing.ill(i, node):
            continue
        late = _late(hearing, i)
        known_s = state.clocks.get(node.node, 0.0)
        if late.good > DISAGREEING and abs(late.by_s) > LEAST_S and abs(known_s + late.by_s) < ALL_S:
            _put_right(state, node, late.by_s)
            found.add(i)
    return found


def _late(hearing: RecentRanges, index: int) -> ClockDelay:
    """By how much a walk's ranges are late, by all that the window tells."""
    layout = hearing.problem.layout
    states, times = layout.states(hearing.solved.x, index), layout.times[:, index]
    spans, led_t = [], max(hearing.led_since(index), layout.walks[index].node.joined_t)
    for span in range(SPANS):
        until_t = hearing.until_t - MOST_S - SPAN_S * span
        heard = hearing.heard(index, until_t - SPAN_S, until_t)
        if heard is not None and until_t - SPAN_S > led_t:
            middle = float(heard.t.mean())
            at = np.array([np.interp(middle, times, states[:, c]) for c in (0, 1, HEADING)])
            spans.append((heard, at[:2], at[2:]))

    if len(spans) < SPANS_LEAST:
        return ON_TIME

    def evidence(late_s: float) -> Array:
        return np.array([fit_along_unit(*span, late_s).evidence for span in spans])

    told = {late_s: evidence(late_s) for late_s in (-1.0, 0.0, 1.0)}
    if told[0.0].sum() >= max(told[-1.0].sum(), told[1.0].sum()):
        return ON_TIME
    others = set(np.arange(-MOST_S, MOST_S + 1.0).tolist()) - told.keys()
    told |= {late_s: evidence(late_s) for late_s in sorted(others)}
    best = max(told, key=lambda late_s: float(told[late_s].sum()))
    told |= {late_s: evidence(late_s) for late_s in (best - EACH_S, best + EACH_S)}
    best = max(told, key=lambda late_s: float(told[late_s].sum()))
    by_s = best
    if best - EACH_S in told and best + EACH_S in told:
        before, here, after = (float(told[best + step_s].sum()) for step_s in (-EACH_S, 0.0, EACH_S))
        by_s += 0.5 * EACH_S * (after - before) / max(2.0 * here - before - after, 1e-9)
    # Walls that are passed make ranges of one span look late, and those of another one early.
    each = np.sort(told[best] - told[0.0])
    gain, again = float(each.sum()), float(each[-2])
    if not (gain > CLEAR and again > AGAIN):
        return ON_TIME
    fits = [(span[0], fit_along_unit(*span, best)) for span in spans]
    # A bad unit is bad at any time: where it is a clock, no way is likelier than the unit's own.
    led = all(fit.evidence > fit_freely(heard, [fit.way_m]).evidence for heard, fit in fits)
    return ClockDelay(by_s, min(fit.good for _, fit in fits) if led else 0.0)


def _put_right(state: FusionState, node: NodeState, late_s: float) -> None:
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
    text = (
        f"ranges of {name} are stamped {abs(known_s):.1f} s {what} against its steps: the clock of a gateway"
        " is off; that is allowed for, set it"
    )
    state.say("conflict", state.newest_t, name, text)
