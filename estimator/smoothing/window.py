"""The window: recent keyframes solved again as estimates move, before they are marginalised.

Between two solutions the filter in `estimator.fusion` folds tick after tick into L and b. Each solution of
the window puts the Kirchhoff matrix of its newest keyframe and of the border in the filter's place, so that
no reading inside the window stays linearised at an estimate that has turned out to be wrong (decision
0006).
"""

from collections.abc import Collection
from functools import partial

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.beginnings import decide
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.back_to_filter import hand_back, keep_keyframes
from estimator.smoothing.changes.branch import branch
from estimator.smoothing.changes.changed_links import changed_links
from estimator.smoothing.changes.clock_delays import set_clocks
from estimator.smoothing.changes.duplicate_names import tell_duplicate_names
from estimator.smoothing.changes.moved_nodes import moved_nodes
from estimator.smoothing.changes.recent_ranges import RecentRanges
from estimator.smoothing.changes.separated_units import find_separated_units
from estimator.smoothing.images.alternatives import alternatives_now
from estimator.smoothing.images.heading_images import reports_from, to_other_sides
from estimator.smoothing.images.heard_radios import heard_by
from estimator.smoothing.images.image_starts import SAME_RAD
from estimator.smoothing.images.likeliest_image import likeliest_image
from estimator.smoothing.images.solutions import SLACKS_M
from estimator.smoothing.images.turned_frames import may_have_turned, turned_frames
from estimator.smoothing.images.unit_mounting import likeliest_mounting
from estimator.smoothing.images.unseen_climbs import find_unseen_climb, hinted
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.learning.unit_noise import learn
from estimator.smoothing.problem.gauge_turn import turned
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.readings.rows import Rows
from estimator.smoothing.told_causes import NONE, ask
from estimator.smoothing.window_extent import (
    LONGEST_S,
    SHORTEST_S,
    STEPS_S,
    WORK,
    restart,
    spacing_s,
    trim,
    work,
)

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
GONE = 8.0
"""A window this many times as long as it may be is begun anew."""
TOLD_S, MORE = 8.0, 0.5
"""What is new where headings are asked about rarely: so much at least, and this share of what is known."""
ITERATIONS = 8
"""Most windows rest after two or three steps. Among walls little holds a map: left after four, one was 17 m
off where it would have rested 9 m off."""
RESTING = 0.1
"""A window that gains less in log likelihood is solved again soon anyway."""


def solve_if_due(state: FusionState, t: float, rarer: float = 1.0) -> None:
    """Solve the window again after a tick if it is due: by time, by how far it has bent, or by suspicion.

    Args:
        state: the fusion, changed in place.
        t: end of the tick (s).
        rarer: how many of its usual periods the window waits where nothing but time has gone by.
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
    if not (state.due or turned or state.bent_m > JOLT_M * rarer):
        if state.suspected:
            periods = SUSPENSE
        elif state.exposed and often:
            # Where the window is solved rarely nobody looks: his images are asked about at the end.
            periods = EXPOSED
        else:
            periods = 1.0 if state.bent_m > BENT_M else CALM
        waited_s = (t - state.refreshed_t) / rarer
        # Most ticks come too soon for any window: how much work this one is need not be asked.
        if waited_s < periods * SOONEST_S or waited_s / period_s(state) < periods:
            return
    solve_now(state, t)


def solve_now(state: FusionState, t: float) -> None:
    """Solve the window again after a tick, due or not; nothing where nobody has begun yet.

    Args:
        state: the fusion, changed in place.
        t: end of the tick (s).
    """
    if state.begun_t is None:
        return
    solved_t = state.refreshed_t
    state.due, state.refreshed_t, state.bent_m = False, t, 0.0
    if refresh(state, solved_t) and state.due:
        state.due = False
        refresh(state, t)
        # What was bent is rarely straight after one solution.
        state.suspected = True


def solve_for_headings(state: FusionState) -> None:
    """Solve once more after the last tick if a unit's heading is still open."""
    if any(node.turned for node in state.nodes.values()) and state.begun_t is not None:
        refresh(state, state.refreshed_t)


