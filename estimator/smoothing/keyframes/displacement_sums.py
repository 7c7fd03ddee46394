"""Displacements summed up along a unit's way, and what of them lies between any two epochs."""

from collections.abc import Sequence
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.fusion.learned.gait import RENEWED
from estimator.fusion.memory.ledger import ACROSS2, ASSUMED, GIVEN, SCALE2, UNSEEN
from estimator.fusion.motion.long_displacements import STRAIGHT_S, bridged_m2
from estimator.fusion.motion.silence import SILENT_S, wandered_m2
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array

SUMS = 12
"""Displacement 3, its first moment 3, variances 5, length."""
LENGTH = 11
"""Which of them its length is."""
LAID = 8
"""What readings need of them."""
EPSILON_S = 1e-6
"""Epochs that differ by less are the same."""


class SummedEnds(NamedTuple):
    """What m ends of readings have walked since their keyframes: see `ends.Table` and `ends.Ends`."""

    delta_m: Array
    moment: Array
    unsure_m2: Array


class Way:
    """Displacements of one PDR unit summed up along its time, with the variances that they add.

    Args:
        begin_t: epoch at which it begins (s).
        steps: its rows of the ledger's `steps`, in order of epoch.
        factors: learned variances over the assumed ones: of position, of heading.

    Attributes:
        begin_t: epoch at which it begins (s).
        marks: see `summed`.
        sums: see `summed`.
    """

    def __init__(self, begin_t: float, steps: Array, factors: tuple[float, float]) -> None:
        self.begin_t, self._steps = begin_t, steps
        self.marks, self.sums = summed(begin_t, steps, *factors)

    def bridged(self, t: Array) -> Array:
        """Variance of where it was at `t`, m (m²), inside a displacement over a long time."""
        return bridged_m2(self.marks, t)

    @cached_property
    def bridges(self) -> bool:
        """Whether any of its displacements is over a long time."""
        return bool((np.diff(self.marks) > STRAIGHT_S).any())

    def between(self, since: Array, until: Array) -> Array:
        """What lies between epochs, m × 12, moments from `since` on; silence adds what it lets wander."""
        since, until = np.ascontiguousarray(since), np.ascontiguousarray(until)
        return np.asarray(sums_between(self.begin_t, self.marks, self.sums, since, until))

    def unseen_s(self, t: Array) -> Array:
        """For how long its unit has told nothing up to epochs, m (s)."""
        steps = self._steps
        spans = np.where(steps[:, GIVEN] == UNSEEN, steps[:, 0] - steps[:, 2], 0.0)
        inside = np.interp(t, self.marks, np.concatenate([[0.0], np.cumsum(spans)]))
        return np.asarray(inside + np.maximum(t - self.marks[-1], 0.0) - np.maximum(self.marks[0] - t, 0.0))

    def silences(self, since_t: float, until_t: float) -> Array:
        """When its unit has told nothing for long, between two epochs: begins and ends, k × 2 (s).

        Of two packets that were lost one after the other, with one between them, each is by itself.
        """
        steps = self._steps[self._steps[:, 0] > self._steps[:, 2]]
        spans = steps[:, 0] - steps[:, 2]
        # What a report leaves out comes before what it tells, and was taken to be gone at a walk; one that
        # tells nothing, for nobody gets so far in its time, is left out whole.
        untold_s = np.minimum(np.sqrt(steps[:, ACROSS2]) / physics.GAP_MPS, spans)
        untold_s = np.where((steps[:, GIVEN] == UNSEEN) | (spans >= SILENT_S), spans, untold_s)
        first_t, last_t = steps[:, 2].min(initial=self.marks[-1]), self.marks[-1]
        begins = np.concatenate([[min(since_t, first_t)], steps[:, 2], [last_t]])
        ends = np.concatenate([[first_t], steps[:, 2] + untold_s, [max(until_t, last_t)]])
        apart = begins[1:] > ends[:-1] + EPSILON_S
        found = np.column_stack([begins[np.append(True, apart)], ends[np.append(apart, True)]])
        return np.asarray(found[found[:, 1] - found[:, 0] >= SILENT_S - EPSILON_S])

    def renewed2(self, t: float) -> float:
        """Variance with which the unit's scale was another one by an epoch (s), or where its way begins.

        That is where sums begin: nil, where its scale was none other yet.
        """
        steps = self._steps
        told = steps[(steps[:, 0] <= max(t, self.begin_t)) & (steps[:, SCALE2] > RENEWED), SCALE2]
        return float(told[-1]) if len(told) else 0.0

    def gone(self, t: Array) -> Array:
        """Share of its whole length that it has gone at `t`, m."""
        begins = np.full(len(t), self.begin_t)
        return np.asarray(self.between(begins, t)[:, LENGTH] / max(float(self.sums[-1, LENGTH]), 1e-9))


class Ways(NamedTuple):
    """The ways of w units one behind the other.

    Attributes:
        numbers: of their nodes, w.
        begin_t: epochs at which they begin, w (s).
        firsts: where the marks of each begin, and where the last ones end, w + 1.
        marks: see `summed`, of all of them.
        sums: the same.
    """

    numbers: Integers
    begin_t: Array
    firsts: Integers
    marks: Array
    sums: Array


NO_WAYS = Ways(np.zeros(0, np.int64), np.zeros(0), np.zeros(1, np.int64), np.zeros(0), np.zeros((0, SUMS)))


