"""Who has climbed unseen: heights that neither a unit nor anything else measures, but distances tell.

Where all lie in one plane no distance tells up from down, so no step of a solution leads out of it, however
much too long distances are. So a solution with heights is sought from a little above.
"""

from collections.abc import Callable, Collection, Sequence

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RANGE, own_rows
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.steps import CLIMB_M2_PER_M
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import FLOOR, VARIANCES
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.held_heights import UP, height_costs
from estimator.smoothing.units.marginal_cost import MarginalCost, marginal_cost

OFF_PLANE_M = 0.3
"""Far enough for distances to lead on, too little for them to tell."""
CLEAR = 10.0
"""Log odds from which on somebody has climbed. A kick is found by as much."""
SOON, HOPELESS = 3, 10.0
"""Steps after which heights are given up whose readings are this much less likely with each of them: ranges
are so sharp that some go on to a storey from there. Of who has powers alone they tell by then whether anybody
is likelier with heights at all. Whose powers are as unlikely with all else held is not solved at all."""
HINT = 5.0
"""Readings that cost so much more than they did hint at heights: it was 18 to 22 where somebody had climbed.
On the level they may as well, by chance: then it is asked in vain."""
CLIMBED_M = 0.5 * physics.FLOOR_M
"""Whose height changes by less may have kept level all the time."""


def hinted(problem: Problem, solved: Solution) -> bool:
    """Whether a window's readings cost clearly more than when it was last asked in vain who has climbed.

    Args:
        problem: of a window; its state is told what they cost.
        solved: its solution.
    """
    state, count = problem.layout.state, len(problem.rows.slab)
    if count == 0:
        return False
    if solved.cost - state.level_cost * count > HINT:
        return True
    state.level_cost = min(state.level_cost, solved.cost / count)
    return False


def find_unseen_climb(
    problem: Problem, solved: Solution, build: Callable[[FusionState], Problem], resting: float
) -> tuple[Problem, Solution]:
    """Let those climb whose units measure no heights, where that is clearly likelier than keeping level.

    Args:
        problem: of a window; its state is told who has climbed.
        solved: its solution.
        build: makes the same problem of another state.
        resting: see `Problem.solve`.
    """
    state, layout = problem.layout.state, problem.layout
    doubted = [i for i, w in enumerate(layout.walks) if w.way is not None and w.node.doubt_up_m2 > 0.0]
    lacking = _lacking(state, layout.since_t) if doubted else set[int]()
    level = [i for i in doubted if layout.walks[i].number in lacking]
    if not level:
        return problem, solved
    state.level_cost = solved.cost / max(len(problem.rows.slab), 1)
    by_powers = _by_powers(problem, level)
    if by_powers and _hopeless(problem, solved, level):
        return problem, solved
    x = solved.x.copy()
    for i in level:
        layout.states(x, i)[:, UP] += OFF_PLANE_M
    trial = _trial(problem, solved, level, build)
    found = trial.solve(x, iterations=SOON, resting=resting)
    before: MarginalCost | None = None
    if not found.rests:
        before = marginal_cost(problem, solved)
        after = marginal_cost(trial, found)
        if (after.each[level] > before.each[level] + (0.0 if by_powers else HOPELESS)).all():
            return problem, solved
        found = trial.solve(found.x, resting=resting)
    rose = [i for i in level if np.ptp(_heights(problem, found.x, i)) > CLIMBED_M]
    if not rose or found.cost > solved.cost - CLEAR:
        return problem, solved
    before = before or marginal_cost(problem, solved)
    after = marginal_cost(trial, found)
    likelier = [i for i in rose if after.each[i] < before.each[i]]
    if likelier and likelier != level:
        # Heights of others, which fit noise, speak neither for nor against his.
        x = found.x.copy()
        for i in level:
            if i not in likelier:
                layout.states(x, i)[:, UP] = layout.states(solved.x, i)[:, UP]
        trial = _trial(problem, solved, likelier, build)
        found = trial.solve(x, resting=resting)
        after = marginal_cost(trial, found)
    if not likelier or after.all > before.all - CLEAR:
        return problem, solved
    _let_climb(state, [layout.walks[i].number for i in likelier], layout.since_t)
    anew = build(state)
    return anew, anew.solve(found.x, resting=resting)


def _trial(
    problem: Problem, solved: Solution, walks: Sequence[int], build: Callable[[FusionState], Problem]
) -> Problem:
    """The window with some walks, by index, let climb, and floors between radios where a solution has them.

    With others it could not be compared with that (decision 0019).
    """
    other, layout = problem.layout.state.copy(), problem.layout
    _let_climb(other, [layout.walks[i].number for i in walks], layout.since_t)
    trial = build(other)
    trial.rows.floors = trial.rows.through(solved.x)
    return trial


def _by_powers(problem: Problem, level: Sequence[int]) -> bool:
    """Whether no range tells where any of some walks, by index, is."""
    layout, rows = problem.layout, problem.rows
    own = rows.of([layout.walks[i].number for i in level])[: len(rows.pairs)]
    return not (own & (rows.pairs[:, 1] == RANGE)).any()


def _hopeless(problem: Problem, solved: Solution, level: Sequence[int]) -> bool:
    """Whether powers of each of some walks, by index, speak clearly against heights, all else held.

    Who is ranged is asked with all else free: ranges are so sharp that whom they have dragged aside no height
    brings back by itself.
    """
    layout = problem.layout
    walks = [layout.walks[i] for i in level]
    if any(walk.first == walk.last for walk in walks):
        return False
    climbs_m2 = {i: _climbing_m2(layout, i) for i in level}
    return min(height_costs(problem, solved, climbs_m2, OFF_PLANE_M).values()) > HOPELESS


def _heights(problem: Problem, x: Array, index: int) -> Array:
    walk = problem.layout.walks[index]
    heights: Array = problem.layout.states(x, index)[walk.first : walk.last + 1, UP]
    return heights


def _lacking(state: FusionState, since_t: float) -> set[int]:
    """Units with steps since an epoch that are held to be level."""
    steps = state.ledger.table("steps")
    level = (steps[:, 0] > since_t) & (steps[:, 7] < _climbs_m2(steps))
    return {int(number) for number in np.unique(steps[level, 1])}


def _let_climb(state: FusionState, numbers: Collection[int], since_t: float) -> None:
    """Let each step of some units be as unsure in height as a stair makes it, from an epoch on."""
    for number in numbers:
        state.keep(replace(state.life(number), climbs=True))
    steps = state.ledger.table("steps").copy()
    mine = np.isin(steps[:, 1], list(numbers)) & (steps[:, 0] > since_t)
    steps[mine, 7] = np.maximum(steps[mine, 7], _climbs_m2(steps[mine]))
    state.ledger.replace("steps", steps)


def _climbing_m2(layout: Layout, index: int) -> Array:
    """Variance of each of a walk's steps between keyframes in height, were it let climb (m²)."""
    walk, steps = (
        layout.walks[index],
        own_rows(layout.state.ledger.table("steps"), layout.walks[index].number),
    )
    steps = steps.copy()
    steps[:, 7] = np.maximum(steps[:, 7], _climbs_m2(steps))
    way, t = Way(steps[0, 2], steps, walk.node.walk_factors), layout.times[walk.first : walk.last + 1, index]
    found: Array = np.maximum(way.between(t[:-1], t[1:])[:, VARIANCES[UP]], 0.0) + FLOOR[UP]
    return found


def _climbs_m2(steps: Array) -> Array:
    return np.asarray(CLIMB_M2_PER_M * np.hypot(steps[:, 3], steps[:, 4]))
