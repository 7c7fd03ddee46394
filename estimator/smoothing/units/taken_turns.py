"""A window solved with the frame of a unit turned: taken where it is clearly likelier than without."""

import math
from collections.abc import Callable

import numpy as np
from msgspec.structs import replace

from estimator.fusion.images import turned_about
from estimator.fusion.memory.ledger import CLAIMED
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.robust import mixture_cost
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.smoothing.images.heading_images import drops_along
from estimator.smoothing.keyframes.layout import Walk
from estimator.smoothing.keyframes.walks import HEADING
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.frame_turns import KICKED
from estimator.smoothing.units.mounting_hypotheses import unlearned
from estimator.smoothing.units.suspected_turns import EPSILON_S, Turn

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
    _let_turn(other, walk.number, t, turn.across2)
    as_it_is, turned = build(plain), build(other)
    # A turn says nothing of heights: both cost by the same floors.
    as_it_is.rows.floors = turned.rows.floors = as_it_is.rows.through(solved.x)
    try:
        known = as_it_is.solve(solved.x, iterations=ITERATIONS, resting=resting)
        found = turned.solve(_start(as_it_is, known.x, turn), SLACKS_M, resting=resting)
    except ValueError:
        return None
    gain = known.cost - found.cost - max(_most(as_it_is, known, turned, found, walk) - KICKED, 0.0)
    before, after = layout.states(found.x, turn.of)[turn.keyframe : turn.keyframe + 2, HEADING].tolist()
    if gain < TAKEN or abs(after - before) < LEAST_RAD:
        return None
    state = layout.state
    _let_turn(state, walk.number, t, turn.across2)
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


def _most(one: Problem, as_one: Solution, other: Problem, as_other: Solution, walk: Walk) -> float:
    """What the radio tells that tells most for one solution over another, of those a walk's radio hears."""
    m, pairs = len(one.rows.pairs), one.rows.pairs
    costs = [
        mixture_cost(found.linear.residual[:m], rows.sigma[:m], *rows.noise[:m].T)
        for rows, found in ((one.rows, as_one), (other.rows, as_other))
    ]
    told = np.zeros(len(one.layout.state.owners))
    for own, there in ((2, 3), (3, 2)):
        mine = pairs[:, own] == walk.number
        np.add.at(told, pairs[mine, there].astype(np.intp), (costs[0] - costs[1])[mine])
    return float(told.max())


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


def _let_turn(state: FusionState, number: int, t: float, across2: float) -> None:
    """Let a unit's frame turn by anything right after an epoch (s): a step without displacement or time."""
    at_t, rest = t + EPSILON_S, (0.0, 0.0, 0.0, across2, 0.0, ANYWHERE_RAD**2, 0.0, 0.0, CLAIMED)
    state.ledger.add("steps", at_t, number, at_t, *rest)