def refresh(state: FusionState, solved_t: float) -> bool:
    """Solve the window again, and go on from its solution.

    Args:
        state: the fusion, changed in place.
        solved_t: when it was last solved (s).

    Returns:
        False where it has none: the filter goes on as it was.
    """
    ledger = state.ledger
    since = state.window_t
    if since is None:
        firsts = [rows[:, 0].min() for rows in (ledger.table("begins"), ledger.table("stands")) if len(rows)]
        since = state.window_t = float(min(firsts))
    if state.newest_t - since > GONE * LONGEST_S:
        restart(state)
        return False
    try:
        begun = _problem(state, since)
        start = _solved(begun, begun.layout.start(), solved_t)
        if hinted(begun, start):
            begun, start = find_unseen_climb(begun, start, partial(_problem, since=since), RESTING)
        begun, start = turned_frames(begun, start, partial(_problem, since=since), RESTING)
        begun, start, others = likeliest_mounting(
            begun, start, partial(_problem, since=since), RESTING, solved_t
        )
        layout, judged = begun.layout, likeliest_image(begun, start)
        problem, solved, modes, state.exposed, asked = judged
        trimmed = trim(problem, solved)
        left = solved.chain.remainder(layout.length - 1)
        left = turned(left, layout, problem.pivot_m, problem.first(solved.x), solved.x)
        hand_back(state, layout, solved, left.matrix)
        for name, images in alternatives_now(layout, solved.x, [*modes, *others]).items():
            state.nodes[name] = replace(state.nodes[name], otherwise=images)
        causes = ask(problem, solved) if solved.rests else NONE
        if solved.rests:
            causes.doubt(state)
        found = learn(state, problem, solved, other=causes.odds)
        hearing = RecentRanges(problem, solved)
        find_separated_units(state, hearing, set_clocks(state, hearing, solved_t))
        tell_duplicate_names(state, hearing)
        _judge_turns(problem, solved, found, asked)
        _tell_changes(state, problem, solved)
    except ValueError as error:
        text = f"the last minutes could not be solved again, positions go on without: {error}"
        state.say("unsolved", state.newest_t, None, text)
        return False
    keep_keyframes(state, layout, solved.x)
    state.prior = problem.prior
    if trimmed is not None:
        state.prior, state.window_t = trimmed
        ledger.forget(state.window_t, ("pairs", "singles", "drops", "poses"))
        ledger.forget(state.window_t - STEPS_S, ("steps",))
    # Where one is likely to be wrong, look again soon which one.
    state.suspected = state.suspected or causes.wrong or may_have_turned(state)
    causes.correct(state)
    return True


def period_s(state: FusionState) -> float:
    """Time between two solutions (s): short while the window is young, long where it costs much."""
    span = state.newest_t - (state.newest_t if state.window_t is None else state.window_t)
    usual = min(max(YOUNG * span, SOONEST_S), PERIOD_S)
    return usual * max(1.0, SHORTEST_S / spacing_s(state) * work(state) / WORK)


def _problem(state: FusionState, since: float) -> Problem:
    layout = Layout(state, since, spacing_s(state), state.prior)
    rows = Rows(layout, since)
    rows.learn(state.noise)
    return Problem(layout, rows, state.prior)


def _solved(problem: Problem, x: Array, solved_t: float) -> Solution:
    """The likelier solution of two starts: the filter's estimate, and the units' dead reckoning.

    The filter may have turned the map, of which what was solved before knows nothing: the kink between the
    two can bend everything, and turn the map further with each solution.

    A reading that has led the filter far away lies between keyframes that know nothing of it and those that
    do: it is held against a start that is as unsure as that, or it would be an outlier for ever.

    Args:
        problem: of the window.
        x: where the filter has led to, flat.
        solved_t: when the window was last solved (s).
    """
    free = any(walk.way is None for walk in problem.layout.walks)
    slacks = SLACKS_M if free else ()
    kinked = problem.going.kinked(x, physics.TICK_S)
    solved = problem.solve(x, slacks, len(slacks) + ITERATIONS, RESTING, kinked)
    reckoned = problem.going.reckoned(x, solved_t)
    if problem.at(reckoned).cost >= solved.cost:
        return solved
    other = problem.solve(reckoned, slacks, len(slacks) + ITERATIONS, RESTING)
    return min(solved, other, key=lambda found: found.cost)


def _tell_changes(state: FusionState, problem: Problem, solved: Solution) -> None:
    """Tell of links that have changed, and of nodes that lie elsewhere, which begin anew."""
    for link in changed_links(problem):
        pair = sorted((link.a, link.b))
        text = f"the link between {pair[0]} and {pair[1]} changed by {link.change_db:+.0f} dB for good"
        state.say("link_changed", link.t, pair[0], text, once=f"link {pair[0]} {pair[1]}")
    moves, state.suspected = moved_nodes(problem, solved)
    if moves and not solved.rests:
        # What a solution has left undone is no breadcrumb's fault: it is asked again at rest.
        rested = problem.solve(solved.x)
        moves, state.suspected = moved_nodes(problem, rested)
        state.due = True
    for moved in moves:
        branch(state, moved)
        state.due = True
    decide(state)


def _judge_turns(problem: Problem, solved: Solution, found: Array, asked: Collection[int]) -> None:
    """Mark units whose heading is found, so that turns of it are no longer tried; and those open again."""
    layout = problem.layout
    for i, walk in enumerate(layout.walks):
        node = layout.state.life(walk.number)
        sigma = float(np.sqrt(max(found[walk.last, i, 3, 3], 0.0)))
        one_of_two = any(other.image.turned_rad != 0.0 for other in node.otherwise)
        sure = sigma < physics.TURNED_SIGMA_RAD and not one_of_two
        if one_of_two and not node.turned:
            layout.state.keep(replace(node, turned=True))
        if node.turned and sure and i in asked and not _in_line(problem, solved, i):
            layout.state.keep(replace(node, turned=False))


def _in_line(problem: Problem, solved: Solution, index: int) -> bool:
    """Whether a unit's way lies along the lines to all its radios: its mirror image is the same so far."""
    layout = problem.layout
    walk, way_m = layout.walks[index], layout.states(solved.x, index)[:, :2]
    sides = to_other_sides(heard_by(problem, solved, walk), way_m, walk, reports_from(layout, index))
    return bool(sides) and all(abs(within_pi(by_rad)) < SAME_RAD for by_rad in sides)
