"""What has left the window, laid on its unknowns: the prior of its first keyframe and of the border."""

from collections.abc import Collection, Iterable, Sequence
from copy import copy
from typing import NamedTuple, Self

import numpy as np

from estimator.fusion.memory.prior import SIZES, Key, Prior
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array, Indices
from estimator.graph.gauge import Turning, change_pairs, pivot, turn_pairs, turning
from estimator.graph.kirchhoff import marginalised
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.chain.groups import Group
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.keyframes.walks import HEADING, PLACES, STATES
from estimator.smoothing.problem.drifts import drifted
from estimator.smoothing.problem.gauge_turn import moved_from, turn_between

KNOWN_M = 10.0
"""A place that the prior knows less well, were all others held, it hardly knows."""


class SharedNumbers(NamedTuple):
    """What a prior and one group of walks have in common.

    Attributes:
        moving: which of the prior's numbers are of its keyframe.
        lasting: which are of its border.
        own: which columns of its keyframe those are.
        rest: which columns of its border.
    """

    moving: Indices
    lasting: Indices
    own: Indices
    rest: Indices


class MarginalPrior:
    """A prior among the unknowns of a window.

    Args:
        layout: of the window.
        prior: what is known from before.

    Attributes:
        pivot_m: what the map is turned about, east and north, 2 (m).
    """

    def __init__(self, layout: Layout, prior: Prior) -> None:
        self._size, self._width = layout.length * layout.width, layout.width
        columns = [_columns(layout, key) for key in prior.keys]
        at = np.concatenate(columns or [np.zeros(0, dtype=np.intp)]).astype(np.intp)
        kept, gone = np.flatnonzero(at >= 0), np.flatnonzero(at < 0)
        prior = drifted(prior, layout)
        self._at, self._reference = at[kept], prior.reference[kept]
        self._matrix, self._vector = prior.matrix, prior.vector
        if len(gone):
            # Held where they were, they would not let the map turn.
            self._matrix, self._vector = marginalised(self._matrix, self._vector, gone, kept)
        changed = _turning(prior, at, kept, layout.landmarks)
        self._places, self._speeds = changed.places, changed.speeds
        base_m = np.array(layout.state.base_place()[:2])
        self.pivot_m = pivot(self._matrix, self._reference, changed, base_m)
        self._turning = np.concatenate([self._places, self._speeds])
        # What is known of each place were all else held, the mean of two directions.
        self._known_per_m2: Array = self._matrix.diagonal()[self._places].mean(axis=1)
        # Of what it hardly knows nothing can add up to what nobody measured: readings say where that is.
        hardly = self._places[self._known_per_m2 < KNOWN_M**-2]
        # A turn of the map changes no height: for it none has to be held.
        columns_up = [self._size + start + 2 for start in layout.stands.values()]
        heights = np.flatnonzero(np.isin(self._at, columns_up))
        border = np.flatnonzero(self._at >= self._size)
        self._held = np.setdiff1d(border, np.union1d(hardly, heights))

    def part(self, numbers: Unknowns, x: Array) -> Self:
        """The same of a part of the window, with all walks that it has not held where they are.

        Args:
            numbers: of the part.
            x: the window's estimate, flat.
        """
        other, moved = copy(self), self._moved(x, self._turned_by(x))
        layout, at = numbers.layout, numbers.place[self._at]
        kept, held = np.flatnonzero(at >= 0), np.flatnonzero(at < 0)
        among = [(at[pairs] >= 0).all(axis=1) for pairs in (self._places, self._speeds)]
        places, speeds = (
            np.searchsorted(kept, pairs[some])
            for pairs, some in zip((self._places, self._speeds), among, strict=True)
        )
        vars(other).update(
            _size=layout.length * layout.width,
            _width=layout.width,
            _at=at[kept],
            _reference=self._reference[kept],
            _matrix=self._matrix[np.ix_(kept, kept)],
            _vector=self._vector[kept] - self._matrix[np.ix_(kept, held)] @ moved[held],
            _places=places,
            _speeds=speeds,
            _turning=np.concatenate([places, speeds]),
            _known_per_m2=self._known_per_m2[among[0]],
            _held=np.searchsorted(kept, self._held[at[self._held] >= 0]),
        )
        return other

    def first(self, x: Array) -> Array:
        """The estimate with the border where the prior was linearised, turned as the map is now, flat.

        A place that the prior hardly knows stays where it is, and so do all heights: a derivative that was
        taken metres from there would lead it away.
        """
        first, there = x.copy(), self._reference.copy()
        turn_pairs(there, self._places, self.pivot_m, self._turned_by(x))
        first[self._at[self._held]] = there[self._held]
        return first

    def cost(self, x: Array) -> float:
        """Its negative log likelihood at an estimate, flat, up to a constant."""
        moved = self._moved(x, self._turned_by(x))
        return float(0.5 * moved @ (self._matrix @ moved) - self._vector @ moved)

    @property
    def coupled(self) -> Integers:
        """Pairs of columns that it ties together, m × 2, as `groups.Groups` takes them."""
        tied = self._matrix != 0.0
        # Turned with the map, what one of east and north is tied to the other is as well.
        pairs = self._turning
        tied[pairs] |= tied[pairs[:, ::-1]]
        tied[:, pairs] |= tied[:, pairs[:, ::-1]]
        columns = np.where(self._at < self._size, self._at, self._at - self._size + self._width)
        return np.ascontiguousarray(columns[np.argwhere(tied)], dtype=np.int64)

    def add(self, chain: Chain, shared: Sequence[SharedNumbers], x: Array) -> None:
        """Add it to the normal equations at an estimate.

        Args:
            chain: takes it.
            shared: what each group of the chain has in common with it.
            x: the estimate, flat.
        """
        turned_by, matrix = self._turned_by(x), self._matrix.copy()
        vector, by = self._vector - matrix @ self._moved(x, turned_by), np.empty((len(self._turning), 2, 2))
        by[:] = turning(turned_by)
        change_pairs(matrix, vector, self._turning, by)
        for strand, (moving, lasting, own, rest) in zip(chain.strands, shared, strict=True):
            if len(strand.group.walks):
                strand.diagonal[0][own[:, None], own] += matrix[moving[:, None], moving]
                strand.border[0][own[:, None], rest] += matrix[moving[:, None], lasting]
                strand.gradient[0][own] += vector[moving]
            else:
                strand.corner[rest[:, None], rest] += matrix[lasting[:, None], lasting]
                strand.corner_gradient[rest] += vector[lasting]

    def shared(self, groups: Iterable[Group]) -> list[SharedNumbers]:
        """What it and each of some groups of walks have in common."""
        found = []
        for group in groups:
            moving, own = _common(self._at, group.columns)
            lasting, rest = _common(self._at - self._size, group.lasting)
            found.append(SharedNumbers(moving, lasting, own, rest))
        return found

    def _turned_by(self, x: Array) -> float:
        """By how much the map is turned about the pivot since the prior was linearised (rad)."""
        was_m = self._reference[self._places] - self.pivot_m
        return turn_between(was_m, x[self._at[self._places]] - self.pivot_m, self._known_per_m2)

    def _moved(self, x: Array, turned_by: float) -> Array:
        """What the prior takes for deviations from its reference: see `gauge_turn.moved_from`."""
        pairs = self._places, self._speeds
        return np.asarray(moved_from(self._reference, x[self._at], *pairs, self.pivot_m, turned_by))


