"""Nodes that lie somewhere else than they did, and links that have changed (estimation.md, point 9).

A breadcrumb may be kicked or carried: from some epoch on its readings disagree with its place, and agree with
another one. A link between two nodes that stay may lose power for good: paper A takes that for a sign of
fire.
"""

from collections.abc import Sequence
from operator import itemgetter
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.ledger import RANGE, RSSI
from estimator.fusion.modes import CAUCHY, Sought, find_modes
from estimator.fusion.nodes import NodeState
from estimator.graph.dense import Array
from estimator.graph.kernels import Integers
from estimator.graph.robust import cauchy_cost, mixture_cost
from estimator.measurements.range import predict_range
from estimator.measurements.rssi import predict_rssi
from estimator.smoothing.solve import Problem, Solved

Flags = NDArray[np.bool_]

ALL_KINDS, BY_KIND = ((RANGE, RSSI),), ((RANGE,), (RSSI,))
"""Kinds of readings that are asked together. Signals from afar say little of a place: among them ranges that
disagree are not noticed. Where a window has not come to rest, its residuals are its own: there all are asked
together, and one kind alone only raises a suspicion."""
RECENT_S = 120.0
READINGS_MIN = 5
SUSPICION = 6.0
"""How much worse than usual, in log likelihood, readings are together before another place is looked for."""
DOUBT, NEW_S = 1.5, 30.0
"""The same of the newest readings before a window is solved again soon."""
USUAL_COST = 1.0
LATEST = 3
"""So many later beginnings of a disagreement are looked at as well."""
GAIN = 10.0
"""How much better the other place must explain them: odds of 1 to 20,000 for one more place."""
FAR_M = 1.5
UNSURE_M = 0.3
UP_SIGMA_M = 1.0
CHANGED_DB = 8.0
CHANGED_SIGMAS = 4.0
LEAST_SPREAD_DB = 4.0
BEFORE_S, AFTER_S = 30.0, 20.0
LINK_READINGS_MIN = 4


class Moved(NamedTuple):
    """A node that lies elsewhere.

    Attributes:
        name: the node.
        since_t: the first epoch at which its readings agree with the new place (s).
        readings: how many were made since.
    """

    name: str
    since_t: float
    readings: int


class Changed(NamedTuple):
    """A link between two nodes that stay, whose power has changed: names, epoch (s), change (dB)."""

    a: str
    b: str
    t: float
    change_db: float


def moved_nodes(problem: Problem, solved: Solved) -> tuple[list[Moved], bool]:
    """The standing nodes that the newest readings put elsewhere, and whether some others may be elsewhere."""
    state, rows = problem.layout.state, problem.rows
    m = len(rows.pairs)
    kinds = rows.pairs[:, 1]
    now = float(problem.layout.grid[-1])
    residual, sigma = solved.linear.residual[:m], rows.sigma[:m]
    cost = cauchy_cost(residual / sigma, CAUCHY)
    usual = _costs(residual, sigma, rows.noise[:m], kinds == RANGE, rows.alike[:m])
    recent = (rows.pairs[:, 0] > now - RECENT_S) & (kinds <= RSSI)
    found: list[tuple[float, Moved]] = []
    suspected = False
    for node in state.nodes.values():
        if node.mode != "static" or node.role == "anchor":
            continue
        own = recent & ((rows.pairs[:, 2] == node.index) | (rows.pairs[:, 3] == node.index))
        for together in BY_KIND if solved.rests else (*ALL_KINDS, *BY_KIND):
            mine = np.flatnonzero(own & np.isin(kinds, together))
            mine = mine[np.argsort(rows.pairs[mine, 0], kind="stable")]
            # Walls disagree with places all the time: not for them is a window solved again sooner.
            newest = mine[rows.pairs[mine, 0] > now - NEW_S]
            suspected = suspected or bool(_disagreeing(usual[mine]) or _disagreeing(usual[newest], DOUBT))
            starts = _disagreeing(cost[mine])
            if not starts:
                continue
            judged = solved.rests or together in ALL_KINDS
            better = _better(problem, solved, node, [mine[first:] for first in starts]) if judged else None
            if better is None:
                continue
            seen, place = better
            # What drew the node off its place may be the newest readings, and what disagrees all the others.
            still = _disagreeing(seen.costs(seen.residual_at(place.position_m)))
            since_t = float(seen.t[still[0] if still else 0])
            moved = Moved(node.node, since_t, int((rows.pairs[own, 0] >= since_t).sum()))
            if RANGE not in together and _contradicted(problem, solved, node, place.position_m, since_t):
                suspected = True
                continue
            found.append((place.far_m, moved))
            break
    if solved.rests and found:
        # One that lies elsewhere makes its neighbours seem to, but less far: they are asked again without it.
        return [max(found, key=itemgetter(0))[1]], suspected or len(found) > 1
    return [moved for _, moved in found], suspected


