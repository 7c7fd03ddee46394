"""By how much a unit may be turned from its beginning: its way turned all round about where it begins."""

import numpy as np

from estimator.fusion.entering.unit_mounting import Mounting
from estimator.graph.dense import Array
from estimator.graph.robust import mixture_cost
from estimator.measurements.bearing import within_pi
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.heading_images import facing, reports_from, turn
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import HEADING
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.readings.weights import loosened

ANGLES = 24
"""So many are looked at, all round: from the nearest one a solution finds the angle itself."""
TRIED, SLACK_M = 3, 3.0
"""So many of those that fit better than both beside them are solved; and how far off places may be that are
compared: others may have been bent."""
SAME_RAD = 0.35
"""Turns nearer to each other than this are the same."""


def turned_starts(problem: Problem, x: Array, number: int) -> list[Array]:
    """Estimates with a unit's way turned, flat: by angles that fit better than those beside them, best first.

    Args:
        problem: of a window, in which the unit may face anything.
        x: where all are, flat; he on the way that his unit has led him.
        number: of the node.
    """
    index, rows = _index(problem.layout, number), problem.rows
    since = reports_from(problem.layout, index)
    centre_m = problem.layout.states(x, index)[since, :2].copy()
    sigma, starts, costs = loosened(rows, SLACK_M), list[Array](), np.empty(ANGLES)
    for j in range(ANGLES):
        there = x.copy()
        turn(problem.layout, there, index, Flip(since, facing(centre_m, 2.0 * np.pi * j / ANGLES)))
        costs[j] = mixture_cost(rows.residual(there), sigma, *rows.noise.T).sum()
        starts.append(there)
    lowest = np.flatnonzero((costs <= np.roll(costs, 1)) & (costs < np.roll(costs, -1)))
    return [starts[j] for j in lowest[np.argsort(costs[lowest], kind="stable")][:TRIED]]


def as_turned(problem: Problem, x: Array, number: int) -> tuple[Mounting, Array]:
    """By how much a unit is turned in a solution, and that solution as that of a unit worn so, flat.

    Args:
        problem: of a window, in which the unit may face anything.
        x: its solution, flat.
        number: of the node.
    """
    layout, index = problem.layout, _index(problem.layout, number)
    walk, there = layout.walks[index], x.copy()
    states = layout.states(there, index)
    by_rad = float(states[reports_from(layout, index), HEADING]) - told_turn(layout, number)[0]
    states[walk.first : walk.last + 1, HEADING] -= by_rad
    return Mounting(False, within_pi(layout.state.life(number).worn[1] + by_rad)), there


def same_turn(one: Mounting, other: Mounting) -> bool:
    """Whether two ways of wearing a unit are nearly the same."""
    return one.mirrored == other.mirrored and abs(within_pi(one.turned_rad - other.turned_rad)) < SAME_RAD


def told_turn(layout: Layout, number: int) -> tuple[float, float]:
    """What ψ was told to be where the unit of a node began: mean and standard deviation (rad)."""
    begins = layout.state.ledger.table("begins")
    mean_rad, sigma_rad = begins[(begins[:, 1] == number) & (begins[:, 2] == 1.0)][-1, 10:12].tolist()
    return mean_rad, sigma_rad


def _index(layout: Layout, number: int) -> int:
    return next(i for i, walk in enumerate(layout.walks) if walk.number == number)
