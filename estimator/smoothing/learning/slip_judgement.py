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
SLACKS_M, ITERATIONS, RESTING = (0.3, 0.1), 6, 0.1
"""How far each is solved: all else is nearly where it was."""
CLEARER = 2.0
"""By how much, in log likelihood, another one must be likelier."""
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
    state = problem.layout.state
    steps = own_rows(state.ledger.table("steps"), slip.number)
    middle = 0.5 * (steps[:, 2] + steps[:, 0])
    near = middle[(np.abs(middle - slip.t) < NEAR_S) & (steps[:, 2] < steps[:, 0])]
    asked, costs = [slip.t, *near[:: len(near) // ASKED + 1].tolist()], []
    for t in asked:
        other = state.copy()
        widen_steps(other, [slip._replace(t=t)])
        costs.append(_cost(build(other), solved.x))
    best = int(np.argmin(costs))
    radio = int(np.argmax(pull))
    walled = _walled(problem, solved.x, slip, radio, float(farther_m[radio]))
    if min(_cost(problem, x) for x in (solved.x, walled)) - costs[best] < physics.SLIP_RARE:
        return None
    return slip._replace(t=asked[best]) if costs[0] - costs[best] > CLEARER else slip


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


def _cost(problem: Problem, x: Array) -> float:
    """What the solution costs that an estimate, flat, leads to with what crews lose to anchors asked."""
    return problem.with_losses().solve(x, SLACKS_M, ITERATIONS, RESTING).cost


def _walled(problem: Problem, x: Array, slip: Slip, radio: int, farther_m: float) -> Array:
    """An estimate, flat, with what a slip explains taken for a wall before a radio that adds so much (m)."""
    layout, x = problem.layout, x.copy()
    for (_, number), loss in layout.lost.items():
        kind, _, other, since_s = parts_of(number)
        if (kind, other) == (RANGE, radio) and since_s > slip.t - 0.5 * STEP_S:
            x[layout.length * layout.width + loss.column] -= farther_m
    return x
