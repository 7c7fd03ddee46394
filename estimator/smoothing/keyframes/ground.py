"""What places the ends of readings in a window: which of its numbers each of them depends on."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.displacement_sums import SummedEnds, Ways, set_sums_of, ways_of
from estimator.smoothing.keyframes.ends import FIXED, FREE, STANDING, UNIT, UNPLACED, Table
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES


class Nodes(NamedTuple):
    """What each node of the ledger is in a window, by its number.

    Attributes:
        kind: one of `ends`, from `FIXED` on, n.
        walk: which of the window's walks, n; −1: none.
        column: first of its three columns in the border, n; −1: none.
        fixed_m: where it is, if it is fixed, n × 3 (m).
    """

    kind: Integers
    walk: Integers
    column: Integers
    fixed_m: Array


def nodes_of(layout: Layout) -> Nodes:
    """What each node is in the window."""
    count = len(layout.state.owners) + 1
    found = Nodes(
        np.full(count, UNPLACED),
        np.full(count, -1, dtype=np.int64),
        np.full(count, -1, dtype=np.int64),
        np.zeros((count, 3)),
    )
    for node in layout.state.lives():
        if node.place_m is not None and node.role == "base":
            found.kind[node.index], found.fixed_m[node.index] = FIXED, node.place_m
    for number, start in layout.stands.items():
        found.kind[number], found.column[number] = STANDING, start
    for i, walk in enumerate(layout.walks):
        found.kind[walk.number], found.walk[walk.number] = FREE if walk.way is None else UNIT, i
    return found


class Supports(NamedTuple):
    """Between which numbers of a window m ends of readings are.

    Attributes:
        kind: what node each is of, m.
        slab: keyframe of each, m; 0 where it stands.
        columns: its columns, m × 6: of the keyframe, or of the border counted after it; −1: none.
        flat: where they are in the flat unknowns, m × 6; 0 where there is none.
        fixed_m: where it is, if it is fixed, m × 3 (m).
        since_t: epoch of its keyframe, if it moves, m (s).
        usable: whether each has a place in the window at its epoch, m.
    """

    kind: Integers
    slab: Integers
    columns: Integers
    flat: Integers
    fixed_m: Array
    since_t: Array
    usable: NDArray[np.bool_]


@njit(cache=True)
def supports_of(
    nodes: Nodes,
    numbers: Integers,
    t: Array,
    nearest: NDArray[np.bool_],
    grid: Array,
    times: Array,
    lives: Integers,
) -> Supports:
    """For each end of a reading: the keyframe or border numbers that its place depends on.

    Args:
        nodes: what each node is.
        numbers: the node of each end, m.
        t: epochs, m (s).
        nearest: of a moving node, the nearest keyframe; else the one before, m.
        grid: epochs of the keyframes, k (s).
        times: those of each walk, k × walks (s).
        lives: first and last keyframe of each walk, walks × 2.
    """
    m, length, width = len(numbers), len(grid), STATES * len(lives)
    kind, slab, since = np.empty(m, dtype=np.int64), np.zeros(m, dtype=np.int64), t.copy()
    columns, flat = np.full((m, STATES), -1), np.zeros((m, STATES), dtype=np.int64)
    fixed, usable = np.zeros((m, 3)), np.empty(m, dtype=np.bool_)
    kinds, walks, starts, places = nodes.kind, nodes.walk, nodes.column, nodes.fixed_m
    for i in range(m):
        number = numbers[i]
        kind[i], walk = kinds[number], walks[number]
        usable[i] = kind[i] != UNPLACED
        if kind[i] == FIXED:
            fixed[i] = places[number]
        elif kind[i] == STANDING:
            for c in range(3):
                columns[i, c] = width + starts[number] + c
                flat[i, c] = length * width + starts[number] + c
        elif usable[i]:
            first, last = lives[walk, 0], lives[walk, 1]
            at = np.searchsorted(grid, t[i], side="right") - 1
            around = min(max(at, 0), length - 2)
            if nearest[i] and t[i] - grid[around] > grid[around + 1] - t[i]:
                at = around + 1
            at = min(max(at, first), last)
            usable[i] = t[i] >= times[first, walk] - 1e-6
            slab[i], since[i] = at, times[at, walk]
            for c in range(STATES):
                columns[i, c] = STATES * walk + c
                flat[i, c] = at * width + columns[i, c]
    return Supports(kind, slab, columns, flat, fixed, since, usable)


class Ground(NamedTuple):
    """What places the ends of readings in a window: its nodes, keyframes and displacement sums.

    Attributes:
        nodes: what each node of the ledger is.
        grid: epochs of the keyframes, k (s).
        times: those of each walk, k × walks (s).
        spans: first and last keyframe of each walk, walks × 2.
        ways: of the units.
    """

    nodes: Nodes
    grid: Array
    times: Array
    spans: Integers
    ways: Ways


def ground_of(layout: Layout) -> Ground:
    """The `Ground` of a window, as arrays for compiled loops."""
    units = [(walk.number, walk.way) for walk in layout.walks if walk.way is not None]
    ways = ways_of([number for number, _ in units], [way for _, way in units])
    return Ground(nodes_of(layout), layout.grid, layout.times, layout.spans, ways)


class Ends(NamedTuple):
    """m ends of readings.

    Attributes:
        stood: between which numbers of the window they are.
        unsure_m2: variances that a unit's own noise adds since its keyframe, m × 3 (m²).
        table: what its place follows from.
    """

    stood: Supports
    unsure_m2: Array
    table: Table


@njit(cache=True)
def ends_of(ground: Ground, numbers: Integers, t: Array, nearest: NDArray[np.bool_]) -> Ends:
    """Ends of readings in a window.

    Args:
        ground: of the window.
        numbers: the node of each end, m.
        t: epochs, m (s).
        nearest: see `supports_of`, m.
    """
    m, ways = len(numbers), ground.ways
    stood = supports_of(ground.nodes, numbers, t, nearest, ground.grid, ground.times, ground.spans)
    laid = SummedEnds(np.zeros((m, 3)), np.zeros((m, 3)), np.zeros((m, 3)))
    for w in range(len(ways.numbers) if m else 0):
        own = slice(ways.firsts[w], ways.firsts[w + 1])
        told = ways.begin_t[w], ways.marks[own], ways.sums[own]
        set_sums_of(*told, ways.numbers[w], numbers, stood.since_t, t, laid)
    table = Table(stood.kind, stood.flat, stood.fixed_m, laid.delta_m, laid.moment, t - stood.since_t)
    return Ends(stood, laid.unsure_m2, table)


@njit(cache=True)
def selected_ends(ends: Ends, chosen: NDArray[np.bool_]) -> Ends:
    """Some of m ends.

    Args:
        ends: all of them.
        chosen: which, m.
    """
    if chosen.all():
        return ends
    stood, table = ends.stood, ends.table
    kind, flat, fixed_m = stood.kind[chosen], stood.flat[chosen], stood.fixed_m[chosen]
    since_t = stood.since_t[chosen]
    some = Supports(
        kind, stood.slab[chosen], stood.columns[chosen], flat, fixed_m, since_t, stood.usable[chosen]
    )
    delta_m, moment, duration_s = table.delta_m[chosen], table.moment[chosen], table.duration_s[chosen]
    return Ends(some, ends.unsure_m2[chosen], Table(kind, flat, fixed_m, delta_m, moment, duration_s))
