"""Whose unit's frame has turned on the way: it was switched off and on again, or its bearer walks backwards.

By powers alone a window bends his way a little, finds them noisier, and shows him elsewhere as sure. So where
they cost more than when it was last asked in vain, all moments and angles of a turn are looked at; where one
is likely, the window is solved with it. Until that is taken, covariances hold where he would be by it. Who is
ranged is asked about where his unit is contradicted: good ranges are outliers of his way, and breadcrumbs
would seem to have been kicked.
"""

from collections.abc import Callable

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.unreliable_unit import is_contradicted, is_noisy, leads_elsewhere
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.keyframes.pauses import paused_until
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.heard_powers import power_costs
from estimator.smoothing.units.suspected_turns import LOOK_S, suspected_turn
from estimator.smoothing.units.taken_turns import take_turn

HINT, LATELY_S = 4.0, 20.0
"""Powers of so long that cost so much more (log likelihood) than they did hint at a turn."""
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
    state, layout, now = problem.layout.state, problem.layout, float(problem.layout.grid[-1])
    by_powers = bool((problem.rows.pairs[:, 1] == RSSI).any()) and not _is_open(problem)
    units = _asked(problem, by_powers)
    asked = {layout.walks[i].number for i in units}
    for node in list(state.nodes.values()):
        if node.detours and node.index not in asked:
            state.keep(replace(node, detours=()))
    if not units:
        return problem, solved
    variance = _assumed_variance(problem, solved)
    numbers = np.array([float(layout.walks[i].number) for i in units])
    off_db = solved.linear.residual[: len(variance)]
    costs = power_costs(problem.rows.pairs, off_db, variance, now - LATELY_S, numbers)
    for (i, (way, paused_t)), (cost, count, ranged) in zip(units.items(), costs.tolist(), strict=True):
        node, each = state.life(layout.walks[i].number), cost / max(count, 1.0)
        if ranged:
            # Where else he may be his rival tells. How his unit is worn (decision 0060) is asked before, and
            # whether it is on him (0055).
            state.keep(replace(node, detours=()))
            settled = way.begin_t < now - LOOK_S
            hinted = settled and (paused_t is not None or _elsewhere(layout, solved, i))
        elif not count or not by_powers:
            state.keep(replace(node, detours=()))
            hinted = False
        else:
            hinted = bool(node.detours) or paused_t is not None or (each - node.power_cost) * count > HINT
            if not hinted:
                state.keep(replace(node, power_cost=min(node.power_cost, each)))
        if not hinted:
            continue
        turn, detours = suspected_turn(problem, solved, i, way, variance, paused_t)
        if not ranged:
            state.keep(replace(node, detours=detours, power_cost=node.power_cost if detours else each))
        taken = None if turn is None else take_turn(problem, solved, turn, build, resting)
        if taken is not None:
            return taken
    return problem, solved


def _elsewhere(layout: Layout, solved: Solution, index: int) -> bool:
    """Whether a unit has become far noisier, or has led its bearer away from his rival."""
    node = layout.state.life(layout.walks[index].number)
    return is_noisy(node) or leads_elsewhere(node, *layout.end_of(solved.x, index))


def _asked(problem: Problem, by_powers: bool) -> dict[int, tuple[Way, float | None]]:
    """Units of which it is asked whether they have turned, by index of the walk: their ways, and pauses (s).

    Args:
        problem: of a window.
        by_powers: those are asked about whom powers alone tell of; else none that nothing speaks against.
    """
    layout, found = problem.layout, dict[int, tuple[Way, float | None]]()
    now = float(layout.grid[-1])
    for i, walk in enumerate(layout.walks):
        node = layout.state.life(walk.number)
        if walk.way is None or not _askable(node, walk):
            continue
        paused_t = paused_until(node, walk.way, now - LOOK_S, now)
        if by_powers or paused_t is not None or is_contradicted(node):
            found[i] = walk.way, paused_t
    return found


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
    settled = not (worn or node.turned) and node.changed is None
    led = node.mode == "unit" and node.apart is None and node.carried_t is None
    return settled and led


def _is_open(problem: Problem) -> bool:
    """Whether crumbs may lie along a way that is wrong from its beginning (decision 0060).

    Then a turn would be taken, and another one, where it is a unit that is worn the wrong way round.
    """
    known = () if problem.prior is None else problem.prior.keys
    droppers = set(problem.layout.state.ledger.table("drops")[:, 2].tolist())
    return any(("walk", w.number) not in known and w.number in droppers for w in problem.layout.walks)