def _costs(residual: Array, sigma: Array, noise: Array, ranged: Flags, alike: Array) -> Array:
    """How much readings are worse than perfect ones, each in log likelihood.

    A wall makes all ranges too long that are measured through it. k of them that may share it are neither k
    witnesses nor one: they count as 2 √k.
    """
    at_best = np.zeros(len(sigma))
    cost = mixture_cost(residual, sigma, *noise.T) - mixture_cost(at_best, sigma, *noise.T)
    cost = np.minimum(cost, cauchy_cost(residual / sigma, CAUCHY))
    return np.where(ranged & (residual > 0.0), cost / np.sqrt(alike), cost)


def _disagreeing(cost: Array, least: float = SUSPICION) -> list[int]:
    """From where on readings, in order of epoch, may disagree with a place by their costs.

    Where they do most of all in front, then the latest ones at which they begin to: an outlier from before
    the node was moved belongs to its old place.
    """
    if len(cost) < READINGS_MIN:
        return []
    last = len(cost) - READINGS_MIN + 1
    from_here = np.cumsum((cost - USUAL_COST)[::-1])[::-1][:last]
    bad = cost > USUAL_COST
    begins = bad[:last] & ~np.concatenate([[False], bad[: last - 1]]) & (from_here >= least)
    first = int(np.argmax(from_here))
    if from_here[first] < least:
        return []
    return [first, *(i for i in np.flatnonzero(begins)[-LATEST:].tolist() if i != first)]


class _Seen(NamedTuple):
    """Readings to one node by one technology.

    Attributes:
        t: epochs, m (s).
        sought: what they say.
        place_m: where the node is thought to be, 3 (m).
        residual: of the readings there, m.
        noise: outliers, shift and spread of each, m × 3.
        alike: how many readings share an error, as each counts, m.
    """

    t: Array
    sought: Sought
    place_m: Array
    residual: Array
    noise: Array
    alike: Array

    def costs(self, residual: Array) -> Array:
        """What the readings cost with residuals, each in log likelihood."""
        ranged = np.full(len(residual), self.sought.kind == "range")
        return _costs(residual, self.sought.sigma, self.noise, ranged, self.alike)

    def residual_at(self, place_m: Array) -> Array:
        """Residuals of the readings if the node were at a place (3, m), m."""
        sought, ones = self.sought, np.ones(len(self.t))
        predict = predict_range if sought.kind == "range" else predict_rssi
        there = np.tile(place_m, (len(self.t), 1))
        return sought.value - predict(sought.points, there, *(ones * e for e in sought.extra)).predicted


def _seen(problem: Problem, solved: Solved, node: NodeState, mine: Integers) -> _Seen | None:
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
    sought = Sought(
        kind=kind,
        points=np.where(here[:, None], b[mine], a[mine]),
        value=rows.pairs[mine, 4] - rows.pairs[mine, 7],
        sigma=np.hypot(rows.sigma[mine], UNSURE_M) if kind == "range" else rows.sigma[mine],
        up_m=float(place[2]),
        up_sigma_m=UP_SIGMA_M,
        extra=solved.x[start : start + 2],
        extra_covariance=np.diag([1e-6, 1e-6]),
    )
    residual, noise, alike = solved.linear.residual[mine], rows.noise[mine], rows.alike[mine]
    return _Seen(rows.pairs[mine, 0], sought, place, residual, noise, alike)


