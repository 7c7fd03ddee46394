"""Estimates by what units tell alone: where each has gone from where it began, and what was dropped there."""

import math
from collections.abc import Mapping

import numpy as np

from estimator.graph.dense import Array
from estimator.smoothing.problem.newton import Problem


def own_ways(problem: Problem, x: Array, some: Mapping[int, int]) -> Array:
    """An estimate with units gone their own way from their first keyframe in it, flat; crumbs lie along it.

    Args:
        problem: of the window.
        x: where these begin, and where all others are, flat.
        some: index of the walk of each such unit, by its number.
    """
    layout, found = problem.layout, x.copy()
    there = problem.going.reckoned(x, -math.inf)
    for i in some.values():
        layout.states(found, i)[:] = layout.states(there, i)
    size = layout.length * layout.width
    for t, crumb, by in layout.state.ledger.table("drops")[:, :3].tolist():
        if int(crumb) in layout.stands and int(by) in some:
            i, start = some[int(by)], size + layout.stands[int(crumb)]
            for c in range(3):
                found[start + c] = np.interp(t, layout.times[:, i], layout.states(found, i)[:, c])
    return found
