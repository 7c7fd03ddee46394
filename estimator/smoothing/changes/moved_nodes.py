"""Nodes that lie somewhere else than they did (decision 0022).

A breadcrumb may be kicked or carried: from some epoch on its readings disagree with its place, and agree with
another one.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.entering.modes import CAUCHY, costs_of
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.motion.unreliable_unit import leads_astray
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.graph.robust import cauchy_cost
from estimator.smoothing.changes.drawing_nodes import drawing_nodes
from estimator.smoothing.changes.masked_outliers import masked_place
from estimator.smoothing.changes.relocation import (
    GAIN,
    NEW_S,
    READINGS_MIN,
    USUAL_COST,
    MovedNode,
    Place,
    best_place,
    changed_t,
    contradicted,
    may_be_kicked,
)
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.pauses import paused_until
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

ALL_KINDS, BY_KIND = ((RANGE, RSSI),), ((RANGE,), (RSSI,))
"""Kinds of readings that are asked together. Signals from afar say little of a place: among them ranges that
disagree are not noticed. Where a window has not come to rest, its residuals are its own: there all are asked
together, and one kind alone raises a suspicion, unless all others gain without the newest ranges."""
RECENT_S = 120.0
SUSPICION = 6.0
"""How much worse than usual, in log likelihood, readings are together before another place is looked for."""
DOUBT = 1.5
"""The same of the newest readings before a window is solved again soon."""
LATEST = 3
"""So many later beginnings of a disagreement are looked at as well."""
SWITCHED_S, ASKED_S = 30.0, 10.0
"""For so long a unit that was switched on again may face elsewhere, and nobody knows yet; so long it takes to
find what has become of one that readings contradict, if it is found."""
CLEARER = 5.0
"""So much better, in log likelihood, all readings must fit with the one elsewhere than with another one."""


def moved_nodes(
    problem: Problem, solved: Solution, recent_s: float = RECENT_S
) -> tuple[list[MovedNode], bool]:
    """The standing nodes that readings put elsewhere, and whether some others may be elsewhere.

    Asked is one reading of each link a second, see `Rows.rarer`: what a disagreement is to be is counted in
    readings.

    Args:
        problem: of the window.
        solved: its solution.
        recent_s: how old readings may be (s).
    """
    state, whole = problem.layout.state, problem
    chosen, rows = problem.rows.rarer()
    problem = problem.with_rows(rows)
    m = len(rows.pairs)
    kinds = rows.pairs[:, 1]
    now = float(problem.layout.grid[-1])
    recent = chosen[(rows.pairs[chosen, 0] > now - recent_s) & (kinds[chosen] <= RSSI)]
    # Who may be elsewhere himself tells of no breadcrumb where it lies.
    recent = recent[~np.isin(rows.pairs[recent, 2:4], _astray(problem.layout, now)).any(axis=1)]
    recent = recent[np.argsort(rows.pairs[recent, 0], kind="stable")]
    measured = {float(kind) for kind in (RANGE, RSSI) if (kinds[recent] == kind).any()}
    residual, sigma = solved.linear.residual[recent], rows.sigma[recent]
    cost, usual = np.empty(m), np.empty(m)
    cost[recent] = cauchy_cost(residual / sigma, CAUCHY)
    usual[recent] = costs_of(residual, sigma, rows.noise[recent], kinds[recent] == RANGE, rows.alike[recent])
    found: dict[str, tuple[Place, MovedNode]] = {}
    suspected, doubted = False, dict[str, Integers]()
    first, told = by_node(recent, rows.pairs, len(state.owners))
    for node in filter(may_be_kicked, state.nodes.values()):
        for together in BY_KIND if solved.rests else (*ALL_KINDS, *BY_KIND):
            if measured.isdisjoint(together):
                continue
            kind = -1 if together in ALL_KINDS else together[0]
            own, mine, suspicious, after, before = test_place(
                told[first[node.index] : first[node.index + 1]],
                rows.pairs,
                node.index,
                kind,
                usual,
                cost,
                now - NEW_S,
            )
            if len(mine) < READINGS_MIN:
                continue
            suspected = suspected or suspicious
            asked = solved.rests or together in ALL_KINDS
            if not asked and together != (RANGE,):
                continue
            parts = [mine[first:] for first in after.tolist()]
            # It may be drawn to its new place already: then what disagrees lies in front.
            parts += [mine[: len(mine) - first] for first in before.tolist()]
            place, by = best_place(problem, solved, node, parts) if asked else None, solved
            if together == (RANGE,) and parts:
                since = _since(rows.pairs, node.index, parts[0])
                # Less than that nobody gains who is drawn to where he is not; walls are no reason to ask.
                if rows.pairs[since[-1], 0] > now - NEW_S and usual[parts[0]].sum() > GAIN:
                    doubted[node.node] = since
            if place is None and together == (RANGE,) and parts and rows.pairs[parts[0][0], 0] > now - NEW_S:
                drawn = masked_place(whole, solved, node, since)
                if drawn is not None:
                    place, by = drawn.place, drawn.alone
            if place is None:
                continue
            since_t = changed_t(problem, by, node, mine, place)
            later = own[rows.pairs[own, 0] >= since_t]
            if RANGE not in together and contradicted(problem, solved, node, later, place.position_m):
                suspected = True
                continue
            found[node.node] = place, MovedNode(node.node, since_t, len(later))
            break
    if not solved.rests:
        return [moved for _, moved in found.values()], suspected
    drawing = drawing_nodes(whole, solved, doubted, now)
    if drawing:
        for name in doubted.keys() & found.keys():
            place, moved = found[name]
            drawing[name] = max(drawing.get(name, (0.0, moved)), (place.gain, moved))
        return _likeliest(list(drawing.values())), True
    # One that lies elsewhere makes its neighbours seem to, but less far: they are asked again without it.
    farthest = max(found.values(), key=lambda one: one[0].far_m, default=None)
    return [] if farthest is None else [farthest[1]], suspected or len(found) > 1


def _astray(layout: Layout, now: float) -> list[int]:
    """Numbers of those whose units may lead them astray: contradicted lately, or just switched on again."""
    found, since_t = list[int](), layout.state.astray_t
    newly = since_t is not None and now < since_t + ASKED_S
    for walk in layout.walks:
        node = layout.state.life(walk.number)
        if walk.way is not None and node.index == walk.number and node.mode == "unit":
            paused = paused_until(node, walk.way, now - SWITCHED_S, now) is not None
            found += [walk.number] if paused or (newly and leads_astray(node)) else []
    return found


def _likeliest(drawing: Sequence[tuple[float, MovedNode]]) -> list[MovedNode]:
    """The one with which elsewhere all gain most; of two that explain the same as well it is not known."""
    (gain, moved), *others = sorted(drawing, reverse=True)
    return [moved] if not others or gain > others[0][0] + CLEARER else []


def _since(pairs: Array, number: int, mine: Integers) -> Integers:
    """All ranges to a node since the first of some of them, in order of epoch."""
    to = (pairs[:, 2] == number) | (pairs[:, 3] == number)
    found = np.flatnonzero(to & (pairs[:, 1] == RANGE) & (pairs[:, 0] >= pairs[mine[0], 0]))
    return found[np.argsort(pairs[found, 0], kind="stable")]


class PlaceTest(NamedTuple):
    """What readings to a node say of its place.

    Attributes:
        own: the readings to it, in order of epoch.
        mine: those of them that are asked.
        suspicious: it may lie elsewhere.
        since: from which of those on they may disagree with its place, see `disagreeing`.
        before: before which of the last ones they may, counted from the end; one at most.
    """

    own: Integers
    mine: Integers
    suspicious: bool
    since: Integers
    before: Integers


@njit(cache=True)
def by_node(recent: Integers, pairs: Array, count: int) -> tuple[Integers, Integers]:
    """Readings node by node, those of each in their order: each is gone through for its two nodes only.

    Args:
        recent: the readings, r.
        pairs: all of them, as rows of the ledger, m × 11.
        count: how many nodes there are.

    Returns:
        Where those of each node begin, count + 1, and the readings, 2 r.
    """
    first, found = np.zeros(count + 1, dtype=np.int64), np.empty(2 * len(recent), dtype=np.int64)
    for i in recent:
        for end in (2, 3):
            first[int(pairs[i, end]) + 1] += 1
    first = first.cumsum()
    free = first.copy()
    for i in recent:
        for end in (2, 3):
            node = int(pairs[i, end])
            found[free[node]] = i
            free[node] += 1
    return first, found


@njit(cache=True)
def test_place(
    told: Integers, pairs: Array, number: int, kind: int, usual: Array, cost: Array, new_t: float
) -> PlaceTest:
    """Ask the readings to one node whether they disagree with its place.

    Args:
        told: readings, in order of epoch, those to it among them.
        pairs: all of them, as rows of the ledger, m × 11.
        number: of the node.
        kind: of those that are asked; −1: all are.
        usual: what each of those readings costs, walls among them, in log likelihood, m.
        cost: what each of them costs, m.
        new_t: epoch since which readings are new (s).
    """
    own, mine, newest = np.empty_like(told), np.empty_like(told), np.empty_like(told)
    all_of, some, new = 0, 0, 0
    for i in told:
        if pairs[i, 2] == number or pairs[i, 3] == number:
            own[all_of], all_of = i, all_of + 1
            if kind < 0 or pairs[i, 1] == kind:
                mine[some], some = i, some + 1
                if pairs[i, 0] > new_t:
                    newest[new], new = i, new + 1
    own, mine, newest = own[:all_of], mine[:some], newest[:new]
    # Walls disagree with places all the time: not for them is a window solved again sooner.
    suspicious = len(disagreeing(usual[mine], SUSPICION)) > 0 or len(disagreeing(usual[newest], DOUBT)) > 0
    backwards = disagreeing(cost[mine][::-1].copy(), SUSPICION)[:1]
    return PlaceTest(own, mine, suspicious, disagreeing(cost[mine], SUSPICION), backwards)


@njit(cache=True)
def disagreeing(cost: Array, least: float) -> Integers:
    """From where on readings, in order of epoch, may disagree with a place by their costs.

    Where they do most of all in front, then the latest ones at which they begin to: an outlier from before
    the node was moved belongs to its old place.

    Args:
        cost: of each reading, in log likelihood, m.
        least: how much worse than usual they are together.
    """
    last = len(cost) - READINGS_MIN + 1
    found, count = np.empty(1 + LATEST, dtype=np.int64), 0
    from_here, worst, first, total = np.empty(max(last, 0)), -np.inf, -1, 0.0
    for i in range(len(cost) - 1, -1, -1):
        total += cost[i] - USUAL_COST
        if i < last:
            from_here[i] = total
            if total >= worst:
                worst, first = total, i
    if first < 0 or worst < least:
        return found[:0]
    begun = 0
    for i in range(last - 1, -1, -1):
        begins = cost[i] > USUAL_COST and (i == 0 or not cost[i - 1] > USUAL_COST)
        if begins and from_here[i] >= least and begun < LATEST:
            begun += 1
            if i != first:
                count += 1
                found[1 + LATEST - count] = i
    found[LATEST - count] = first
    return found[LATEST - count :]
