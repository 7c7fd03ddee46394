"""A window solved with the frame of a unit turned: taken where it is clearly likelier than without."""

import math
from collections.abc import Callable

import numpy as np
from msgspec.structs import replace

from estimator.fusion.images import turned_about
from estimator.fusion.memory.ledger import CLAIMED, own_rows
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.smoothing.images.heading_images import drops_along
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import HEADING
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.agreeing_ranges import ranges_agree
from estimator.smoothing.units.frame_turns import KICKED
from estimator.smoothing.units.mounting_hypotheses import unlearned
from estimator.smoothing.units.suspected_turns import EPSILON_S, Turn
from estimator.smoothing.units.told_most import told_most

TAKEN, LEAST_RAD = 9.0, 0.5
"""Log likelihood of both solutions from which on a turn is taken: of those that fit best, among all moments
and angles; and how far the solution has it turn at least."""
SLACKS_M, ITERATIONS = (3.0, 0.5, 0.1), 8


def take_turn(
    problem: Problem, solved: Solution, turn: Turn, build: Callable[[FusionState], Problem], resting: float
) -> tuple[Problem, Solution] | None:
    """The window with a unit's frame turned; None: that is not clearly likelier than as it is.

    Args:
        problem: of a window; where the turn is taken, its state is told so.
        solved: its solution.
        turn: of the frame.
        build: makes the same problem of another state.
        resting: see `Problem.solve`.
    """
    layout, walk = problem.layout, problem.layout.walks[turn.of]
    plain = unlearned(layout.state)
    other = plain.copy()
    t = float(layout.times[turn.keyframe, turn.of])
    let_turn(other, walk.number, t, turn.across2)
    as_it_is, turned = build(plain), build(other)
    # A turn says nothing of heights: both cost by the same floors.
    as_it_is.rows.floors = turned.rows.floors = as_it_is.rows.through(solved.x)
    try:
        known = as_it_is.solve(solved.x, iterations=ITERATIONS, resting=resting)
        found = turned.solve(_start(as_it_is, known.x, turn), SLACKS_M, resting=resting)
    except ValueError:
        return None
    gain = known.cost - found.cost - max(told_most(as_it_is, known, turned, found, walk) - KICKED, 0.0)
    headings = layout.states(found.x, turn.of)[:, HEADING]
    before, after = float(headings[_last_told(layout, turn)]), float(headings[turn.keyframe + 1])
    agree = ranges_agree(turned, found, walk.number, t)
    if gain < TAKEN or abs(after - before) < LEAST_RAD or not agree:
        return None
    state = layout.state
    let_turn(state, walk.number, t, turn.across2)
    # What was learned a wrong way has made.
    node, state.noise = state.life(walk.number), {}
    state.keep(replace(node, walk_factors=(1.0, 1.0), rival=None, detours=(), power_cost=math.inf))
    state.due = True
    text = f"the unit of {node.node} faces elsewhere than it did, by {round(math.degrees(after - before))}°"
    state.say(
        "unit_changed", state.newest_t, node.node, f"{text}: it began anew, or {node.node} walks backwards"
    )
    anew = build(state)
    return anew, anew.solve(found.x, resting=resting)


def _last_told(layout: Layout, turn: Turn) -> int:
    """The last keyframe before a turn by which its unit had told all of its way: it may have turned since."""
    walk, t = layout.walks[turn.of], float(layout.times[turn.keyframe, turn.of])
    ends = own_rows(layout.state.ledger.table("steps"), walk.number)[:, 0]
    told_t = ends[ends <= t].max(initial=-math.inf)
    times = layout.times[walk.first : turn.keyframe + 1, turn.of]
    return walk.first + max(int(np.searchsorted(times, told_t, side="right")) - 1, 0)


def _start(problem: Problem, x: Array, turn: Turn) -> Array:
    """An estimate with a way turned after a keyframe, flat, and all that was dropped along it."""
    layout, walk, there = problem.layout, problem.layout.walks[turn.of], x.copy()
    states = layout.states(there, turn.of)
    image = turned_about(states[turn.keyframe, :2].copy(), turn.by_rad)
    later = states[turn.keyframe + 1 : walk.last + 1]
    later[:, :2] = image.of(later[:, :2])
    later[:, HEADING] += turn.by_rad
    drops_along(layout, there, walk, image, turn.keyframe)
    return there


def let_turn(state: FusionState, number: int, t: float, across2: float) -> None:
    """Let a unit's frame turn by anything right after an epoch: a step without displacement or time.

    Args:
        state: the fusion, whose ledger takes it.
        number: of the unit's node in the ledger.
        t: the epoch (s).
        across2: variance of where its bearer is by when exactly that was (m²).
    """
    at_t, rest = t + EPSILON_S, (0.0, 0.0, 0.0, across2, 0.0, ANYWHERE_RAD**2, 0.0, 0.0, CLAIMED)
    state.ledger.add("steps", at_t, number, at_t, *rest)
