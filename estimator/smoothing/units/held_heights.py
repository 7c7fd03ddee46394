"""What a walk's readings cost with heights that nobody measured, with all else held where it is.

Where its bearer is along the floor, and all others, stay where a solution has them: a row of numbers is left
of each walk, which each depend on the one before only. That says less for heights than a solution with
everybody free does, at a tenth of its work.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from estimator.graph.dense import Array, Indices
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.readings.linearisation import separations
from estimator.smoothing.readings.rows import Rows

UP = 2
"""Which of a state's numbers is its height."""
STEPS = 2
"""After so many from a little above the floor what heights cost changes by a tenth of itself at most."""


class Ends(NamedTuple):
    """The first ends of rows that move, or the second ones.

    Attributes:
        column: which of a row's derivatives is by the end's height.
        rows: which rows have such an end, e.
        at: keyframe and walk of each, as an index of keyframes × walks, e.
        sign: 1.0 of first ends, −1.0 of second ones.
    """

    column: int
    rows: Indices
    at: Indices
    sign: float


class Told(NamedTuple):
    """What readings tell of heights, each keyframes × walks.

    Attributes:
        information: HᵀP⁻¹H.
        bent: the positive part of the curvature, by which steps are shorter.
        gradient: of the log likelihood.
    """

    information: Array
    bent: Array
    gradient: Array


def height_costs(
    problem: Problem, solved: Solution, climbs_m2: Mapping[int, Array], off_plane_m: float
) -> dict[int, float]:
    """What readings of walks cost more over all heights than level, with all else held, in log likelihood.

    As in `marginal_cost`, by Laplace's method; the height at a walk's first keyframe is known.

    Args:
        problem: of a window.
        solved: its solution, with them level.
        climbs_m2: of some walks, by index, the variance of each step's height, keyframes less one (m²);
            each has two keyframes at least.
        off_plane_m: how far above the plane heights are sought from (m).
    """
    layout, rows = problem.layout, problem.rows
    ends, up_m = _ends(layout, rows), separations(rows.readings, solved.x)[:, UP]
    raised = np.zeros((layout.length, len(layout.walks)))
    free = {i: slice(layout.walks[i].first + 1, layout.walks[i].last + 1) for i in climbs_m2}
    for i, own in free.items():
        raised[own, i] = off_plane_m
    for _ in range(STEPS):
        told = _by_heights(problem, _at(layout, solved.x, raised), ends, up_m, raised)
        for i, m2 in climbs_m2.items():
            known, rise_m = 1.0 / m2, np.diff(_heights(layout, solved.x, raised, i))
            pulled = told.gradient[free[i], i] - known * rise_m
            pulled[:-1] += known[1:] * rise_m[1:]
            factor = _factor(told.information[free[i], i] + told.bent[free[i], i], known)
            raised[free[i], i] += cho_solve_banded((factor, False), pulled)
    there = _at(layout, solved.x, raised)
    told = _by_heights(problem, there, ends, up_m, raised)
    more = problem.costs(rows.residual(there)) - problem.costs(solved.linear.residual)
    found = {}
    for i, m2 in climbs_m2.items():
        rise_m = np.diff(_heights(layout, solved.x, raised, i))
        own_cost = float(more[rows.of([layout.walks[i].number])].sum() + 0.5 * (rise_m**2 / m2).sum())
        factor = _factor(told.information[free[i], i], 1.0 / m2)
        found[i] = own_cost + float(np.log(factor[1]).sum() + 0.5 * np.log(m2).sum())
    return found


def _factor(told: Array, known: Array) -> Array:
    """The Cholesky factor of what is known of heights, upper, as two bands.

    Args:
        told: what readings know of each.
        known: what is known of each one's difference from the one before.
    """
    banded = np.zeros((2, len(known)))
    banded[0, 1:] = -known[1:]
    banded[1] = told + known
    banded[1, :-1] += known[1:]
    return np.asarray(cholesky_banded(banded))


def _ends(layout: Layout, rows: Rows) -> list[Ends]:
    found = []
    for column, sign in ((UP, 1.0), (STATES + UP, -1.0)):
        of = rows.columns[:, column]
        moving = np.flatnonzero((of >= 0) & (of < layout.width) & (of % STATES == UP))
        found.append(Ends(column, moving, rows.slab[moving] * len(layout.walks) + of[moving] // STATES, sign))
    return found


def _by_heights(problem: Problem, x: Array, ends: list[Ends], up_m: Array, raised: Array) -> Told:
    """What readings tell of each height by itself.

    Args:
        problem: of the window.
        x: the estimate, flat.
        ends: see `_ends`.
        up_m: from the second end of each pair up to the first, before any was raised, m (m).
        raised: by how much each walk's keyframes are raised, k × walks (m).
    """
    rows, m = problem.rows, len(up_m)
    jacobian, weighted = rows.jacobian(x), problem.weigh(rows.residual(x))
    pull, up_now_m = weighted.information * weighted.residual, np.zeros(len(weighted.residual))
    up_now_m[:m] = up_m
    for end in ends:
        up_now_m[end.rows] += end.sign * raised.ravel()[end.at]
    told = np.zeros((3, raised.size))
    for end in ends:
        slope, apart_m = jacobian[end.rows, end.column], end.sign * up_now_m[end.rows]
        # Of pairs a slope by height is the height apart times the curvature by it: see `range_slope`.
        bent = np.divide(slope, apart_m, out=np.zeros(len(slope)), where=(apart_m != 0.0) & (end.rows < m))
        known, own_pull = weighted.information[end.rows] * slope**2, pull[end.rows]
        for kind, each in enumerate((known, np.maximum(-own_pull * bent, 0.0), slope * own_pull)):
            told[kind] += np.bincount(end.at, each, raised.size)
    return Told(*told.reshape(3, *raised.shape))


def _at(layout: Layout, x: Array, raised: Array) -> Array:
    """An estimate with each walk's keyframes raised, flat."""
    there = x.copy()
    keyframes = there[: layout.length * layout.width].reshape(layout.length, layout.width)
    keyframes[:, UP::STATES] += raised
    return there


def _heights(layout: Layout, x: Array, raised: Array, index: int) -> Array:
    walk = layout.walks[index]
    own = slice(walk.first, walk.last + 1)
    heights: Array = layout.states(x, index)[own, UP] + raised[own, index]
    return heights
