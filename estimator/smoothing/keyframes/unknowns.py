"""Which numbers of a window a part of it has: those of some walks, up to some keyframe, and of the border."""

from collections.abc import Collection

import numpy as np

from estimator.graph.dense import Array, Indices
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES


class Unknowns:
    """The numbers of a part among those of its window.

    Args:
        whole: the window.
        walks: indices of those that it has; each begins before its last keyframe.
        until: its last keyframe.

    Attributes:
        walks: indices of its walks, ascending.
        until: its last keyframe.
        layout: that of the part.
        kept: its numbers, by where they are in an estimate of the window, flat, ascending.
        place: where each number of the window is in an estimate of the part, flat; −1: nowhere.
        column: the same of columns of a keyframe, and of the border counted after them.
    """

    def __init__(self, whole: Layout, walks: Collection[int], until: int) -> None:
        self.walks, self.until = sorted(walks), until
        self.layout = whole.part(self.walks, until)
        columns = (STATES * np.array(self.walks, dtype=np.intp)[:, None] + np.arange(STATES)).ravel()
        keyframes = np.arange(until + 1)[:, None] * whole.width + columns
        size = whole.length * whole.width
        self.kept: Indices = np.concatenate([keyframes.ravel(), size + np.arange(whole.border)])
        self.place: Indices = np.full(size + whole.border, -1)
        self.place[self.kept] = np.arange(len(self.kept))
        self.column: Indices = np.full(whole.width + whole.border, -1)
        self.column[columns] = np.arange(len(columns))
        self.column[whole.width :] = len(columns) + np.arange(whole.border)

    def taken(self, x: Array) -> Array:
        """An estimate of the window as one of the part, flat."""
        return x[self.kept]
