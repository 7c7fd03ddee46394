"""Who changes sides along with somebody: ranges between them keep them together.

Two who hear each other, and the same one or two radios, fit at the image of both as they fit where they are,
and not where only one of them is at his. And a unit that was switched on facing anything faces otherwise
where its bearer had come another way.
"""

from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.fusion.images import Image, mirrored
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.images.closest_approach import closest_approaches
from estimator.smoothing.images.flip_ambiguity import Flip, end_of
from estimator.smoothing.images.heading_images import all_round, facing, reports_from, turns_whole
from estimator.smoothing.images.image_estimates import Loose, apply_image
from estimator.smoothing.images.parts import Parts
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.problem.newton import Problem

COMPANY = 3
"""So many go along, or not, one by one: those who hear him, or each other, most. Of others only units that
may face anything do, all at once: the map as a whole may be mirrored."""
MOMENTS = 2
"""So many moments at which each of them may have changed sides, and one more: the last."""
HEADINGS = 2
"""So many turns all round are tried of a unit that is switched on later."""


class CostedImage(NamedTuple):
    """An image of a way, and what it costs more than that way, unsolved, in log likelihood."""

    cost: float
    flip: Flip


def companions_of(problem: Problem, index: int, loose: Loose) -> list[int]:
    """Those walks that may go along with one, who hear it, or each other, most first.

    Args:
        problem: of a window.
        index: of the walk.
        loose: see `image_estimates.Loose`.
    """
    if len(loose) == 1:
        return []
    layout, pairs = problem.layout, problem.rows.pairs
    at = np.full(len(layout.state.owners), -1)
    at[[walk.number for walk in layout.walks]] = np.arange(len(layout.walks))
    ends = at[pairs[:, 2:4].astype(np.intp)]
    heard = np.zeros((len(layout.walks), len(layout.walks)), dtype=np.int64)
    between = ends[(ends >= 0).all(axis=1)]
    np.add.at(heard, (between[:, 0], between[:, 1]), 1)
    heard += heard.T
    found = [index]
    while True:
        others = [
            j
            for j in loose
            if j not in found
            and heard[j, found].any()
            and (len(found) <= COMPANY or _turns_from_first(layout, j))
        ]
        if not others:
            return found[1:]
        found.append(max(others, key=lambda j: int(heard[j, found].sum())))


def costed_images(parts: Parts, index: int, loose: Loose, flip: Flip, others: list[int]) -> list[CostedImage]:
    """An image of a way, alone and with company, as its unit faces and as it may face then.

    Args:
        parts: of a window, with all others where they are in its estimate.
        index: of the walk.
        loose: see `image_estimates.Loose`.
        flip: the image.
        others: who may go along.
    """
    layout, x = parts.problem.layout, parts.x

    def told(one: Flip) -> CostedImage:
        # Unsolved, the beginning of a turned way tells more than its end.
        part = parts.of({index, *(i for i, _ in one.along)}, parts.stages(one)[0])
        return CostedImage(part.more(apply_image(layout, x, index, one, loose)), one)

    turned = [told(flip._replace(image=image)) for image in _faced(layout, x, index, flip, loose)]
    found = [told(flip), *_lowest(turned)]
    for alone in list(found):
        joined = best = alone
        for j in others[:COMPANY]:
            joins = _joins(layout, x, index, joined.flip, j, loose[j])
            options = [told(joined.flip._replace(along=(*joined.flip.along, (j, one)))) for one in joins]
            if options:
                joined = min(options, key=lambda one: one.cost)
                best = min(best, joined, key=lambda one: one.cost)
        rest = [_joins(layout, x, index, joined.flip, j, loose[j]) for j in others[COMPANY:]]
        for same in zip(*rest, strict=True):
            whole = (*joined.flip.along, *zip(others[COMPANY:], same, strict=True))
            best = min(best, told(joined.flip._replace(along=whole)), key=lambda one: one.cost)
        if best is not alone:
            found.append(best)
    return found


def _lowest(turned: list[CostedImage]) -> list[CostedImage]:
    """Of turns all round those that cost least, and less than their neighbours."""
    costs = np.array([one.cost for one in turned])
    lowest = np.flatnonzero((costs < np.roll(costs, 1)) & (costs <= np.roll(costs, -1)))
    return [turned[k] for k in lowest[np.argsort(costs[lowest], kind="stable")][:HEADINGS].tolist()]


def _faced(layout: Layout, x: Array, index: int, flip: Flip, loose: Loose) -> list[Image]:
    """An image of a way on which a unit is switched on, with turns of what that faces."""
    walk = layout.walks[index]
    if flip.until is not None or not _is_late(layout, index, flip.since, loose[index]):
        return []
    way_m = layout.states(x, index)[:, :2]
    mirror = _turn_of(flip.image, way_m[walk.last] - way_m[reports_from(layout, index)])
    return [replace(flip.image, turned_rad=within_pi(mirror + by)) for by in (0.0, *all_round())]


def _joins(
    layout: Layout, x: Array, index: int, flip: Flip, other: int, loose: NDArray[np.bool_]
) -> list[Flip]:
    """How another may go along with an image of a way.

    Args:
        layout: of the window.
        x: the estimate, flat.
        index: of the walk.
        flip: the image of its way.
        other: who goes along.
        loose: whether nothing has led him on from each keyframe.
    """
    walk, way_m = layout.walks[other], layout.states(x, other)[:, :2]
    found = []
    for image in _shared(layout, x, index, flip):
        turnable = walk.way is not None and walk.node.turned
        since = reports_from(layout, other) if turnable else walk.first
        led = way_m[walk.last] - way_m[since]
        if _turns_from_first(layout, other):
            found.append(Flip(since, facing(way_m[since], _turn_of(image, led))))
            continue
        jumps_m = np.hypot(*(image.of(way_m) - way_m).T)
        for k in closest_approaches(jumps_m, walk, loose, MOMENTS, 1):
            late = turnable and _is_late(layout, other, k, loose)
            turned = within_pi(_turn_of(image, led)) if late else 0.0
            found.append(Flip(k, replace(image, turned_rad=turned)))
    return found


def _shared(layout: Layout, x: Array, index: int, flip: Flip) -> list[Image]:
    """Images of the plane that put a way where an image has it: as a turn does, so does a reflection."""
    image = flip.image
    plain = replace(image, turned_rad=0.0)
    if not turns_whole(image):
        return [plain]
    way_m = layout.states(x, index)[:, :2]
    led = way_m[layout.walks[index].last] - way_m[flip.since]
    towards = float(np.arctan2(led[1], led[0])) + 0.5 * image.turned_rad
    return [mirrored(way_m[flip.since], towards), plain]


def _turns_from_first(layout: Layout, index: int) -> bool:
    """Whether a unit that may face anything has led somebody all the way."""
    walk = layout.walks[index]
    return walk.way is not None and walk.node.turned and reports_from(layout, index) == walk.first


def _is_late(layout: Layout, index: int, since: int, loose: NDArray[np.bool_]) -> bool:
    """Whether a unit that may have faced anything is switched on where its bearer has gone an image."""
    walk = layout.walks[index]
    if walk.way is None or not walk.node.turned:
        return False
    on = reports_from(layout, index)
    return since < on and end_of(Flip(since, Image()), loose) >= on - 1


def _turn_of(image: Image, led: Array) -> float:
    """By how much an image turns a way, 2 (m)."""
    there = image.matrix @ led
    return within_pi(float(np.arctan2(there[1], there[0]) - np.arctan2(led[1], led[0])))
