"""Estimates that an image of somebody's way leads to, and which of them are the same."""

from typing import NamedTuple

import numpy as np

from estimator.fusion.images import Image
from estimator.graph.dense import Array
from estimator.smoothing.flips import Flip
from estimator.smoothing.layout import Layout
from estimator.smoothing.otherwise import same_place
from estimator.smoothing.solved import Solved
from estimator.smoothing.turns import reports_from

SAME_RAD = 0.4
"""Headings nearer to each other than this are one, and not at rest yet."""
BEGINNINGS = 3
"""Images of a way that put somebody at the same place now, from keyframes this near, are the same."""


class Begun(NamedTuple):
    """An estimate, flat, and the image of a way that it has begun from."""

    x: Array
    flip: Flip


class Tried(NamedTuple):
    """A solution, and the image of a way that it has begun from."""

    solved: Solved
    flip: Flip

    @property
    def begun(self) -> Begun:
        """Where it has led to."""
        return Begun(self.solved.x, self.flip)


class Asked(NamedTuple):
    """Of whom it is asked where he is.

    Attributes:
        layout: of the window.
        of: index of his walk.
        whole: where he was at any time, not only where he is now.
    """

    layout: Layout
    of: int
    whole: bool

    def same_start(self, one: Begun, other: Begun) -> bool:
        """Whether two images lead to the same solution, as far as can be told before."""
        near = abs(one.flip.since - other.flip.since) < BEGINNINGS
        return near and self._same_places(one, other, self.of)

    def same(self, one: Begun, other: Begun) -> bool:
        """Whether two solutions are the same: one of a heading may not be at rest yet far from its start."""
        if not (self._turned(one) and self._turned(other)):
            return self._same_places(one, other, self.of)
        begins = reports_from(self.layout, self.of)
        starts_m = [self.layout.states(each.x, self.of)[begins : begins + 1, :2] for each in (one, other)]
        if not same_place(*starts_m) or not self._same_places(one, other):
            return False
        facing_rad = [heading(self.layout, self.of, each.x) for each in (one, other)]
        return bool(np.cos(facing_rad[0] - facing_rad[1]) > np.cos(SAME_RAD))

    def _turned(self, one: Begun) -> bool:
        """Whether an estimate is one of several headings, not of several ways that a unit has gone since."""
        if not self.layout.walks[self.of].node.turned:
            return False
        since, image = one.flip.since, one.flip.image
        return image == Image() or image.turned_rad != 0.0 or since < reports_from(self.layout, self.of)

    def _same_places(self, one: Begun, other: Begun, *walks: int) -> bool:
        """Whether walks, and all who go along with either, are at the same places."""
        asked = {*walks, *(i for i, _ in (*one.flip.along, *other.flip.along))}
        return all(same_place(self._places(one.x, i), self._places(other.x, i)) for i in asked)

    def _places(self, x: Array, index: int) -> Array:
        """Where a walk is at epochs that are asked for, k × 2 (m)."""
        walk = self.layout.walks[index]
        return self.layout.states(x, index)[walk.first if self.whole else walk.last : walk.last + 1, :2]


def heading(layout: Layout, index: int, x: Array) -> float:
    """By how much a unit's frame is turned at last in an estimate, flat (rad)."""
    return float(layout.states(x, index)[layout.walks[index].last, 3])
