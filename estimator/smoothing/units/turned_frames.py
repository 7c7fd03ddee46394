"""Whose unit's frame has turned on the way: it was switched off and on again, or its bearer walks backwards.

By powers alone a window bends his way a little, finds them noisier, and shows him elsewhere as sure. So where
they cost more than when it was last asked in vain, all moments and angles of a turn are looked at; where one
is likely, the window is solved with it. Until that is taken, covariances hold where he would be by it.
"""

from collections.abc import Callable

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.layout import Walk
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.heard_powers import power_costs
from estimator.smoothing.units.suspected_turns import LOOK_S, suspected_turn
from estimator.smoothing.units.taken_turns import take_turn

HINT, LATELY_S = 4.0, 20.0
"""Powers of so long that cost so much more (log likelihood) than they did hint at a turn."""
PAUSE_S = 3.0
LIKELY = 0.2
"""From which share on it is asked again soon."""
SHORTEST = 4
"""Keyframes that a walk has at least."""


def turned_frames(
    problem: Problem, solved: Solution, build: Callable[[FusionState], Problem], resting: float
) -> tuple[Problem, Solution]:
    """Let a unit's frame turn where that is clearly likelier; where it is not clear, its node is told.

    Args:
        problem: of a window; its state is told who may have turned, and who has.
        solved: its solution.
        build: makes the same problem of another state.
        resting: see `Problem.solve`.
    """
    state, layout = problem.layout.state, problem.layout
    units = _asked(problem)
    asked = {layout.walks[i].number for i in units}
    for node in list(state.nodes.values()):
        if node.detours and node.index not in asked:
            state.keep(replace(node, detours=()))
    if not units:
        return problem, solved
    now, variance = float(layout.grid[-1]), _assumed_variance(problem, solved)
    numbers = np.array([float(layout.walks[i].number) for i in units])
    off_db = solved.linear.residual[: len(variance)]
    costs = power_costs(problem.rows.pairs, off_db, variance, now - LATELY_S, numbers)
    for (i, way), (cost, count, ranged) in zip(units.items(), costs.tolist(), strict=True):
        node = state.life(layout.walks[i].number)
        if ranged or not count:
            state.keep(replace(node, detours=()))
            continue
        each, paused_t = cost / count, _pause(node, way, now)
        if not (node.detours or paused_t is not None or (each - node.power_cost) * count > HINT):
            state.keep(replace(node, power_cost=min(node.power_cost, each)))
            continue
        turn, detours = suspected_turn(problem, solved, i, way, variance, paused_t)
        state.keep(replace(node, detours=detours, power_cost=node.power_cost if detours else each))
        taken = None if turn is None else take_turn(problem, solved, turn, build, resting)
        if taken is not None:
            return taken
    return problem, solved


def may_have_turned(state: FusionState) -> bool:
    """Whether anybody's unit may so well have turned that it is asked again soon."""
    return any(sum(other.share for other in node.detours) > LIKELY for node in state.nodes.values())


def _asked(problem: Problem) -> dict[int, Way]:
    """Units of which it is asked whether they have turned, by index of the walk: their ways."""
    pairs, layout = problem.rows.pairs, problem.layout
    if not (pairs[:, 1] == RSSI).any() or _is_open(problem):
        return {}
    return {
        i: walk.way
        for i, walk in enumerate(layout.walks)
        if walk.way is not None and _askable(layout.state.life(walk.number), walk)
    }


def _assumed_variance(problem: Problem, solved: Solution) -> Array:
    """Variance of each pair's noise as it was assumed, m: what was learned of it a wrong way has made.

    Through a floor a power tells nothing.
    """
    rows, share = problem.rows, physics.SHARED_NOISE
    m = len(rows.pairs)
    variance = rows.nominal[:m] ** 2 * (1.0 - share + share * rows.alike[:m])
    variance[rows.through(solved.x)] = np.inf
    return variance


def _askable(node: NodeState, walk: Walk) -> bool:
    """Whether a unit leads its bearer, and it is known what it faced."""
    if node.index != walk.number or walk.last - walk.first < SHORTEST:
        return False
    worn = any(other.by_unit for other in node.otherwise)
    settled = not (worn or node.turned) and node.changed is None and node.apart is None
    return node.mode == "unit" and settled


def _is_open(problem: Problem) -> bool:
    """Whether crumbs may lie along a way that is wrong from its beginning (decision 0060).

    Then a turn would be taken, and another one, where it is a unit that is worn the wrong way round.
    """
    known = () if problem.prior is None else problem.prior.keys
    droppers = set(problem.layout.state.ledger.table("drops")[:, 2].tolist())
    return any(("walk", w.number) not in known and w.number in droppers for w in problem.layout.walks)


def _pause(node: NodeState, way: Way, now: float) -> float | None:
    """When a unit began to tell again that had told nothing for a while (s), if it did lately."""
    whole_t = node.whole_t
    if not max(now - LOOK_S, way.begin_t + 2.0 * PAUSE_S) < whole_t < now:
        return None
    before, until = way.unseen_s(np.array([whole_t - 2.0 * PAUSE_S, whole_t])).tolist()
    return whole_t if until - before > PAUSE_S else None
