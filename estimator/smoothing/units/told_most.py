"""What one radio alone tells for another way: one that was moved, or is behind a wall, contradicts any."""

import numpy as np

from estimator.graph.robust import mixture_cost
from estimator.smoothing.keyframes.layout import Walk
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution


def told_most(one: Problem, as_one: Solution, other: Problem, as_other: Solution, walk: Walk) -> float:
    """What the radio tells that tells most for one solution over another, of those a walk's radio hears.

    Args:
        one: of the window.
        as_one: its solution.
        other: of the same window with the other way.
        as_other: its solution.
        walk: whose way it is.
    """
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
