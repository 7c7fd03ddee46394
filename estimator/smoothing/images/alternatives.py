"""Where everybody may be otherwise, by the other solutions of a window that are not much less likely."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.images import Alternative, Image
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import PLACES, STATES

APART_M = 2.0
"""Solutions that put somebody nearer to each other than this are the same."""


class Mode(NamedTuple):
    """Another solution that is not much less likely.

    Attributes:
        of: number of the node whose way is another one in it.
        share: how likely it is.
        x: its estimate, flat.
        since_t: from when on his way is another one (s).
        way: the image of it.
        images: of those that still go where ranges take them, by number: where they are now, as an image of
            where they are in the likeliest one.
    """

    of: int
    share: float
    x: Array
    since_t: float
    way: Image
    images: Mapping[int, Image]


def same_place(one_m: Array, other_m: Array) -> bool:
    """Whether places, … × 2 (m), are the same but for what a covariance tells of."""
    return bool((np.hypot(*(one_m - other_m).T) < APART_M).all())


def goes_on_m(layout: Layout, x: Array, index: int, keyframe: int) -> Array:
    """Where somebody is at a keyframe, and where he comes to if he goes on as he goes there, 2 × 2 (m).

    A way without a unit and its image meet where both cross their line, and part again beyond it: there a
    velocity tells one from the other, which carries him on for as long as it lasts.

    Args:
        layout: of the window.
        x: an estimate, flat.
        index: of his walk.
        keyframe: the keyframe.
    """
    walk, state = layout.walks[index], layout.states(x, index)[keyframe]
    free = walk.way is None and walk.node.moving
    lasts_s = physics.SPEED_MEMORY_S[walk.node.role] if free else 0.0
    return np.stack([state[:2], state[:2] + lasts_s * state[PLACES : PLACES + 2]])


def same_now(layout: Layout, one: Array, other: Array) -> bool:
    """Whether two solutions of a window, flat, put all who move at the same place and on the same way."""
    return all(_same_now(layout, one, other, i) for i in range(len(layout.walks)))


def _same_now(layout: Layout, one: Array, other: Array, index: int) -> bool:
    return same_place(*(goes_on_m(layout, x, index, layout.length - 1) for x in (one, other)))


def alternatives_now(layout: Layout, x: Array, modes: Iterable[Mode]) -> dict[str, tuple[Alternative, ...]]:
    """Where everybody in a window may be otherwise now.

    Args:
        layout: of the window.
        x: its solution, flat.
        modes: the others.
    """
    size, now = layout.length * layout.width, (layout.length - 1) * layout.width
    at = {walk.number: now + STATES * i for i, walk in enumerate(layout.walks)}
    at |= {number: size + start for number, start in layout.stands.items()}
    found: dict[str, tuple[Alternative, ...]] = {}
    walks = {walk.number: i for i, walk in enumerate(layout.walks)}
    for number, start in at.items():
        name, own = layout.state.owners[number], slice(start, start + 2)
        told = []
        for mode in modes:
            # Who has changed sides with others may be on the line just now, and leave it elsewhere.
            image = mode.images.get(number, Image())
            goes_on = number in mode.images and len(mode.images) > 1
            # So may who crosses it alone.
            goes_on = goes_on or (number in walks and not _same_now(layout, x, mode.x, walks[number]))
            # So may who faces elsewhere: he has hardly gone from where both ways begin.
            goes_on = goes_on or image.turned_rad != 0.0
            if goes_on or not same_place(mode.x[own], x[own]):
                there = image.through(x[own], mode.x[own])
                told.append(Alternative(mode.of, mode.share, there, mode.since_t, mode.way))
        if layout.state.nodes[name].index == number:
            found[name] = tuple(told)
    return found


def widen(layout: Layout, x: Array, modes: Sequence[Mode], found: tuple[Array, Array, Array]) -> None:
    """Let covariances hold that everybody may have been elsewhere.

    Args:
        layout: of a window.
        x: its solution, flat.
        modes: the others.
        found: covariances of the keyframes, of each with the next one and of the border, as
            `Chain.covariances` gives them; changed in place.
    """
    keyframes, ahead, border = found
    size = layout.length * layout.width
    for mode in modes:
        off = mode.x - x
        moved = off[:size].reshape(layout.length, -1, STATES)[:, :, :2]
        keyframes[:, :, :2, :2] += mode.share * np.einsum("kwi,kwj->kwij", moved, moved)
        ahead[:, :, :2, :2] += mode.share * np.einsum("kwi,kwj->kwij", moved[:-1], moved[1:])
        for start in layout.stands.values():
            own = slice(start, start + 2)
            border[own, own] += mode.share * np.outer(off[size:][own], off[size:][own])
