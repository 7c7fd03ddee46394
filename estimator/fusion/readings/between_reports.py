"""What a bearer's place is unsure by inside a displacement over a long time, for readings of a tick."""

from collections.abc import Sequence

import numpy as np

from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.motion.long_displacements import STRAIGHT_S, UPWARDS, alike, bridged_m2
from estimator.fusion.rows.rows import SIGMA, A, B, columns_of, linearise
from estimator.graph.dense import Array


def unsure_m2(node: NodeState, t: float) -> Array:
    """Variances of where a node's bearer was at `t` for what its unit has not told, 3 (m²)."""
    return np.asarray(bridged_m2(_marks_of(node), np.array([t]))[0] * UPWARDS)


def widen(table: Array, epochs: Array, x: Array, ends: Sequence[tuple[int, NodeState]]) -> None:
    """Let readings be as unsure as what their ends' units have not told of the way between two reports.

    Args:
        table: of m readings between two nodes, see `rows.Row`; changed.
        epochs: theirs, m (s).
        x: the reference of the graph, n.
        ends: where the position of each of their nodes starts, and it.
    """
    seldom = [(start, _marks_of(node)) for start, node in ends if node.mode == "unit"]
    seldom = [(start, marks_t) for start, marks_t in seldom if (np.diff(marks_t) > STRAIGHT_S).any()]
    if not seldom or not len(table):
        return
    jacobian, residual = np.empty((len(table), 9)), np.empty(len(table))
    linearise(table, columns_of(table), x, jacobian, residual)
    for start, marks_t in seldom:
        own = np.flatnonzero((table[:, A] == start) | (table[:, B] == start))
        t = epochs[own]
        by = np.where((table[own, A] == start)[:, None], jacobian[own, :3], jacobian[own, 3:6])
        across_m2 = alike(marks_t, t) * bridged_m2(marks_t, t)
        table[own, SIGMA] = np.sqrt(table[own, SIGMA] ** 2 + across_m2 * (by**2 @ UPWARDS))


def _marks_of(node: NodeState) -> Array:
    return np.array([mark[0] for mark in node.trail])
