"""Headings that a unit may have instead, whose bearer may have faced anything at first.

Ranges to one radio tell how far a straight way has gone, not to which side of the line from where it began:
the way turned to the other side fits as well, until he turns or another radio hears him.
"""

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.images import Image, turned_about
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.heard_radios import HeardRadios, radios_of
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.problem.newton import Problem

SAME = 1e-6
"""Epochs (s) and turns (rad) nearer to each other than this are the same."""


def reports_from(layout: Layout, index: int) -> int:
    """The first keyframe of a walk since when its unit reports: before that nothing turns with what it faces.

    Args:
        layout: of the window.
        index: of a walk that has a unit.
    """
    walk = layout.walks[index]
    if walk.way is None:
        return walk.first
    times = layout.times[walk.first : walk.last, index]
    return walk.first + int(np.searchsorted(times, walk.way.begin_t - SAME))


def turns(problem: Problem, heard: HeardRadios, way_m: Array, index: int) -> list[Flip]:
    """Turns of a unit's whole way in a window about where it begins.

    Args:
        problem: of the window.
        heard: what its bearer has heard of what stands, and his fixes.
        way_m: where he was at each keyframe, k × 2 (m).
        index: of the walk.
    """
    walk, since = problem.layout.walks[index], reports_from(problem.layout, index)
    if not len(heard.t) and not (problem.rows.pairs[:, 2:4] == walk.number).any():
        # Where nothing tells one heading from another, they are no few, and his covariance knows all of them.
        return []
    angles = [*reversed(to_other_sides(heard, way_m, walk, since)), *all_round()]
    return [Flip(since, facing(way_m[since], angle)) for angle in angles]


def to_other_sides(heard: HeardRadios, way_m: Array, walk: Walk, since: int) -> list[float]:
    """Turns of a unit's whole way to the other side of each radio's line from where it begins (rad).

    Args:
        heard: what its bearer has heard.
        way_m: where he was at each keyframe, k × 2 (m).
        walk: the walk.
        since: the keyframe at which it begins.
    """
    led = way_m[walk.last] - way_m[since]
    found = []
    for radio_m in radios_of(heard):
        towards = radio_m - way_m[since]
        found.append(2.0 * float(np.arctan2(towards[1], towards[0]) - np.arctan2(led[1], led[0])))
    return found


def turn(layout: Layout, x: Array, index: int, flip: Flip) -> None:
    """Turn a unit's whole way in an estimate, and what its bearer has dropped along with it.

    Args:
        layout: of the window.
        x: the estimate, flat; changed in place.
        index: of the walk.
        flip: the turn, and since when it is one.
    """
    walk, states, image = layout.walks[index], layout.states(x, index), flip.image
    here = states[flip.since : walk.last + 1]
    here[:, :2] = image.of(here[:, :2])
    states[walk.first : walk.last + 1, 3] += image.turned_rad
    drops_along(layout, x, walk, image, flip.since)


def drops_along(
    layout: Layout, x: Array, walk: Walk, image: Image, since: int, until: int | None = None
) -> None:
    """Put what somebody has dropped in an estimate where an image of his way has it.

    Args:
        layout: of the window.
        x: the estimate, flat; changed in place.
        walk: his.
        image: of his way.
        since: the keyframe from which on.
        until: that up to which; none: to the end.
    """
    drops, size = layout.state.ledger.table("drops"), layout.length * layout.width
    dropped = (drops[:, 2] == walk.number) & (drops[:, 0] >= layout.grid[since])
    if until is not None:
        dropped &= drops[:, 0] < layout.grid[until]
    for number in drops[dropped, 1].astype(int).tolist():
        if number in layout.stands:
            start = size + layout.stands[number]
            x[start : start + 2] = image.of(x[start : start + 2])


def turns_whole(image: Image) -> bool:
    """Whether an image is a turn of all that a unit has led, along with what it faces."""
    by_rad = float(np.arctan2(image.sine, image.cosine))
    turned = image.flip > 0.0 and image.turned_rad != 0.0
    return turned and abs(within_pi(by_rad - image.turned_rad)) < SAME


def faced(image: Image, by_rad: float) -> Image:
    """An image of a unit's way, with another turn of what the unit faces."""
    if not turns_whole(image):
        return replace(image, turned_rad=by_rad)
    centre_m = np.linalg.lstsq(np.eye(2) - image.matrix, image.shift_m, rcond=None)[0]
    return facing(np.asarray(centre_m, dtype=np.float64), by_rad)


def all_round() -> list[float]:
    """Turns to be tried where a unit may face anything (rad)."""
    return [2.0 * np.pi * j / physics.TURNS for j in range(1, physics.TURNS)]


def facing(centre_m: Array, by_rad: float) -> Image:
    """A turn to the left about a place, with which what a unit faces turns along."""
    image = turned_about(centre_m, by_rad)
    return replace(image, turned_rad=within_pi(by_rad))
