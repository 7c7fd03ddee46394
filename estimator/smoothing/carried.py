"""What has left the window, laid on its unknowns: the prior of its first keyframe and of the border."""

from typing import NamedTuple

import numpy as np

from estimator.fusion.prior import Key, Prior
from estimator.graph.dense import Array, Indices
from estimator.graph.kernels import Integers
from estimator.smoothing.chain import Chain
from estimator.smoothing.groups import Group
from estimator.smoothing.layout import Layout
from estimator.smoothing.walks import STATES


class Shared(NamedTuple):
    """What a prior tells of one group of walks.

    Attributes:
        moving: which of the prior's numbers are of its keyframe.
        lasting: which are of its border.
        own: which columns of its keyframe those are.
        rest: which columns of its border.
        diagonal: the prior's matrix of its keyframe.
        border: that of its keyframe by its border.
        corner: that of its border.
    """

    moving: Indices
    lasting: Indices
    own: Indices
    rest: Indices
    diagonal: Array
    border: Array
    corner: Array


class Carried:
    """A prior among the unknowns of a window.

    Args:
        layout: of the window.
        prior: what is known from before.
    """

    def __init__(self, layout: Layout, prior: Prior) -> None:
        self._prior = prior
        self._size, self._width = layout.length * layout.width, layout.width
        columns = [_columns(layout, key) for key in prior.keys]
        self._at = np.concatenate(columns or [np.zeros(0, dtype=np.intp)]).astype(np.intp)
        self._kept = np.flatnonzero(self._at >= 0)
        self._shared: list[Shared] = []

    def first(self, x: Array) -> Array:
        """The estimate with the border where the prior was linearised, flat."""
        first = x.copy()
        lasting = self._at >= self._size
        first[self._at[lasting]] = self._prior.reference[lasting]
        return first

    def cost(self, x: Array) -> float:
        """Its negative log likelihood at an estimate, flat, up to a constant."""
        moved = self._moved(x)
        return float(0.5 * moved @ (self._prior.matrix @ moved) - self._prior.vector @ moved)

    @property
    def coupled(self) -> Integers:
        """Pairs of columns that it ties together, m × 2, as `groups.Groups` takes them."""
        at = self._at[self._kept]
        tied = np.argwhere(self._prior.matrix[np.ix_(self._kept, self._kept)] != 0.0)
        columns = np.where(at < self._size, at, at - self._size + self._width)[tied]
        return np.ascontiguousarray(columns, dtype=np.int64)

    def add(self, chain: Chain, x: Array) -> None:
        """Add it to the normal equations at an estimate, flat; the chain always has the same groups."""
        vector = self._prior.vector - self._prior.matrix @ self._moved(x)
        if not self._shared:
            self._shared = [self._shared_with(strand.group) for strand in chain.strands]
        for strand, shared in zip(chain.strands, self._shared, strict=True):
            own, rest = shared.own, shared.rest
            if len(strand.group.walks):
                strand.diagonal[0][own[:, None], own] += shared.diagonal
                strand.border[0][own[:, None], rest] += shared.border
                strand.gradient[0][own] += vector[shared.moving]
            else:
                strand.corner[rest[:, None], rest] += shared.corner
                strand.corner_gradient[rest] += vector[shared.lasting]

    def _shared_with(self, group: Group) -> Shared:
        matrix = self._prior.matrix
        moving, own = _common(self._at, group.columns)
        lasting, rest = _common(self._at - self._size, group.lasting)
        return Shared(
            moving,
            lasting,
            own,
            rest,
            matrix[np.ix_(moving, moving)],
            matrix[np.ix_(moving, lasting)],
            matrix[np.ix_(lasting, lasting)],
        )

    def _moved(self, x: Array) -> Array:
        moved = np.zeros(len(self._at))
        moved[self._kept] = x[self._at[self._kept]] - self._prior.reference[self._kept]
        return moved


def _columns(layout: Layout, key: Key) -> Indices:
    """Flat columns of a prior's block; −1 where it is no longer there."""
    kind, number = key
    size = layout.length * layout.width
    if kind == "walk":
        start = layout.column_of.get(number)
        return np.full(STATES, -1) if start is None else np.arange(start, start + STATES)
    if kind == "stand":
        start = layout.stands.get(number)
        return np.full(3, -1) if start is None else size + np.arange(start, start + 3)
    start = layout.technologies.get(key)
    return np.full(2, -1) if start is None else size + np.arange(start, start + 2)


def _common(at: Indices, columns: Indices) -> tuple[Indices, Indices]:
    """Where each of some columns stands among others, and which of those it is."""
    place = np.minimum(np.searchsorted(columns, at), max(len(columns) - 1, 0))
    among = np.flatnonzero(columns[place] == at) if len(columns) else np.zeros(0, dtype=np.intp)
    return among, place[among]
