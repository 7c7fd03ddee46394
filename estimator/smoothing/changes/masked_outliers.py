"""Readings to a node that lies elsewhere, and have drawn all the rest along with them.

A few ranges to a kicked breadcrumb rather bend the way of who passes it than disagree with it: what they miss
in their own residuals, all others pay. So the window is solved again without them.
"""

from typing import NamedTuple

import numpy as np

from estimator.fusion.entering.modes import costs_of, find_modes
from estimator.fusion.memory.nodes import NodeState
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.changes.relocation import FAR_M, NodeReadings, Place, clear_place, readings_of
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution

DISAGREEING = 5.0
"""Readings that do not cost more themselves, in log likelihood, are not suspected of costing others."""
RELIEF = 2.0
"""Where all others gain no more without them, in log likelihood, they have drawn nobody."""
ITERATIONS = 6


class MaskedOutliers(NamedTuple):
    """Where readings put a node that have drawn others along.

    Attributes:
        place: its place; the gain is of all readings together.
        alone: the solution without them, which is not bent by them.
        relief: what all others gain without them, in log likelihood.
    """

    place: Place
    alone: Solution
    relief: float


def masked_place(
    problem: Problem, solved: Solution, node: NodeState, mine: Integers
) -> MaskedOutliers | None:
    """The place that readings have for a node, where all readings together fit clearly better with it there.

    Only of readings by who has a PDR unit, or stands: who has none goes where his ranges take him.

    Args:
        problem: of the window.
        solved: its solution.
        node: the node.
        mine: its readings that may disagree with its place, in order of epoch.
    """
    here = readings_of(problem, solved, node, mine[problem.rows.held[mine]])
    if here is None or not _may_disagree(here):
        return None
    drawn = place_without(problem, solved, node, mine)
    return None if drawn is None or drawn.relief <= RELIEF else drawn


def place_without(
    problem: Problem, solved: Solution, node: NodeState, mine: Integers
) -> MaskedOutliers | None:
    """The same of readings that need not disagree with their node's place, nor have drawn anybody."""
    here = readings_of(problem, solved, node, mine[problem.rows.held[mine]])
    if here is None:
        return None
    sigma = problem.rows.sigma
    try:
        return _without(problem, solved, node, here.rows, sigma[here.rows])
    finally:
        # Whoever is asked next is asked by the noise that the window was solved with.
        problem.rows.sigma = sigma


def _without(
    problem: Problem, solved: Solution, node: NodeState, mine: Integers, sigma: Array
) -> MaskedOutliers | None:
    """The place that readings `mine` have for a node, if they and all others fit clearly better with it."""
    # What the last steps have left is nobody's fault.
    solved = problem.solve(solved.x, iterations=ITERATIONS)
    others = problem.without(mine)
    try:
        # What they have bent is not to be an outlier for that.
        alone = others.solve(solved.x, METRES_OFF, len(METRES_OFF) + ITERATIONS)
    except ValueError:
        # Without them something hangs in the air: they have held it, not bent it.
        return None
    relief = others.cost(solved.x, solved.linear.residual, solved.motions) - alone.cost
    here, there = (readings_of(problem, one, node, mine) for one in (solved, alone))
    if here is None or there is None:
        return None
    modes = find_modes(there.sought)
    if not modes:
        return None
    before = _cost(here, here.residual, sigma) + relief
    after = _cost(there, there.residual_at(modes[0].position_m), sigma)
    # How surely they tell where is no matter: that they fit elsewhere is told by all readings together.
    place = clear_place(there, modes[0], before, after)
    return None if place is None else MaskedOutliers(place, alone, relief)


def _cost(seen: NodeReadings, residual: Array, sigma: Array) -> float:
    """What ranges cost by the noise that their window was solved with, in log likelihood."""
    ranged = np.full(len(residual), seen.sought.kind == "range")
    return float(costs_of(residual, sigma, seen.noise, ranged, seen.alike).sum())


def _may_disagree(seen: NodeReadings) -> bool:
    """Whether readings disagree with their node's place at all, and tell of another one that is not near."""
    if float(seen.costs(seen.residual).sum()) < DISAGREEING:
        return False
    modes = find_modes(seen.sought)
    return bool(modes) and float(np.hypot(*(modes[0].position_m - seen.place_m)[:2])) > FAR_M