class _Place(NamedTuple):
    """Where readings put a node.

    Attributes:
        position_m: the place, 3 (m).
        far_m: how far it is from where the node was thought to be (m).
        gain: how much better they fit there, in log likelihood.
    """

    position_m: Array
    far_m: float
    gain: float


def _elsewhere(seen: _Seen) -> _Place | None:
    """A place that explains readings clearly better than the one that their node has."""
    modes = find_modes(seen.sought)
    if not modes:
        return None
    best = modes[0]
    before = float(seen.costs(seen.residual).sum())
    after = float(seen.costs(seen.residual_at(best.position_m)).sum())
    far_m = float(np.hypot(*(best.position_m - seen.place_m)[:2]))
    clear = far_m > max(FAR_M, 2.0 * best.sigma_m) and before - after > GAIN and after < len(seen.t)
    return _Place(best.position_m, far_m, before - after) if clear else None


def _better(
    problem: Problem, solved: Solved, node: NodeState, parts: Sequence[Integers]
) -> tuple[_Seen, _Place] | None:
    """The part of a node's readings that most clearly puts it elsewhere, and where."""
    asked = [seen for mine in parts if (seen := _seen(problem, solved, node, mine)) is not None]
    better = [(seen, place) for seen in asked if (place := _elsewhere(seen)) is not None]
    return max(better, key=lambda one: one[1].gain, default=None)


def _contradicted(problem: Problem, solved: Solved, node: NodeState, place_m: Array, since_t: float) -> bool:
    """Whether a node's ranges since an epoch fit another place worse: a fire weakens all its signals."""
    pairs = problem.rows.pairs
    own = (pairs[:, 2] == node.index) | (pairs[:, 3] == node.index)
    ranges = np.flatnonzero(own & (pairs[:, 1] == RANGE) & (pairs[:, 0] >= since_t))
    seen = _seen(problem, solved, node, ranges)
    return seen is not None and bool(
        seen.costs(seen.residual_at(place_m)).sum() > seen.costs(seen.residual).sum() + USUAL_COST
    )


def changed_links(problem: Problem) -> list[Changed]:
    """Links between standing nodes whose power has lastingly changed in the last seconds of the window."""
    layout, pairs = problem.layout, problem.rows.pairs
    standing = np.array([*layout.stands, -1.0])
    now = float(layout.grid[-1])
    still = np.isin(pairs[:, 2], standing) & np.isin(pairs[:, 3], standing) & (pairs[:, 1] == RSSI)
    found = []
    # A node that was moved keeps its links, and has another number at its new place.
    between = np.column_stack([np.sort(pairs[:, 2:4], axis=1), pairs[:, 9]])
    for link in np.unique(between[still], axis=0):
        mine = pairs[still & (between == link).all(axis=1)]
        after, before = mine[mine[:, 0] > now - AFTER_S], mine[mine[:, 0] < now - BEFORE_S]
        if len(after) < LINK_READINGS_MIN or len(before) < LINK_READINGS_MIN:
            continue
        change = float(np.median(after[:, 4]) - np.median(before[:, 4]))
        spread = max(float(np.std(before[:, 4])), LEAST_SPREAD_DB)
        spread *= float(np.sqrt(1.0 / len(after) + 1.0 / len(before)))
        if abs(change) > max(CHANGED_DB, CHANGED_SIGMAS * spread):
            names = [layout.state.owners[int(n)] for n in mine[0, 2:4]]
            found.append(Changed(names[0], names[1], float(after[0, 0]), change))
    return found


def renumber(pairs: Array, old: int, new: int, since_t: float) -> Array:
    """The ledger's pairs with a node's new number from an epoch on."""
    later = pairs[:, 0] >= since_t
    changed: Array = pairs.copy()
    for column in (2, 3):
        changed[later & (pairs[:, column] == old), column] = new
    return changed