def ways_of(numbers: Sequence[int], ways: Sequence[Way]) -> Ways:
    """Ways one behind the other, with the numbers of their nodes."""
    if not ways:
        return NO_WAYS
    firsts = np.array([0, *accumulate(len(way.marks) for way in ways)])
    begin_t = np.array([way.begin_t for way in ways])
    if len(ways) == 1:
        return Ways(np.array(numbers), begin_t, firsts, ways[0].marks, ways[0].sums)
    marks, sums = np.concatenate([way.marks for way in ways]), np.concatenate([way.sums for way in ways])
    return Ways(np.array(numbers), begin_t, firsts, marks, sums)


@njit(cache=True)
def summed(begin_t: float, steps: Array, by_place: float, by_turn: float) -> tuple[Array, Array]:
    """Epochs at which displacements end, after that at which they begin, and sums up to each; see `Way`.

    Args:
        begin_t: epoch at which it begins (s).
        steps: the ledger's rows, m × 12, in order of epoch.
        by_place: learned variance of position, across, over the assumed one.
        by_turn: that of heading.
    """
    m = len(steps)
    marks, sums, each = np.empty(m + 1), np.zeros((m + 1, SUMS)), np.empty(SUMS)
    marks[0] = begin_t
    for i in range(m):
        marks[i + 1] = steps[i, 0]
        middle = 0.5 * (steps[i, 2] + steps[i, 0]) - begin_t
        factor = by_place if steps[i, GIVEN] == ASSUMED else 1.0
        for c in range(3):
            each[c], each[3 + c] = steps[i, 3 + c], steps[i, 3 + c] * middle
        each[6], each[7], each[8] = steps[i, 6] * factor, steps[i, 7], steps[i, 8] * by_turn
        each[9], each[10] = steps[i, 9], steps[i, 10]
        each[LENGTH] = np.sqrt(steps[i, 3] * steps[i, 3] + steps[i, 4] * steps[i, 4])
        for c in range(SUMS):
            sums[i + 1, c] = sums[i, c] + each[c]
    return marks, sums


@njit(cache=True)
def sum_up_to(marks: Array, sums: Array, t: float, found: Array) -> None:
    """Sums of a way up to one epoch: as many as `found` takes.

    Args:
        marks: epochs at which displacements end, ascending; before them that at which the first one began.
        sums: up to each of them.
        t: the epoch.
        found: takes the sums.
    """
    inside, last = min(max(t, marks[0]), marks[-1]), len(marks) - 1
    right = min(max(np.searchsorted(marks, inside, side="right"), 1), last)
    if last == 0:
        found[:] = 0.0
        return
    span = marks[right] - marks[right - 1]
    share = (inside - marks[right - 1]) / span if span > 0.0 else 1.0
    for c in range(len(found)):
        found[c] = sums[right - 1, c] + share * (sums[right, c] - sums[right - 1, c])


@njit(cache=True)
def sum_between(
    begin_t: float, marks: Array, sums: Array, since: float, until: float, before: Array, found: Array
) -> None:
    """What a way's displacements say of it between two epochs, 12, moments from `since` on.

    Silence adds a random walk (`silence.wandered_m2`), after the last displacement and before the first:
    whose unit is switched on inside has walked there as well.

    Args:
        begin_t: epoch at which it begins (s).
        marks: see `sum_up_to`.
        sums: see `sum_up_to`.
        since: one epoch (s).
        until: the other one (s).
        before: sums up to the one epoch.
        found: takes the sums, 8 at least.
    """
    sum_up_to(marks, sums, until, found)
    for c in range(len(found)):
        found[c] -= before[c]
    for c in range(3):
        found[3 + c] -= found[c] * (since - begin_t)
    wander = 0.0
    for silent_s in (min(until, marks[0]) - since, until - max(since, marks[-1])):
        if silent_s > 0.0:
            wander += wandered_m2(silent_s, np.inf)
    found[6] += wander
    found[7] += 0.1 * wander


@njit(cache=True)
def sums_between(begin_t: float, marks: Array, sums: Array, since: Array, until: Array) -> Array:
    """Those between m pairs of epochs, m × 12."""
    found, before = np.empty((len(since), SUMS)), np.empty(SUMS)
    for i in range(len(since)):
        sum_up_to(marks, sums, since[i], before)
        sum_between(begin_t, marks, sums, since[i], until[i], before, found[i])
    return found


@njit(cache=True)
def set_sums_of(
    begin_t: float,
    marks: Array,
    sums: Array,
    mine: int,
    numbers: Integers,
    since: Array,
    until: Array,
    to: SummedEnds,
) -> None:
    """Set the displacement sums of those of m ends that are one node's: between keyframe and epoch.

    Args:
        begin_t: epoch at which its way begins (s).
        marks: see `sum_up_to`.
        sums: see `sum_up_to`.
        mine: number of the node.
        numbers: of the node of each end, m.
        since: epochs of their keyframes, m (s).
        until: their own epochs, m (s).
        to: takes it.
    """
    found, before, since_t, until_t = np.empty(LAID), np.empty(LAID), np.nan, np.nan
    for i in range(len(numbers)):
        if numbers[i] != mine:
            continue
        # Many ends share a keyframe, and those of one sweep their epoch as well.
        if since[i] != since_t:
            sum_up_to(marks, sums, since[i], before)
        if since[i] != since_t or until[i] != until_t:
            since_t, until_t = since[i], until[i]
            sum_between(begin_t, marks, sums, since_t, until_t, before, found)
        for c in range(3):
            to.delta_m[i, c], to.moment[i, c] = found[c], found[3 + c]
            to.unsure_m2[i, c] = abs(found[6 if c < 2 else 7])
