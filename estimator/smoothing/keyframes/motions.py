"""How all the walks of a window go between their keyframes."""

from collections.abc import Sequence
from copy import copy
from typing import NamedTuple, Self

import numpy as np

from estimator.graph.dense import Array, Indices
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.keyframes.walks import STATES, Free, Motion, free_motions, reckon, unit_motion


class UnitSteps(NamedTuple):
    """The steps of all units one behind the other: linearised at once they cost one compiled call.

    Between the last keyframe of one walk and the first one of the next lies a step that nobody asks for.

    Attributes:
        own: which steps are each walk's.
        at: rows of their keyframes in an estimate, each of its walks' states a row, m.
        durations_s: of each step, m − 1.
        between: sums of each step, (m − 1) × 12 (see `Way.between`).
    """

    own: dict[int, slice]
    at: Indices
    durations_s: Array
    between: Array


class Motions:
    """What lies between the keyframes of each walk, wherever they are.

    Args:
        layout: of the window.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._ways = [self._way(i, walk) for i, walk in enumerate(layout.walks)]
        self._units = unit_steps(layout, self._ways)

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
        vars(other).update(_layout=numbers.layout, _ways=ways, _units=unit_steps(numbers.layout, ways))
        return other

    def motions(self, x: Array) -> list[Motion]:
        """Each walk's motion at an estimate, flat."""
        layout, units, found = self._layout, self._units, list[Motion]()
        rows = x[: layout.length * layout.width].reshape(-1, STATES)
        led = unit_motion(units.between, units.durations_s, rows[units.at]) if units.own else None
        for i, (walk, (_, between)) in enumerate(zip(layout.walks, self._ways, strict=True)):
            if isinstance(between, Free):
                found.append(between.motion(layout.states(x, i)[walk.first : walk.last + 1]))
            elif led is not None:
                own = units.own[i]
                found.append(Motion(led[0][own], led[1][own], led[2][own], led[3][own]))
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


def unit_steps(layout: Layout, ways: Sequence[tuple[Array, Array | Free]]) -> UnitSteps:
    """The steps of all units of a window.

    Args:
        layout: of the window.
        ways: times between each walk's keyframes (s), and what lies between them.
    """
    own: dict[int, slice] = {}
    at, durations_s, sums, begun = list[Indices](), list[Array](), list[Array](), 0
    for i, (walk, (each_s, between)) in enumerate(zip(layout.walks, ways, strict=True)):
        if isinstance(between, Free):
            continue
        if own:
            durations_s.append(np.zeros(1))
            sums.append(np.zeros((1, between.shape[1])))
        own[i] = slice(begun, begun + len(each_s))
        begun += len(each_s) + 1
        at.append(np.arange(walk.first, walk.last + 1) * len(layout.walks) + i)
        durations_s.append(each_s)
        sums.append(between)
    if not own:
        return UnitSteps(own, np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros((0, 0)))
    return UnitSteps(own, np.concatenate(at), np.concatenate(durations_s), np.concatenate(sums))
