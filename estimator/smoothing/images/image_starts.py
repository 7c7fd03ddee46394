"""Estimates that an image of somebody's way leads to, and which of them are the same."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from estimator.fusion.images import Image
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.images.alternatives import goes_on_m, same_place
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.heading_images import facing, reports_from, turn
from estimator.smoothing.images.parts import Part
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

SAME_RAD = 0.4
"""Headings nearer to each other than this may be one that is not at rest yet."""
PARTED = 0.1
"""What the way between two headings costs more than either, in log likelihood, if they are two."""
RETURNED = 0.2
"""Share of how far from a heading an image began, within which it has led back to it."""
BEGINNINGS = 3
"""Images of a way that put somebody at the same place now, from keyframes this near, are the same."""


class ImageStart(NamedTuple):
    """An estimate, flat, and the image of a way that it has begun from."""

    x: Array
    flip: Flip


class ImageEnd(NamedTuple):
    """Where an image of a way has led to, and what it costs there, in log likelihood up to a constant."""

    to: ImageStart
    cost: float


class ImageSolution(NamedTuple):
    """A solution, and the image of a way that it has begun from."""

    solved: Solution
    flip: Flip

    @property
    def begun(self) -> ImageStart:
        """Where it has led to."""
        return ImageStart(self.solved.x, self.flip)

    @property
    def led(self) -> ImageEnd:
        """Where it has led to, and what it costs there."""
        return ImageEnd(self.begun, self.solved.cost)


class Subject(NamedTuple):
    """Of whom it is asked where he is.

    Attributes:
        problem: of the window.
        of: index of his walk.
        whole: where he was at any time, not only where he is now.
        part: by whose readings, and up to when; None: by all of the window.
    """

    problem: Problem
    of: int
    whole: bool
    part: Part | None = None

    @property
    def layout(self) -> Layout:
        """That of the window."""
        return self.problem.layout

    def same_start(self, one: ImageStart, other: ImageStart) -> bool:
        """Whether two images lead to the same solution, as far as can be told before."""
        near = abs(one.flip.since - other.flip.since) < BEGINNINGS
        if near and self._turned(one) and self._turned(other) and abs(self._apart_rad(one, other)) > SAME_RAD:
            return False
        return near and self._same_places(one, other, self.of)

    def same(self, first: ImageEnd, second: ImageEnd) -> bool:
        """Whether two solutions are the same: one of a heading may not be at rest yet far from its start."""
        one, other = first.to, second.to
        if not (self._turned(one) and self._turned(other)):
            return self._same_places(one, other, self.of)
        begins = reports_from(self.layout, self.of)
        starts_m = [self.layout.states(each.x, self.of)[begins : begins + 1, :2] for each in (one, other)]
        if not same_place(*starts_m) or not self._same_places(one, other):
            return False
        apart_rad = self._apart_rad(one, other)
        if abs(apart_rad) > SAME_RAD:
            return False
        return self._cost(self._between(one, other, apart_rad)) < max(first.cost, second.cost) + PARTED

    def among(self, found: Sequence[ImageEnd], new: ImageEnd) -> int | None:
        """Which of some solutions another one is; None: none of them."""
        return next((k for k, one in enumerate(found) if self.same(one, new)), None)

    def _cost(self, x: Array) -> float:
        return self.problem.at(x).cost if self.part is None else self.part.more(x)

    def returned(self, known: ImageStart, start: ImageStart, led: ImageStart) -> bool:
        """Whether an image has led back to a known heading, and not only begun near to it."""
        return abs(self._apart_rad(known, led)) < RETURNED * abs(self._apart_rad(known, start))

    def _apart_rad(self, one: ImageStart, other: ImageStart) -> float:
        """By how much the other's heading is to the left of the one's (rad)."""
        was, there = (heading(self.layout, self.of, each.x) for each in (one, other))
        return within_pi(there - was)

    def _between(self, one: ImageStart, other: ImageStart, by_rad: float) -> Array:
        """The estimate halfway between two headings, flat: each is turned by half of that about his start."""
        since, found = reports_from(self.layout, self.of), []
        for each, half_rad in ((one, 0.5 * by_rad), (other, -0.5 * by_rad)):
            there = each.x.copy()
            start_m = self.layout.states(there, self.of)[since, :2].copy()
            turn(self.layout, there, self.of, Flip(since, facing(start_m, half_rad)))
            found.append(there)
        # A heading may have gone round as a whole.
        was, there_rad = (heading(self.layout, self.of, x) for x in found)
        walk = self.layout.walks[self.of]
        rounds = 2.0 * np.pi * np.round((was - there_rad) / (2.0 * np.pi))
        self.layout.states(found[1], self.of)[walk.first : walk.last + 1, 3] += rounds
        return 0.5 * (found[0] + found[1])

    def _turned(self, one: ImageStart) -> bool:
        """Whether an estimate is one of several headings, not of several ways that a unit has gone since."""
        if not self.layout.walks[self.of].node.turned:
            return False
        since, image = one.flip.since, one.flip.image
        return image == Image() or image.turned_rad != 0.0 or since < reports_from(self.layout, self.of)

    def _same_places(self, one: ImageStart, other: ImageStart, *walks: int) -> bool:
        """Whether walks, and all who go along with either, are at the same places."""
        asked = {*walks, *(i for i, _ in (*one.flip.along, *other.flip.along))}
        return all(same_place(self._places(one.x, i), self._places(other.x, i)) for i in asked)

    def _places(self, x: Array, index: int) -> Array:
        """Where a walk is at epochs that are asked for, and where it would come to then, k × 2 (m)."""
        walk = self.layout.walks[index]
        last = walk.last if self.part is None else min(walk.last, self.part.numbers.until)
        # Who is at the same place before the window ends may still have come another way.
        first = walk.first if self.whole or last < walk.last else last
        way_m = self.layout.states(x, index)[first:last, :2]
        return np.concatenate([way_m, goes_on_m(self.layout, x, index, last)])


def heading(layout: Layout, index: int, x: Array) -> float:
    """By how much a unit's frame is turned at last in an estimate, flat (rad)."""
    return float(layout.states(x, index)[layout.walks[index].last, 3])
