"""The whole incident solved with everything known: all keyframes at once, from where the first pass got."""

import math
from collections.abc import Sequence

import numpy as np

from estimator.fusion.entering.beginnings import decide
from estimator.fusion.memory.state import FusionState
from estimator.graph.robust import mixture_cost
from estimator.smoothing.back_to_filter import hand_back, keep_keyframes
from estimator.smoothing.changes.branch import branch, reunite
from estimator.smoothing.changes.moved_nodes import moved_nodes
from estimator.smoothing.changes.relocation import GAIN, USUAL_COST, MovedNode
from estimator.smoothing.changes.told_places import believe
from estimator.smoothing.images.alternatives import Mode
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.learning.delays import CLEARER, ODDS, RARE, delays, doubted
from estimator.smoothing.learning.range_noise import learn_ranging
from estimator.smoothing.learning.slips import withdraw
from estimator.smoothing.learning.trusted_radios import distrust, trust_dropped
from estimator.smoothing.learning.unit_noise import learn
from estimator.smoothing.problem.newton import METRES_OFF, RESTING, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.readings.rows import Rows
from estimator.smoothing.told_causes import ask
from estimator.smoothing.units.turned_at_pauses import turned_at_pauses
from estimator.smoothing.units.unit_mounting import likeliest_mounting
from estimator.smoothing.units.unseen_climbs import find_unseen_climb
from estimator.smoothing.window_extent import spacing_s as usual_s

LEARNING = (1.5, 1.0, 0.5)
"""How far the logarithms of noise variances may move, solution by solution."""
LEARNING_RESTING = 1.0
"""What a solution may leave of its log likelihood that is only learned from."""
DELAYS = 3
"""So often is it asked at most which radios are off: each answer may hide another one."""
MOVES = 20
"""So many nodes at most are found elsewhere at a time: each asks for another solution."""
LARGEST = 60_000_000
"""Numbers that the chain may hold: beyond it keyframes are set farther apart."""


def solve_whole(state: FusionState) -> tuple[Problem, Solution, list[Mode]]:
    """Solve everything, learning on the way how noisy each unit is.

    Which breadcrumbs were moved, and then which steps were reported wrongly, is asked again with all that is
    known: the first pass may have taken the one for the other, or a later epoch for that of a kick. Whether a
    technology is calibrated the first pass has judged. The same walls, met again and again for hours, look
    like a scale that is surer and surer.

    Where a radio turns out to be off, everything is solved anew with a bias of its own. Those of breadcrumbs
    are trusted again first: for the first pass, one that was kicked and is then ranged from one side only has
    an antenna delay.

    Args:
        state: the fusion after all readings, with a complete ledger; the solution's may be a copy of it.

    Returns:
        The problem, its solution, and others by how units may be worn.
    """
    sort_by_walk(state)
    again = trust_dropped(state)
    problem, solved = _solved(state)
    for _ in range(DELAYS):
        judged = problem.solve(solved.x, iterations=0)
        other = ask(problem, judged).odds
        asked, rival = delays(problem, judged), other + CLEARER - RARE
        found = doubted([one for one in asked if one.radio in again], max(ODDS, rival))
        found = found or doubted(asked, max(GAIN, rival))
        if not found:
            break
        state = problem.layout.state
        distrust(state, found)
        problem, solved = _solved(state)
    return likeliest_mounting(problem, solved, _problem, RESTING)


def sort_by_walk(state: FusionState) -> None:
    """Put the pairs of one walk behind each other in the ledger, each walk's as they were.

    Walks are summed up one after the other. Were all their readings mixed, as they came, each of a million
    numbers would be waited for by itself.

    Args:
        state: the fusion, whose ledger is changed.
    """
    pairs, begins = state.ledger.table("pairs"), state.ledger.table("begins")
    moving = np.zeros(len(state.owners) + 1, dtype=np.bool_)
    moving[begins[:, 1].astype(np.intp)] = True
    ends = pairs[:, 2:4].astype(np.intp)
    walk = np.where(moving[ends], ends, len(moving)).min(axis=1)
    state.ledger.replace("pairs", pairs[np.argsort(walk, kind="stable")])


