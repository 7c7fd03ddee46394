"""Who is above or below the plane of all radios that tell of him: a height that only distances tell.

In that plane no distance changes with a height, so no step of a solution leads out of it, however much too
long distances are: what a height makes them longer by moves him outwards instead, and bends what is learned
of their bias and scale. And what ranges are off by for seconds a height that may change would take up. So
such a height is kept, and a solution is sought from below the plane as well; above it one fits alike.
"""

from collections.abc import Callable

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.ledger import BEARING, COLUMNS
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.images.earlier import CLEARER
from estimator.smoothing.images.heights import UP
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.keyframes.walks import PLACES
from estimator.smoothing.problem.solve import Problem
from estimator.smoothing.problem.solved import Solved

HEIGHT = COLUMNS["poses"].index("u")
LEVEL_M = 0.3
"""Heights that differ by less are the same plane's: distances tell too little of a height in it."""
BELOW_M = 1.0
"""From so far below the plane a solution is sought: a tag is worn below a ceiling or a roof."""
SURE = 7.0
"""Log odds from which on a side is known."""


def keep_level(problem: Problem, build: Callable[[FusionState], Problem]) -> Problem:
    """The problem with those keeping their height of which only radios in one plane tell.

    Args:
        problem: of a window; its state is told who they are, and the height of the plane.
        build: makes the same problem of a state.
    """
    layout, changed = problem.layout, False
    for i, plane_m in planes_of(problem).items():
        changed |= layout.walks[i].node.plane_m is None
        _tell(layout, i, plane_m)
    return build(layout.state) if changed else problem


def off_plane(problem: Problem, solved: Solved, resting: float) -> tuple[Problem, Solved]:
    """The solution out of the plane, where that is likelier than in it; and on which side, once that is told.

    Args:
        problem: of a window; its state is told of whom the side is known.
        solved: a solution.
        resting: see `Problem.solve`.

    Returns:
        The window, whose prior may be across the plane from where it was, and its solution.
    """
    layout, x, inside = problem.layout, solved.x.copy(), False
    level = {i: walk.node.plane_m for i, walk in enumerate(layout.walks) if walk.node.plane_m is not None}
    if not level:
        return problem, solved
    for i, plane_m in level.items():
        states = _alive(layout, x, i)
        if (np.abs(states[:, UP] - plane_m) < LEVEL_M).all():
            states[:, UP], inside = plane_m - BELOW_M, True
    if inside:
        found = problem.solve(x, resting=resting)
        solved = found if found.cost < solved.cost - CLEARER else solved
    planes = planes_of(problem)
    for i, plane_m in level.items():
        if i not in planes:
            problem, solved = _sided(problem, solved, i, plane_m, resting)
    return problem, solved


def _sided(
    problem: Problem, solved: Solved, index: int, plane_m: float, resting: float
) -> tuple[Problem, Solved]:
    """The likelier one of two sides of the plane: something tells it by now."""
    layout, number = problem.layout, problem.layout.walks[index].number
    above = _alive(layout, solved.x, index)[:, UP] > plane_m
    sides = []
    for side in (False, True):
        if (above == side).all():
            sides.append((problem, solved))
            continue
        x = solved.x.copy()
        states, over = _alive(layout, x, index), above != side
        states[over, UP] = 2.0 * plane_m - states[over, UP]
        states[over, UP + PLACES] *= -1.0
        prior = problem.prior
        if prior is not None and over[0]:
            prior = prior.across(number, plane_m)
        there = Problem(layout, problem.rows, prior)
        sides.append((there, there.solve(x, resting=resting)))
    below, over_it = (found.cost for _, found in sides)
    if abs(below - over_it) > SURE:
        _tell(layout, index, None)
    best = min(sides, key=lambda one: one[1].cost)
    if best[1].cost > solved.cost - CLEARER:
        return problem, solved
    _cross(layout.state, number, plane_m, over_it < below)
    return best


def _cross(state: FusionState, number: int, plane_m: float, above: bool) -> None:
    """Put a walk on one side at all times: solutions that reach back farther start from there."""
    poses = state.ledger.table("poses").copy()
    own = (poses[:, 1] == number) & (poses[:, 2] == 0.0) & ((poses[:, HEIGHT] > plane_m) != above)
    poses[own, HEIGHT] = 2.0 * plane_m - poses[own, HEIGHT]
    poses[own, HEIGHT + PLACES] *= -1.0
    state.ledger.replace("poses", poses)


def _tell(layout: Layout, index: int, plane_m: float | None) -> None:
    """Keep it with a walk, by its index, whether its height is that of a plane's side."""
    walk = layout.walks[index]
    layout.state.keep(replace(layout.state.life(walk.number), plane_m=plane_m))
    layout.walks[index] = walk._replace(node=replace(walk.node, plane_m=plane_m))


def _alive(layout: Layout, x: Array, index: int) -> Array:
    walk = layout.walks[index]
    states: Array = layout.states(x, index)[walk.first : walk.last + 1]
    return states


def planes_of(problem: Problem) -> dict[int, float]:
    """Of walks, by index, the height of all radios that tell of them, where they are level and alone (m)."""
    layout, rows = problem.layout, problem.rows
    told = set(rows.singles[rows.singles[:, 2] == UP, 1].astype(int).tolist())
    loose = {
        walk.number: i
        for i, walk in enumerate(layout.walks)
        if _only_ranged(walk) and walk.number not in told
    }
    if not loose:
        return {}
    heights, pairs = _standing(problem), rows.pairs[rows.pairs[:, 1] < BEARING]
    ends = np.unique(np.sort(pairs[:, 2:4].astype(int), axis=1), axis=0).tolist()
    found: dict[int, float] = {}
    for number, i in loose.items():
        others = [b if a == number else a for a, b in ends if number in (a, b)]
        ups = [heights.get(other, np.inf) for other in others]
        # An infinite height is somebody's who moves.
        if ups and np.isfinite(ups).all() and np.ptp(ups) < LEVEL_M:
            found[i] = float(np.mean(ups))
    return found


def _only_ranged(walk: Walk) -> bool:
    node = walk.node
    return walk.way is None and node.moving and not node.heights and node.role not in physics.OUTSIDE_ROLES


def _standing(problem: Problem) -> dict[int, float]:
    """Heights of all that stand, by their number (m)."""
    layout, size = problem.layout, problem.layout.length * problem.layout.width
    border: Array = layout.start()[size:]
    found = {number: float(border[start + UP]) for number, start in layout.stands.items()}
    for node in layout.state.lives():
        if node.place_m is not None:
            found[node.index] = node.place_m[UP]
    return found
