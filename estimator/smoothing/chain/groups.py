"""Which walks of a window hang together: what direct readings do not couple meets in the border only."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from estimator.graph.assembly import couple, localise
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Indices
from estimator.smoothing.keyframes.walks import STATES


class Group(NamedTuple):
    """Walks that are coupled to each other, and what they touch of the border.

    Attributes:
        walks: which of the window's, ascending.
        columns: theirs in a keyframe, n.
        lasting: columns of the border that readings and priors connect them to, s, ascending.
    """

    walks: Indices
    columns: Indices
    lasting: Indices


class GroupedReadings(NamedTuple):
    """Readings among the groups, m.

    Attributes:
        slab: keyframe of each, m.
        columns: what each depends on, m × c: columns of its group's keyframe first, those of the group's
            border after them; −1: unused.
        parts: which of them are of each group, in order.
    """

    slab: Integers
    columns: Integers
    parts: list[Indices]


class Groups:
    """The groups of a window.

    Attributes:
        each: the groups; the last one has no walks and all of the border: what touches nothing that moves.
    """

    def __init__(self, width: int, border: int, coupled: Sequence[Integers]) -> None:
        """Find them.

        Args:
            width: columns of a keyframe.
            border: columns of the border.
            coupled: rows of columns that belong together, each m × c: those of a keyframe first, those of the
                border after them; −1: unused.
        """
        count = width // STATES
        self._width = width
        label, touched = np.arange(count), np.zeros((count, border), dtype=np.bool_)
        for columns in coupled:
            couple(columns, width, STATES, label, touched)
        found = []
        for first in np.flatnonzero(label == np.arange(count)).tolist():
            walks = np.flatnonzero(label == first)
            columns = (STATES * walks[:, None] + np.arange(STATES)).ravel()
            found.append(Group(walks, columns, np.flatnonzero(touched[walks].any(axis=0))))
        nothing = np.zeros(0, dtype=np.intp)
        self.each: tuple[Group, ...] = (*found, Group(nothing, nothing, np.arange(border)))
        self._group, self._block = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
        self._place = np.full((len(self.each), width + border), -1, dtype=np.int64)
        for g, group in enumerate(self.each):
            self._group[group.walks], self._block[group.walks] = g, np.arange(len(group.walks))
            self._place[g, group.columns] = np.arange(len(group.columns))
            self._place[g, width + group.lasting] = len(group.columns) + np.arange(len(group.lasting))

    def home(self, walk: int) -> tuple[int, int]:
        """The group of a walk, and which of the group's walks it is."""
        return int(self._group[walk]), int(self._block[walk])

    def placed(self, slab: Integers, columns: Integers) -> GroupedReadings:
        """Rows with columns as in `coupled`, each in its own group's numbering."""
        local, order, ends = localise(columns, self._width, STATES, self._group, self._place)
        return GroupedReadings(slab, local, [order[first:last] for first, last in pairwise(ends.tolist())])
