"""Whether a step that stands out has slipped, or a wall has come before a radio; and which step it was.

Walls before anchors are asked of (decision 0125): the window is solved with the slip, with one step after the
other around it, and with such a wall instead.
"""

from collections.abc import Callable

import numpy as np

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RANGE, own_rows
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.losses import STEP_S, parts_of
from estimator.smoothing.learning.slips import Slip, widen_steps
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

APART_S = 30.0
"""Readings as near as this to a slip tell of it."""
NEAR_S, ASKED = 3.5, 8
"""Which steps around it are asked, and so many of them at most."""
SLACKS_M, NEARLY_M, ITERATIONS, RESTING = (0.3, 0.1), (0.1,), 6, 0.1
"""How far each is solved: all else is nearly where it was, and nearer still from a step beside it."""
CLEARER = 2.0
"""By how much, in log likelihood, another one must be likelier; behind one that is as much less none is."""
ELSE = 1.0
"""Log odds of a slip, before how rare it is, that must be left without the radio that tells most of it."""


def judged(
    problem: Problem, solved: Solution, slip: Slip, gain: float, build: Callable[[FusionState], Problem]
) -> Slip | None:
    """A slip at the step, of those around it, with which all is likeliest; None: it may be something else.

    A reading between two keyframes counts from the one before it: it fits a slip before that one as well.

    Args:
        problem: of a window.
        solved: its solution.
        slip: it stands out there.
        gain: its log odds, before how rare it is.
        build: builds the same problem of a fusion.
    """
    pull, farther_m = _pulls(problem, solved, slip)
    if not _confirmed(problem, pull, gain):
        return None
    radio = int(np.argmax(pull))
    t, likeliest, there = _likeliest_step(problem, solved, slip, build)
    starts = solved.x, *_walled(problem, solved.x, slip, radio, float(farther_m[radio]))
    none = min(_solved(problem, x).cost for x in starts)
    if none - likeliest.cost < physics.SLIP_RARE:
        return None
    return slip._replace(t=t) if there.cost - likeliest.cost > CLEARER else slip


def _likeliest_step(
    problem: Problem, solved: Solution, slip: Slip, build: Callable[[FusionState], Problem]
) -> tuple[float, Solution, Solution]:
    """The middle (s) of the step near a slip with which all is likeliest; its solution, and the slip's own.

    From the slip on they are asked one after the other, each way until one is clearly less likely.
    """
    state = problem.layout.state

    def slipped(t: float, x: Array, slacks_m: tuple[float, ...]) -> Solution:
        other = state.copy()
        widen_steps(other, [slip._replace(t=t)])
        return _solved(build(other), x, slacks_m)

    there = slipped(slip.t, solved.x, SLACKS_M)
    best = slip.t, there
    steps = own_rows(state.ledger.table("steps"), slip.number)
    middle, half_s = 0.5 * (steps[:, 2] + steps[:, 0]), 0.5 * (steps[:, 0] - steps[:, 2])
    off_s = middle - slip.t
    near = middle[(np.abs(off_s) < NEAR_S) & (np.abs(off_s) > half_s) & (half_s > 0.0)]
    near = near[:: len(near) // ASKED + 1]
    for side in (near[near < slip.t][::-1], near[near > slip.t]):
        beside = there
        for t in side.tolist():
            beside = slipped(t, beside.x, NEARLY_M)
            if beside.cost > best[1].cost + CLEARER:
                break
            best = min(best, (t, beside), key=lambda found: found[1].cost)
    return *best, there


def _confirmed(problem: Problem, pull: Array, gain: float) -> bool:
    """Whether a slip would be found without the radio that pulls most at the ways before and after it.

    A wall that comes between two radios, or a breadcrumb that was kicked, changes what one of them says. Of
    anchors, walls are asked of by themselves.
    """
    asked = problem.layout.losses.radio[: len(pull)] >= 0
    rest = pull.sum() - np.where(asked, 0.0, pull).max()
    return bool(rest > 0.0 and gain * (rest / pull.sum()) ** 2 > ELSE)


def _pulls(problem: Problem, solved: Solution, slip: Slip) -> tuple[Array, Array]:
    """How much each number of the ledger pulls at the ways before and after a slip, and what it says of it.

    Returns:
        Both, n; the second in the mean, by how much more its ranges are with the slip (m).
    """
    pairs, m = problem.rows.pairs, len(problem.rows.pairs)
    force = (solved.weighted.information * solved.weighted.residual)[:m]
    since = problem.rows.t[:m] - slip.t
    pull, farther_m, count = np.zeros((3, len(problem.layout.state.owners)))
    for own, other, columns in ((2, 3, slice(0, 2)), (3, 2, slice(6, 8))):
        near = np.flatnonzero((pairs[:, own] == slip.number) & (np.abs(since) < APART_S))
        along = solved.linear.jacobian[near, columns] @ np.array(slip.off_m)
        radio, ranged = pairs[near, other].astype(np.int64), (pairs[near, 1] == RANGE) & (since[near] > 0.0)
        np.add.at(pull, radio, along * force[near] * np.sign(since[near]))
        np.add.at(farther_m, radio, along * ranged)
        np.add.at(count, radio, ranged)
    return pull, farther_m / np.maximum(count, 1.0)


def _solved(problem: Problem, x: Array, slacks_m: tuple[float, ...] = SLACKS_M) -> Solution:
    """The solution that an estimate, flat, leads to with what crews lose to anchors asked."""
    return problem.with_losses().solve(x, slacks_m, ITERATIONS, RESTING)


def _walled(problem: Problem, x: Array, slip: Slip, radio: int, farther_m: float) -> list[Array]:
    """An estimate, flat, with what a slip explains taken for a wall before a radio that adds so much (m).

    None where no walls are asked of that radio since then.
    """
    layout, columns = problem.layout, list[int]()
    for (_, number), loss in layout.lost.items():
        kind, _, other, since_s = parts_of(number)
        if (kind, other) == (RANGE, radio) and since_s > slip.t - 0.5 * STEP_S:
            columns.append(layout.length * layout.width + loss.column)
    walled = x.copy()
    walled[columns] -= farther_m
    return [walled] if columns else []
