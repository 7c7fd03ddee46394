"""Where nodes stood a moment ago, from where their blocks are now."""

from itertools import chain
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array

Mark = tuple[float, float, float, float]
"""An epoch, and the displacement summed up to it (m)."""
NOWHERE = (0.0, 0.0, 0.0)
NOBODY_FACES = (0.0, 0.0)
STANDS, WALKS, DRIFTS = range(3)
"""How a node moves: not at all, as its unit's trail says, with the velocity of its block."""


class TrailEnd(NamedTuple):
    """A node at one end of a tick's readings, as a row of numbers.

    Attributes:
        start: where the block of its position starts; −1: it is fixed, or its position is not decided.
        moves: `STANDS`, `WALKS` or `DRIFTS`.
        states: where the block of its velocity or of its unit's errors starts; −1: it has none.
        pose_t: epoch that its position refers to.
        e: where it stands, if it is fixed (m).
        n: the same, north.
        u: the same, up.
        first: its first mark among those of the tick.
        last: its last one.
        block: its number in the ledger.
        way_m: length of its way so far.
        decided: readings can be held against its position.
        outside: no floor can be between it and another node.
        turned: nobody knows what its unit faces.
        faced_e: where its bearer last went, in its unit's frame; nil where nobody knows.
        faced_n: the same, north.
    """

    start: int
    moves: int
    states: int
    pose_t: float
    e: float
    n: float
    u: float
    first: int
    last: int
    block: int
    way_m: float
    decided: bool
    outside: bool
    turned: bool
    faced_e: float
    faced_n: float


START, MOVES, STATES, POSE_T, E, N, U, FIRST, LAST, BLOCK, WAY_M, DECIDED, OUTSIDE, TURNED = range(14)
FACED_E, FACED_N = 14, 15


def end_of(state: FusionState, node: NodeState, marks: list[Mark]) -> TrailEnd:
    """A node as an end of readings; the row is valid until its graph or the node changes.

    Args:
        state: the fusion.
        node: the node.
        marks: takes its trail.
    """
    mode, starts, outside = node.mode, state.graph.starts, node.role in physics.OUTSIDE_ROLES
    if mode == "static":
        at, index, way_m = starts[node.position], node.index, node.way_m
        here = at, STANDS, -1, node.pose_t, *NOWHERE, 0, -1
        return TrailEnd(*here, index, way_m, True, outside, node.turned, *NOBODY_FACES)
    start = states = -1
    moves, first, (e, n, u), (faced_e, faced_n) = STANDS, len(marks), NOWHERE, NOBODY_FACES
    if mode == "fixed" and node.place_m is not None:
        e, n, u = node.place_m
    elif mode == "unit":
        start, states, (faced_e, faced_n) = starts[node.position], starts[node.unit], node.faced
        if len(node.trail) > 1:
            moves = WALKS
            marks.extend(node.trail)
    elif mode == "free":
        start, states, moves = starts[node.position], starts[node.velocity], DRIFTS
    last, decided = len(marks) - 1, start >= 0 or mode == "fixed"
    told = node.pose_t, e, n, u, first, last, node.index, node.way_m, decided, outside, node.turned
    return TrailEnd(start, moves, states, *told, faced_e, faced_n)


def offset_of(state: FusionState, node: NodeState, t: float) -> Vector3:
    """Where a decided node stood at `t` from its block, or, fixed, where it stands (m)."""
    marks: list[Mark] = []
    end = end_of(state, node, marks)
    if end.moves == STANDS:
        return end.e, end.n, end.u
    east, north, up = offset(np.array(end, dtype=np.float64), table_of_marks(marks), state.graph.reference, t)
    return east, north, up


@njit(cache=True, error_model="numpy")
def turned_m(offset_m: Vector3) -> float:
    """How far off a place is by which a node stood from its block, if its unit may face anything (m).

    Two ends of a length that may be turned by any angle are √2 lengths apart on average.
    """
    return float(np.sqrt(2.0 * (offset_m[0] ** 2 + offset_m[1] ** 2)))


def table_of_marks(marks: list[Mark]) -> Array:
    """Marks as a table, k × 4."""
    return np.fromiter(chain.from_iterable(marks), np.float64, 4 * len(marks)).reshape(-1, 4)


@njit(cache=True, error_model="numpy")
def offset(end: Array, marks: Array, x: Array, t: float) -> Vector3:
    """Where a node stood at `t` from its block, or, fixed, where it stands (m).

    Args:
        end: its row, see `TrailEnd`.
        marks: of the tick, k × 4.
        x: the reference of the graph, n.
        t: the epoch (s).
    """
    states = int(end[STATES])
    if end[MOVES] == DRIFTS:
        since = t - end[POSE_T]
        return x[states] * since, x[states + 1] * since, x[states + 2] * since
    if end[MOVES] == STANDS or t >= end[POSE_T]:
        return end[E], end[N], end[U]
    trail = marks[int(end[FIRST]) : int(end[LAST]) + 1]
    cosine, sine, stretch = np.cos(x[states]), np.sin(x[states]), 1.0 + x[states + 2]
    e, n, u = between(trail, t)
    e, n = (e - trail[-1, 1]) * stretch, (n - trail[-1, 2]) * stretch
    return cosine * e - sine * n, sine * e + cosine * n, u - trail[-1, 3]


@njit(cache=True, error_model="numpy")
def faced(end: Array, x: Array) -> tuple[float, float]:
    """Where the bearer of a radio faces, as a unit vector: where he last went; nil where nobody knows.

    Args:
        end: its row, see `TrailEnd`.
        x: the reference of the graph, n.
    """
    states = int(end[STATES])
    if states < 0 or end[OUTSIDE] != 0.0 or end[MOVES] == DRIFTS:
        return 0.0, 0.0
    cosine, sine = np.cos(x[states]), np.sin(x[states])
    return (
        cosine * end[FACED_E] - sine * end[FACED_N],
        sine * end[FACED_E] + cosine * end[FACED_N],
    )


@njit(cache=True, error_model="numpy")
def between(marks: Array, t: float) -> Vector3:
    """Displacement at `t` on straight lines between a trail's marks (k × 4), held beyond its ends (m)."""
    after = len(marks)
    while after > 0 and marks[after - 1, 0] > t:
        after -= 1
    if after in (0, len(marks)):
        held = marks[after - 1 if after else 0]
        return held[1], held[2], held[3]
    one, two = marks[after - 1], marks[after]
    share = (t - one[0]) / (two[0] - one[0])
    return (
        one[1] + share * (two[1] - one[1]),
        one[2] + share * (two[2] - one[2]),
        one[3] + share * (two[3] - one[3]),
    )