def _solved(state: FusionState) -> tuple[Problem, Solution]:
    """The whole incident solved, with the antenna delays that the state knows."""
    withdraw(state)
    believe(state)
    other = state.copy()
    begun = [_initial_solution(state)]
    if reunite(other):
        begun.append(_initial_solution(other))
    placed = max(len(problem.rows.sigma) for problem, _ in begun)
    problem, solved = min(begun, key=lambda one: _misfit(one[0], one[1], placed))
    state, rows = problem.layout.state, problem.rows
    first, *later = LEARNING
    learn(state, problem, solved, _problem, first, kinds=False)
    learn_ranging(state, problem, solved)
    # Where no wall is, what is assumed of it would have a unit's noise explain less than it does.
    rows.learn(state.noise, walls=False)
    for most in later:
        problem = problem.with_units(_layout(state))
        solved = problem.solve(solved.x, iterations=1)
        learn(state, problem, solved, _problem, most, kinds=False)
    problem = _problem(state)
    problem, solved = _with_moved_nodes(problem, problem.solve(solved.x), RESTING)
    # Last, for a node that was moved makes ranges differ like a wall.
    rows, _ = problem.rows.obstructed(solved.x, np.ones(len(problem.rows.t), dtype=np.bool_))
    if not rows.shift.any() and not problem.layout.ranges_lose:
        return problem, solved
    problem = problem.with_rows(rows).with_losses()
    return problem, problem.solve(solved.x)


def _initial_solution(state: FusionState) -> tuple[Problem, Solution]:
    """A first solution to learn noise from, with moved nodes, climbs, turns and mountings found."""
    problem = _problem(state)
    solved = problem.solve(problem.layout.start(), METRES_OFF, resting=LEARNING_RESTING)
    problem, solved = find_unseen_climb(problem, solved, _problem, LEARNING_RESTING)
    problem, solved = turned_at_pauses(problem, solved, _problem, LEARNING_RESTING)
    problem, solved, _ = likeliest_mounting(problem, solved, _problem, LEARNING_RESTING, -math.inf)
    problem, solved = _freed(problem, solved)
    return _with_moved_nodes(problem, solved, LEARNING_RESTING)


def _freed(problem: Problem, solved: Solution) -> tuple[Problem, Solution]:
    """The solution with all that was told wrongly put right: places, and fixes of those who fly."""
    for _ in range(MOVES):
        causes = ask(problem, solved)
        if causes.doubted and not solved.rests:
            solved = problem.solve(solved.x)
            causes = ask(problem, solved)
        state = problem.layout.state
        if not causes.correct(state):
            break
        problem = _problem(state)
        solved = problem.solve(solved.x, METRES_OFF, resting=LEARNING_RESTING)
    return problem, solved


def _misfit(problem: Problem, solved: Solution, most: int) -> float:
    """Cost of a solution over that of a perfect fit, in log likelihood, comparable between placements.

    Each place that it needs is to be worth what it is worth to find one. Readings to a node that it has no
    place for cost what readings usually do: leaving them out is no way to fit them.

    Args:
        problem: of the whole incident.
        solved: its solution.
        most: how many readings others have a place for.
    """
    rows = problem.rows
    at_best = mixture_cost(np.zeros(len(rows.sigma)), rows.sigma, *rows.noise.T)
    unplaced = USUAL_COST * (most - len(rows.sigma))
    return float(solved.cost - at_best.sum() + unplaced + GAIN * len(problem.layout.stands))


def _with_moved_nodes(problem: Problem, solved: Solution, resting: float) -> tuple[Problem, Solution]:
    """Find moved nodes and solve again with each at its new place, until none is found.

    Args:
        problem: of the whole incident.
        solved: its solution with them where they were thought to be.
        resting: see `Problem.solve`.
    """
    for _ in range(MOVES):
        moves, _ = moved_nodes(problem, solved, math.inf)
        if not moves:
            break
        _branch_moved(problem, solved, moves)
        problem = _problem(problem.layout.state)
        solved = problem.solve(problem.layout.start(), METRES_OFF, resting=resting)
    return problem, solved


def _problem(state: FusionState) -> Problem:
    layout = _layout(state)
    rows = Rows(layout, -math.inf)
    rows.learn(state.noise)
    return Problem(layout, rows, None)


def _layout(state: FusionState) -> Layout:
    begins = state.ledger.table("begins")
    since_t = float(begins[:, 0].min()) if len(begins) else state.newest_t
    return Layout(state, since_t, spacing_s(state, since_t, state.newest_t))


def _branch_moved(problem: Problem, solved: Solution, moves: Sequence[MovedNode]) -> None:
    """Branch moved nodes: each begins at its new place, all others as they are in the solution."""
    layout, state = problem.layout, problem.layout.state
    hand_back(state, layout, solved, solved.remainder(layout.length - 1).matrix)
    keep_keyframes(state, layout, solved.x)
    for moved in moves:
        branch(state, moved)
    decide(state, math.inf)


def spacing_s(state: FusionState, since_t: float, until_t: float) -> float:
    """How far apart keyframes stand (s): as near as the whole chain allows."""
    width = 6 * len({row[1] for row in state.ledger.table("begins")})
    border = 3 * len(state.ledger.table("stands")) + 8
    spacing = usual_s(state)
    while (until_t - since_t) / spacing * width * (
        border + 2 * width
    ) > LARGEST and until_t - since_t > spacing:
        spacing *= 2.0
    return spacing
