"""Nodes that somebody has come near to again, that lie elsewhere, and have drawn him along.

Nobody was there to see a breadcrumb kicked. Its first ranges bend the way of who comes back, and then those
nodes seem to lie elsewhere which lie where they always did. So all are asked that he has come near to after a
silence: without the ranges of which one, it being elsewhere, do all readings together fit best?
"""

import math
from collections.abc import Mapping

import numpy as np

from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.nodes import NodeState
from estimator.graph.chain_kernels import Integers
from estimator.smoothing.changes.masked_outliers import place_without
from estimator.smoothing.changes.relocation import NEW_S, READINGS_MIN, MovedNode, changed_t, may_be_kicked
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

SILENCE_S = 30.0
"""A breadcrumb that nobody ranges for so long may be kicked meanwhile."""
RECENT_S = 60.0
"""How long ago the silence may have ended."""


def drawing_nodes(
    problem: Problem, solved: Solution, doubted: Mapping[str, Integers], now: float
) -> dict[str, tuple[float, MovedNode]]:
    """Which nodes may have drawn who ranges them, each with what all readings gain with it elsewhere.

    Args:
        problem: of the window.
        solved: its solution, at rest.
        doubted: ranges that disagree with the place of their node, by node.
        now: epoch of the newest keyframe (s).

    Returns:
        By node; gains in log likelihood. Nothing where there is but one who may have.
    """
    anew = heard_anew(problem, np.concatenate(list(doubted.values())), now) if doubted else {}
    if len(anew.keys() | doubted.keys()) < 2:
        return {}
    found = _elsewhere(problem, solved, anew)
    others = {name: mine for name, mine in doubted.items() if name not in anew}
    return found | _elsewhere(problem, solved, others) if found else {}


def _elsewhere(
    problem: Problem, solved: Solution, asked: Mapping[str, Integers]
) -> dict[str, tuple[float, MovedNode]]:
    """Those nodes that readings put elsewhere, each with what all readings gain by that."""
    found = {}
    for name, mine in asked.items():
        node = problem.layout.state.nodes[name]
        drawn = place_without(problem, solved, node, mine)
        if drawn is not None:
            since_t = changed_t(problem, drawn.alone, node, mine, drawn.place)
            later = mine[problem.rows.pairs[mine, 0] >= since_t]
            found[name] = drawn.place.gain, MovedNode(name, since_t, len(later))
    return found


def heard_anew(problem: Problem, doubted: Integers, now: float) -> dict[str, Integers]:
    """The standing nodes that somebody ranges again after a silence, each with its ranges since.

    Args:
        problem: of the window.
        doubted: ranges that disagree with the place of a node: asked is whom else those have ranged who made
            them.
        now: epoch of the newest keyframe (s).
    """
    state, pairs = problem.layout.state, problem.rows.pairs
    who = np.intersect1d(pairs[doubted, 2:4], [walk.number for walk in problem.layout.walks])
    ranges = np.flatnonzero((pairs[:, 1] == RANGE) & problem.rows.held)
    ranges = ranges[np.argsort(pairs[ranges, 0], kind="stable")]
    found = {}
    for node in filter(may_be_kicked, state.nodes.values()):
        mine = ranges[(pairs[ranges, 2:4] == node.index).any(axis=1)]
        t = np.concatenate([[_unmoved_t(problem, node)], pairs[mine, 0]])
        silences = np.flatnonzero(np.diff(t) > SILENCE_S)
        if not len(silences) or t[silences[-1] + 1] <= now - RECENT_S or t[-1] <= now - NEW_S:
            continue
        since = mine[silences[-1] :]
        theirs = since[np.isin(pairs[since, 2:4], who).any(axis=1)]
        if len(np.unique(np.floor(pairs[theirs, 0]))) >= READINGS_MIN:
            found[node.node] = since
    return found


def _unmoved_t(problem: Problem, node: NodeState) -> float:
    """Until when a node is known to lie where it does without any range (s): since it was put there.

    Where it was put by ranges, as one that had been kicked, that may have been wrong from the beginning.
    """
    state = problem.layout.state
    if state.owners.index(node.node) < node.index:
        return -math.inf
    stands = state.ledger.table("stands")
    return float(stands[stands[:, 1] == node.index, 0].max(initial=-math.inf))
