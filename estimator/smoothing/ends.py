"""Where the ends of readings are, for any estimate: keyframes with what was walked since, or what stands."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.graph.dense import Array
from estimator.graph.kernels import Integers
from estimator.smoothing.layout import Layout
from estimator.smoothing.walks import STATES, lead

FIXED, STANDING, UNIT, FREE, UNPLACED = range(5)


def kinds_of(layout: Layout, numbers: Integers) -> Integers:
    """What each node is in the window."""
    table = np.full(len(layout.state.owners) + 1, UNPLACED)
    for node in layout.state.nodes.values():
        if node.place_m is not None and node.role == "base":
            table[node.index] = FIXED
    for number in layout.stands:
        table[number] = STANDING
    for walk in layout.walks:
        table[walk.number] = FREE if walk.way is None else UNIT
    return np.asarray(table[numbers])


class Table(NamedTuple):
    """m ends of readings as numbers.

    Attributes:
        kind: what node each is of, m.
        at: where its numbers are in the flat unknowns, m × 6; 0 where there is none.
        fixed_m: where it is, if it is fixed, m × 3 (m).
        delta_m: displacement since its keyframe, in the unit's frame, m × 3 (m).
        moment: its first moment, m × 3 (m s).
        duration_s: time since its keyframe, m (s).
    """

    kind: Integers
    at: Integers
    fixed_m: Array
    delta_m: Array
    moment: Array
    duration_s: Array


class Places(NamedTuple):
    """Where m ends are.

    Attributes:
        place: positions, m × 3 (m); their derivatives by the first three columns are 1, if there are any.
        turned: derivatives by the last three columns, m × 3 × 3.
    """

    place: Array
    turned: Array


@njit(cache=True)
def place_end(ends: Table, i: int, x: Array, place: Array, turned: Array) -> None:
    """Where one end is at an estimate x, flat.

    Args:
        ends: the table that it is in.
        i: its row.
        x: the estimate.
        place: takes its position, 3 (m).
        turned: takes the derivatives by the last three columns, 3 × 3; zeros before.
    """
    kind, at = ends.kind[i], ends.at[i]
    for c in range(3):
        place[c] = x[at[c]] if kind in (STANDING, UNIT, FREE) else ends.fixed_m[i, c]
    if kind == UNIT:
        led = lead(x[at[3]], x[at[4]], 1.0 + x[at[5]], ends.delta_m[i], ends.moment[i])
        place[0] += led.east
        place[1] += led.north
        place[2] += led.up
        turned[0, 0], turned[1, 0] = led.by_heading_e, led.by_heading_n
        turned[0, 1], turned[1, 1] = led.by_bias_e, led.by_bias_n
        turned[0, 2], turned[1, 2] = led.by_scale_e, led.by_scale_n
    elif kind == FREE:
        for c in range(3):
            place[c] += x[at[3 + c]] * ends.duration_s[i]
            turned[c, c] = ends.duration_s[i]


@njit(cache=True)
def place_ends(ends: Table, x: Array) -> Places:
    """Where m ends are at an estimate x, flat."""
    m = len(ends.kind)
    place, turned = np.empty((m, 3)), np.zeros((m, 3, 3))
    for i in range(m):
        place_end(ends, i, x, place[i], turned[i])
    return Places(place, turned)


class Ends:
    """m ends of readings.

    Attributes:
        slab: keyframe of each, m; 0 where it stands.
        columns: its six columns, m × 6: of the keyframe, or of the border counted after it; −1: none.
        usable: it has a place in the window at its epoch.
        moving: it is of a node that moves, m.
        unsure_m2: variances that a unit's own noise adds since its keyframe, m × 3 (m²).
        table: what its place follows from.
    """

    def __init__(self, layout: Layout, numbers: Integers, t: Array, nearest: Array) -> None:
        m = len(numbers)
        kinds = kinds_of(layout, numbers)
        self.slab = np.zeros(m, dtype=np.int64)
        self.columns = np.full((m, STATES), -1, dtype=np.int64)
        self.usable = kinds != UNPLACED
        self.unsure_m2: Array = np.zeros((m, 3))
        fixed_m, delta_m, moment, duration_s = (
            np.zeros((m, 3)),
            np.zeros((m, 3)),
            np.zeros((m, 3)),
            np.zeros(m),
        )
        names = layout.state.owners
        for number in np.unique(numbers[kinds == FIXED]).tolist():
            fixed_m[numbers == number] = layout.state.nodes[names[number]].place_m
        for number in np.unique(numbers[kinds == STANDING]).tolist():
            self.columns[numbers == number, :3] = layout.width + layout.stands[number] + np.arange(3)
        preceding = np.searchsorted(layout.grid, t, side="right") - 1
        around = np.clip(preceding, 0, layout.length - 2)
        closer = (t - layout.grid[around] > layout.grid[around + 1] - t) & nearest.astype(bool)
        keyframe = np.where(closer, around + 1, preceding)
        for i, walk in enumerate(layout.walks):
            mine = np.flatnonzero(numbers == walk.number)
            if len(mine) == 0:
                continue
            epochs = t[mine]
            at = np.clip(keyframe[mine], walk.first, walk.last)
            since = layout.times[at, i]
            self.usable[mine] &= epochs >= layout.times[walk.first, i] - 1e-6
            self.slab[mine] = at
            self.columns[mine] = STATES * i + np.arange(STATES)
            duration_s[mine] = epochs - since
            if walk.way is not None:
                found = walk.way.between(since, epochs)
                delta_m[mine], moment[mine] = found[:, :3], found[:, 3:6]
                self.unsure_m2[mine] = np.abs(found[:, [6, 6, 7]])
        self.moving = (kinds == UNIT) | (kinds == FREE)
        border = layout.length * layout.width + self.columns - layout.width
        flat = np.where(self.columns < layout.width, self.slab[:, None] * layout.width + self.columns, border)
        flat[self.columns < 0] = 0
        self.table = Table(kinds, flat, fixed_m, delta_m, moment, duration_s)

    @property
    def unit(self) -> NDArray[np.bool_]:
        """Whether each is of a node with a PDR unit, m."""
        return np.asarray(self.table.kind == UNIT)

    def take(self, chosen: Array) -> None:
        """Keep only some of the ends.

        Args:
            chosen: which, m (bool).
        """
        self.slab, self.columns, self.usable = self.slab[chosen], self.columns[chosen], self.usable[chosen]
        self.moving, self.unsure_m2 = self.moving[chosen], self.unsure_m2[chosen]
        self.table = Table(*(numbers[chosen] for numbers in self.table))
