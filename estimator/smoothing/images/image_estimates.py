"""Estimates in which somebody has gone an image of his way, and all who go there along with him."""

from collections.abc import Mapping

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.fusion.images import Image, turned_about
from estimator.graph.dense import Array
from estimator.smoothing.images.flip_ambiguity import Flip, end_of
from estimator.smoothing.images.heading_images import drops_along, turn, turns_whole
from estimator.smoothing.keyframes.layout import Layout, Walk

Loose = Mapping[int, NDArray[np.bool_]]
"""Of each walk that may go elsewhere, by its index, whether nothing has led it on from each keyframe."""


def apply_image(layout: Layout, x: Array, index: int, flip: Flip, loose: Loose) -> Array:
    """An estimate with a way where an image has it, flat; and those of all who go along.

    Args:
        layout: of the window.
        x: the estimate, flat.
        index: of the walk.
        flip: the image, and who goes along.
        loose: see `Loose`.
    """
    there = x.copy()
    for i, one in ((index, flip), *flip.along):
        _put(layout, there, i, one, loose[i])
    return there


def _put(layout: Layout, x: Array, index: int, flip: Flip, loose: NDArray[np.bool_]) -> None:
    """Put one way there, in place; what a unit has reported goes along as it is, or turned."""
    walk, image = layout.walks[index], flip.image
    if turns_whole(image):
        turn(layout, x, index, flip)
        return
    end = end_of(flip, loose)
    states = layout.states(x, index)
    here, rest = states[flip.since : end + 1], states[end + 1 : walk.last + 1]
    if walk.way is None:
        image.move(here)
        drops_along(layout, x, walk, image, flip.since, end)
        return
    on = turned_about(here[-1, :2], image.turned_rad).through(here[-1, :2], image.of(here[-1, :2]))
    rest[:, :2], here[:, :2] = on.of(rest[:, :2]), image.of(here[:, :2])
    states[walk.first : walk.last + 1, 3] += image.turned_rad
    drops_along(layout, x, walk, image, flip.since, end)
    drops_along(layout, x, walk, on, end)


def now_of(walk: Walk, image: Image) -> Image:
    """What an image of a way has made of where somebody is now: what a unit has led on is turned, no more."""
    if walk.way is None or image.turned_rad == 0.0:
        return image
    return replace(turned_about(np.zeros(2), image.turned_rad), turned_rad=image.turned_rad)