def _turning(prior: Prior, columns: Indices, kept: Indices, still: Collection[int]) -> Turning:
    """Which of a prior's numbers change with a turn of the map, counted among those that are still there.

    Args:
        prior: what is known from before.
        columns: where each of its numbers is in the window, n; −1: it is not.
        kept: those that are.
        still: numbers of those whose places were told, which do not turn with it.
    """
    places, speeds, headings, start = [], [], [], 0
    for kind, number in prior.keys:
        turns = number not in still
        if kind in ("walk", "free", "stand") and columns[start] >= 0 and turns:
            places.append((start, start + 1))
        if kind == "free" and columns[start + PLACES] >= 0 and turns:
            speeds.append((start + PLACES, start + PLACES + 1))
        if kind == "walk" and columns[start + HEADING] >= 0:
            headings.append(start + HEADING)
        start += SIZES[kind]
    pairs = [np.searchsorted(kept, np.array(each, dtype=np.intp).reshape(-1, 2)) for each in (places, speeds)]
    return Turning(pairs[0], pairs[1], np.searchsorted(kept, np.array(headings, dtype=np.intp)))


def _columns(layout: Layout, key: Key) -> Indices:
    """Flat columns of a prior's block; −1 where it is no longer there."""
    kind, number = key
    size = layout.length * layout.width
    if kind in ("walk", "free"):
        start = layout.column_of.get(number)
    elif kind == "stand":
        start = layout.stands.get(number)
    else:
        start = layout.lost[key].column if key in layout.lost else layout.technologies.get(key)
    if start is None:
        return np.full(SIZES[kind], -1)
    found = np.arange(start, start + SIZES[kind]) + (0 if kind in ("walk", "free") else size)
    if kind == "free" and layout.walks[start // STATES].way is not None:
        # Its bearer has a PDR unit now.
        found[PLACES:] = -1
    return found


def _common(at: Indices, columns: Indices) -> tuple[Indices, Indices]:
    """Where each of some columns stands among others, and which of those it is."""
    place = np.minimum(np.searchsorted(columns, at), max(len(columns) - 1, 0))
    among = np.flatnonzero(columns[place] == at) if len(columns) else np.zeros(0, dtype=np.intp)
    return among, place[among]
