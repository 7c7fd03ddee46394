"""Where the ends of readings are, for any estimate: keyframes with what was walked since, or what stands."""

import numpy as np

from estimator.graph.dense import Array
from estimator.graph.kernels import Integers
from estimator.smoothing.layout import Layout
from estimator.smoothing.walks import STATES, led_by

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


class Ends:
    """m ends of readings.

    Attributes:
        slab: keyframe of each, m; 0 where it stands.
        columns: its six columns, m × 6: of the keyframe, or of the border counted after it; −1: none.
        usable: it has a place in the window at its epoch.
        unsure_m2: variances that a unit's own noise adds since its keyframe, m × 3 (m²).
    """

    def __init__(self, layout: Layout, numbers: Integers, t: Array, nearest: Array) -> None:
        m = len(numbers)
        self._kinds = kinds_of(layout, numbers)
        self._size = layout.length * layout.width
        self.slab = np.zeros(m, dtype=np.int64)
        self.columns = np.full((m, STATES), -1, dtype=np.int64)
        self.usable = self._kinds != UNPLACED
        self._still: Array = np.zeros((m, 3))
        self._delta: Array = np.zeros((m, 3))
        self._moment: Array = np.zeros((m, 3))
        self._duration: Array = np.zeros(m)
        self.unsure_m2: Array = np.zeros((m, 3))
        names = layout.state.owners
        for number in np.unique(numbers[self._kinds == FIXED]).tolist():
            place = layout.state.nodes[names[number]].place_m
            self._still[numbers == number] = place
        for number in np.unique(numbers[self._kinds == STANDING]).tolist():
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
            self._duration[mine] = epochs - since
            if walk.way is not None:
                found = walk.way.between(since, epochs)
                self._delta[mine], self._moment[mine] = found[:, :3], found[:, 3:6]
                self.unsure_m2[mine] = np.abs(found[:, [6, 6, 7]])
        self.moving = (self._kinds == UNIT) | (self._kinds == FREE)
        self.unit = self._kinds == UNIT

    def take(self, chosen: Array) -> None:
        """Keep only some of the ends.

        Args:
            chosen: which, m (bool).
        """
        for name in (
            "_kinds",
            "slab",
            "columns",
            "usable",
            "_still",
            "_delta",
            "_moment",
            "_duration",
            "unsure_m2",
        ):
            setattr(self, name, getattr(self, name)[chosen])
        self.moving, self.unit = self.moving[chosen], self.unit[chosen]

    def flat(self, width: int) -> Integers:
        """Index of each column in the flat unknowns, m × 6; 0 where there is none."""
        border = self._size + self.columns - width
        keyframe = self.slab[:, None] * width + self.columns
        return np.where(self.columns < 0, 0, np.where(self.columns < width, keyframe, border))

    def place(self, x: Array, width: int) -> tuple[Array, Array]:
        """Positions, m × 3 (m), and their derivatives by the six columns, m × 3 × 6."""
        own = np.where(self.columns >= 0, x[self.flat(width)], 0.0)
        place = self._still + own[:, :3]
        derivative = np.zeros((len(own), 3, STATES))
        used = self.columns[:, 0] >= 0
        derivative[used, :, :3] = np.eye(3)
        unit = self.unit
        if unit.any():
            led, transition = led_by(own[unit], self._delta[unit], self._moment[unit], self._duration[unit])
            place[unit], derivative[unit] = led[:, :3], transition[:, :3]
        free = self._kinds == FREE
        if free.any():
            place[free] += own[free, 3:] * self._duration[free, None]
            derivative[free, :, 3:] = np.eye(3) * self._duration[free, None, None]
        return place, derivative
