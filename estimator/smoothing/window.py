"""When the window is solved again: as time goes by, as the map bends, or as somebody may be elsewhere.

Between two solutions the filter in `estimator.fusion` folds tick after tick into L and b. Each solution of
the window puts the Kirchhoff matrix of its newest keyframe and of the border in the filter's place, so that
no reading inside the window stays linearised at an estimate that has turned out to be wrong (decision
0006).
"""

import math

from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.unreliable_unit import leads_astray
from estimator.smoothing.images.flip_ambiguity import LIVE, Effort
from estimator.smoothing.window_extent import SHORTEST_S, WORK, spacing_s, work
from estimator.smoothing.window_solution import refresh

PERIOD_S = 8.0
SOONEST_S = 3.0
YOUNG = 0.06
"""A window is solved again when it has grown by this much of its length: what is young still bends."""
BENT_M = 1.0
JOLT_M = 2.0
"""A tick that bends the map by more is not left linearised for seconds: it may be a kicked breadcrumb's."""
CALM = 4.0
"""Periods after which the window is solved again though nothing has bent it."""
SUSPENSE = 0.25
"""Periods after which it is solved again where a breadcrumb may lie elsewhere."""
EXPOSED = 0.5
"""The same where somebody may have gone to an image of where he seems to be."""
TOLD_S, MORE = 8.0, 0.5
"""What is new where headings and units are asked about rarely: so much at least, and this share of what is
known."""


def solve_if_due(state: FusionState, t: float, rarer: float = 1.0, effort: Effort = LIVE) -> None:
    """Solve the window again after a tick if it is due: by time, by how far it has bent, or by suspicion.

    Args:
        state: the fusion, changed in place.
        t: end of the tick (s).
        rarer: how many of its usual periods the window waits where nothing but time has gone by.
        effort: how much is asked of images.
    """
    if state.begun_t is None:
        if not len(state.ledger.table("begins")) and not len(state.ledger.table("stands")):
            return
        state.begun_t = state.refreshed_t = t
    often = rarer == 1.0
    # Whose heading is one of two is looked at as often as who may be at an image.
    turned = any(node.turned and not (node.otherwise and often) for node in state.nodes.values())
    # Where the window is solved rarely, only when there is more to tell.
    told_s = t - state.refreshed_t
    turned = turned and (often or told_s >= max(TOLD_S, MORE * (t - state.begun_t)))
    # What has happened to who is led astray is told by what comes soon after.
    astray = told_s >= max(SOONEST_S, MORE * _astray_s(state, t))
    if not (state.due or turned or astray or state.bent_m > JOLT_M * rarer):
        if state.suspected:
            periods = SUSPENSE
        elif state.exposed and often:
            # Where the window is solved rarely nobody looks: his images are asked about at the end.
            periods = EXPOSED
        else:
            periods = 1.0 if state.bent_m > BENT_M else CALM
        waited_s = (t - state.refreshed_t) / rarer
        # Most ticks come too soon for any window: how much work this one is need not be asked.
        if waited_s < periods * usual_s(state) or waited_s / period_s(state) < periods:
            return
    solve_now(state, t, effort)


def _astray_s(state: FusionState, t: float) -> float:
    """For how long some unit has led its bearer astray (s); infinite: none does."""
    if not any(map(leads_astray, state.nodes.values())):
        state.astray_t = None
        return math.inf
    state.astray_t = t if state.astray_t is None else state.astray_t
    return t - state.astray_t


def solve_now(state: FusionState, t: float, effort: Effort = LIVE) -> None:
    """Solve the window again after a tick, due or not; nothing where nobody has begun yet.

    Args:
        state: the fusion, changed in place.
        t: end of the tick (s).
        effort: how much is asked of images.
    """
    if state.begun_t is None:
        return
    solved_t = state.refreshed_t
    state.due, state.refreshed_t, state.bent_m = False, t, 0.0
    if refresh(state, solved_t, effort=effort) and state.due:
        state.due = False
        refresh(state, t, bent=True, effort=effort)
        # What was bent is rarely straight after one solution.
        state.suspected = True


def solve_for_headings(state: FusionState) -> None:
    """Solve once more after the last tick if a unit's heading is still open."""
    if any(node.turned for node in state.nodes.values()) and state.begun_t is not None:
        refresh(state, state.refreshed_t)


def period_s(state: FusionState) -> float:
    """Time between two solutions (s): short while the window is young, long where it costs much."""
    return usual_s(state) * max(1.0, SHORTEST_S / spacing_s(state) * work(state) / WORK)


def usual_s(state: FusionState) -> float:
    """The same where none costs much (s)."""
    span = state.newest_t - (state.newest_t if state.window_t is None else state.window_t)
    return min(max(YOUNG * span, SOONEST_S), PERIOD_S)
