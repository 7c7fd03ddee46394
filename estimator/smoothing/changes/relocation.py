"""Another place for a node than the one it has, from some of its readings."""

from collections.abc import Iterable
from typing import Literal, NamedTuple

import numpy as np

from estimator.fusion.entering.modes import Mode, UndecidedNode, costs_of, find_modes, residuals_of
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.nodes import NodeState
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

READINGS_MIN = 5
USUAL_COST = 1.0
GAIN = 10.0
"""How much better the other place must explain them: odds of 1 to 20,000 for one more place."""
FAR_M = 1.5
NEW_S = 30.0
"""Readings no older than this are new (s)."""
UNSURE_M = 0.3
UP_SIGMA_M = 1.0


class MovedNode(NamedTuple):
    """A node that lies elsewhere.

    Attributes:
        name: the node.
        since_t: the first epoch at which its readings agree with the new place (s).
        readings: how many were made since.
    """

    name: str
    since_t: float
    readings: int


def may_be_kicked(node: NodeState) -> bool:
    """Whether a node lies somewhere, and is not fixed there."""
    return node.mode == "static" and node.role != "anchor"


class NodeReadings(NamedTuple):
    """Readings to one node by one technology, in order of epoch.

    Attributes:
        rows: which of the problem's pairs they are, m.
        t: epochs, m (s).
        sought: what they say.
        place_m: where the node is thought to be, 3 (m).
        residual: of the readings there, m.
        noise: outliers, shift and spread of each, m × 3.
        alike: how many readings share an error, as each counts, m.
    """

    rows: Integers
    t: Array
    sought: UndecidedNode
    place_m: Array
    residual: Array
    noise: Array
    alike: Array

    def costs(self, residual: Array) -> Array:
        """What the readings cost with residuals, each in log likelihood."""
        ranged = np.full(len(residual), self.sought.kind == "range")
        return costs_of(residual, self.sought.sigma, self.noise, ranged, self.alike)

    def residual_at(self, place_m: Array) -> Array:
        """Residuals of the readings if the node were at a place (3, m), m."""
        return residuals_of(self.sought, place_m, self.sought.extra)


class Place(NamedTuple):
    """Where some readings put a node.

    Attributes:
        position_m: the place, 3 (m).
        far_m: how far it is from where the node was thought to be (m).
        gain: how much better they fit there, in log likelihood.
        seen: the readings.
    """

    position_m: Array
    far_m: float
    gain: float
    seen: NodeReadings


def readings_of(problem: Problem, solved: Solution, node: NodeState, mine: Integers) -> NodeReadings | None:
    """The readings `mine` to a node, by the technology that has most of them, ranges first."""
    rows, layout = problem.rows, problem.layout
    ranged = rows.pairs[mine, 1] == RANGE
    kind: Literal["range", "rssi"] = "range" if ranged.sum() >= READINGS_MIN else "rssi"
    mine = mine[ranged if kind == "range" else ~ranged]
    sources, counts = np.unique(rows.source[mine], return_counts=True)
    if not len(sources):
        return None
    mine = mine[rows.source[mine] == sources[np.argmax(counts)]]
    if len(mine) < READINGS_MIN:
        return None
    a, b = rows.places(solved.x)
    here = rows.pairs[mine, 2] == node.index
    place = np.where(here[:, None], a[mine], b[mine])[0]
    start = layout.length * layout.width + layout.technologies[(kind, int(rows.source[mine[0]]))]
    sought = UndecidedNode(
        kind=kind,
        points=np.where(here[:, None], b[mine], a[mine]),
        value=rows.pairs[mine, 4] - rows.pairs[mine, 7] - rows.shift[mine],
        sigma=np.hypot(rows.sigma[mine], UNSURE_M) if kind == "range" else rows.sigma[mine],
        up_m=float(place[2]),
        up_sigma_m=UP_SIGMA_M,
        extra=solved.x[start : start + 2],
        extra_covariance=np.diag([1e-6, 1e-6]),
    )
    residual, noise, alike = solved.linear.residual[mine], rows.noise[mine], rows.alike[mine]
    return NodeReadings(mine, rows.pairs[mine, 0], sought, place, residual, noise, alike)


def best_place(
    problem: Problem, solved: Solution, node: NodeState, parts: Iterable[Integers]
) -> Place | None:
    """Of some parts of a node's readings the one that most clearly puts it elsewhere, and where."""
    asked = [seen for mine in parts if (seen := readings_of(problem, solved, node, mine)) is not None]
    places = [place for seen in asked if (place := _elsewhere(seen)) is not None]
    return max(places, key=lambda place: place.gain, default=None)


def _elsewhere(seen: NodeReadings) -> Place | None:
    """A place that explains readings clearly better than the one that their node has."""
    modes = find_modes(seen.sought)
    if not modes:
        return None
    best = modes[0]
    before = float(seen.costs(seen.residual).sum())
    after = float(seen.costs(seen.residual_at(best.position_m)).sum())
    return clear_place(seen, best, before, after, max(FAR_M, 2.0 * best.sigma_m))


def clear_place(
    seen: NodeReadings, best: Mode, before: float, after: float, least_m: float = FAR_M
) -> Place | None:
    """The place of a mode, if it explains readings clearly better than the one that their node has.

    Args:
        seen: the readings.
        best: their mode.
        before: what they cost with their node where it is thought to be, in log likelihood.
        after: what they cost with it at the mode.
        least_m: how far it has to be (m).
    """
    far_m = float(np.hypot(*(best.position_m - seen.place_m)[:2]))
    clear = far_m > least_m and before - after > GAIN and after < len(seen.t)
    return Place(best.position_m, far_m, before - after, seen) if clear else None


def changed_t(problem: Problem, solved: Solution, node: NodeState, mine: Integers, place: Place) -> float:
    """When a node came from one place to another (s), by the likelihood of its readings of one technology.

    It may have lain at the other place before, and at the one that it has since, or the other way round.

    Args:
        problem: of the window.
        solved: its solution.
        node: the node.
        mine: its readings, in order of epoch.
        place: the other place.
    """
    rows, one = problem.rows, place.seen.rows[0]
    same = (rows.pairs[mine, 1] == rows.pairs[one, 1]) & (rows.source[mine] == rows.source[one])
    seen = readings_of(problem, solved, node, mine[same]) or place.seen
    gain = seen.costs(seen.residual) - seen.costs(seen.residual_at(place.position_m))
    later = np.cumsum(gain[::-1])[::-1]
    earlier = np.cumsum(gain) - gain
    there_since, there_until = int(np.argmax(later)), int(np.argmax(earlier))
    return float(seen.t[there_since if later[there_since] >= earlier[there_until] else there_until])


def contradicted(problem: Problem, solved: Solution, node: NodeState, mine: Integers, place_m: Array) -> bool:
    """Whether ranges among readings to a node fit another place worse: a fire weakens all its signals."""
    seen = readings_of(problem, solved, node, mine[problem.rows.pairs[mine, 1] == RANGE])
    return seen is not None and bool(
        seen.costs(seen.residual_at(place_m)).sum() > seen.costs(seen.residual).sum() + USUAL_COST
    )
