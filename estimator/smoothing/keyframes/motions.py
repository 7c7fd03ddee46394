"""How all the walks of a window go between their keyframes."""

from copy import copy
from typing import Self

import numpy as np

from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.keyframes.walks import STATES, Free, Motion, free_motions, reckon, unit_motion


class Motions:
    """What lies between the keyframes of each walk, wherever they are.

    Args:
        layout: of the window.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._ways = [self._way(i, walk) for i, walk in enumerate(layout.walks)]

    def _way(self, index: int, walk: Walk) -> tuple[Array, Array | Free]:
        """Times between a walk's keyframes, and what lies between them."""
        times = self._layout.times[walk.first : walk.last + 1, index]
        durations = np.diff(times)
        if walk.way is None:
            return durations, free_motions(walk.node.role, durations)
        return durations, walk.way.between(times[:-1], times[1:])

    def part(self, numbers: Unknowns) -> Self:
        """How those walks go that a part of the window has, up to its last keyframe."""
        ways = []
        for i, walk in zip(numbers.walks, numbers.layout.walks, strict=True):
            steps = walk.last - walk.first
            durations, between = self._ways[i]
            some = between.first(steps) if isinstance(between, Free) else between[:steps]
            ways.append((durations[:steps], some))
        other = copy(self)
        vars(other).update(_layout=numbers.layout, _ways=ways)
        return other

    def motions(self, x: Array) -> list[Motion]:
        """Each walk's motion at an estimate, flat."""
        found = []
        for i, (walk, (durations, between)) in enumerate(zip(self._layout.walks, self._ways, strict=True)):
            states = self._layout.states(x, i)[walk.first : walk.last + 1].copy()
            if isinstance(between, Free):
                found.append(between.motion(states))
            else:
                found.append(unit_motion(between, durations, states))
        return found

    def reckoned(self, x: Array, since_t: float) -> Array:
        """An estimate whose units have gone their own way since an epoch, flat."""
        layout, there = self._layout, x.copy()
        for i, (walk, (durations, between)) in enumerate(zip(layout.walks, self._ways, strict=True)):
            if not isinstance(between, Free):
                times = layout.times[walk.first : walk.last + 1, i]
                known = max(int(np.searchsorted(times, since_t, side="right")) - 1, 0)
                reckon(layout.states(there, i)[walk.first : walk.last + 1], between, durations, known)
        return there

    def kinked(self, x: Array, within_s: float) -> Array:
        """An estimate, flat, with each keyframe of a unit moved on by what its way is bent soon after.

        What was heard between two keyframes is thus held against both: what it has made of the next one, too.

        Args:
            x: the estimate, flat.
            within_s: how long after the next keyframe a way is bent by what was heard before it (s).
        """
        layout, there = self._layout, x.copy()
        for i, (walk, motion) in enumerate(zip(layout.walks, self.motions(x), strict=True)):
            if walk.way is not None:
                times = layout.times[walk.first : walk.last + 1, i]
                bent = np.vstack([np.zeros(STATES), np.cumsum(motion.residual, axis=0)])
                until = np.searchsorted(times, times[1:] + within_s).clip(max=len(times) - 1)
                layout.states(there, i)[walk.first : walk.last] += bent[until] - bent[:-1]
        return there
