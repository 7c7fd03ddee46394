"""Images of the way of somebody who is followed by ranges alone (flip ambiguity).

Ranges to one radio tell no direction, and those to two not on which side of the line through them somebody
is. Where he comes near that radio, or that line, he may leave it either way.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.images import Image
from estimator.graph.dense import Array
from estimator.smoothing.images.closest_approach import closest_approaches
from estimator.smoothing.images.heard_radios import HeardRadios, radios_of
from estimator.smoothing.images.symmetries import across, around
from estimator.smoothing.keyframes.layout import Walk
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

LOOSE_M2 = 0.2
"""A unit's step of a larger variance was made in silence."""
RECENT_S = 20.0


class Effort(NamedTuple):
    """How much is asked.

    Attributes:
        whole: where everybody was at any time, not only where he is now.
        nearest: so many of the times when he was nearest to a line or a radio.
        newest: and so many of the last.
        flips: so many images of a way, those that jump least.
        tried: so many are solved at most; fewer, where there are many ways.
        rounds: so often it is asked again beside those who have gone to their image.
        resting: see `Problem.solve`: of the solution that images are compared with, by the same floors.
    """

    whole: bool
    nearest: int
    newest: int
    flips: int
    tried: int
    rounds: int
    resting: float


LIVE = Effort(whole=False, nearest=2, newest=2, flips=24, tried=6, rounds=2, resting=0.1)
HURRIED = LIVE._replace(tried=2, rounds=1)
"""Where the same is soon asked again in full: the two likeliest with all others held, once."""
WHOLE = Effort(whole=True, nearest=6, newest=2, flips=48, tried=16, rounds=4, resting=0.001)


class Flip(NamedTuple):
    """An image of a way.

    Attributes:
        since: the keyframe from which on.
        image: the image.
        until: the keyframe up to which, if it is not its end.
        along: which others change sides along with him, by index of their walks, and how.
    """

    since: int
    image: Image
    until: int | None = None
    along: "tuple[tuple[int, Flip], ...]" = ()


def loose_steps(problem: Problem, solved: Solution, index: int) -> NDArray[np.bool_]:
    """Whether nothing, or a velocity at most, has led a walk on from each keyframe for some time, k.

    Args:
        problem: of a window.
        solved: its solution.
        index: of the walk.
    """
    layout = problem.layout
    walk, times = layout.walks[index], layout.times[:, index]
    found = np.zeros(layout.length, dtype=bool)
    if walk.way is None:
        found[walk.first : walk.last] = True
        return found
    found[walk.first : walk.last] = solved.motions[index].noise[:, 0, 0] > LOOSE_M2
    if not found.any():
        return found
    silent = np.zeros_like(found)
    for since_t, until_t in walk.way.silences(*times[[walk.first, walk.last]].tolist()).tolist():
        silent[:-1] |= (times[:-1] < until_t) & (times[1:] > since_t)
    return found & silent


def flips(
    heard: HeardRadios, way_m: Array, walk: Walk, loose: NDArray[np.bool_], now: float, effort: Effort
) -> list[Flip]:
    """Images of a walk's way that its readings do not contradict, those that jump least first.

    Args:
        heard: what it has heard.
        way_m: where it was at each keyframe, k × 2 (m).
        walk: the walk.
        loose: see `loose_steps`.
        now: end of the window (s).
        effort: how many are asked about.
    """
    found: list[Flip] = []
    for radios in (radios_of(heard), radios_of(heard.some(heard.t > now - RECENT_S))):
        for radio_m in radios:
            off_m = way_m - radio_m
            for k in closest_approaches(np.hypot(*off_m.T), walk, loose, effort.nearest, effort.newest):
                towards = float(np.arctan2(off_m[k, 1], off_m[k, 0]))
                found += [Flip(k, image) for image in around(radio_m, towards)]
        for image, off_m in across(radios, way_m):
            near = closest_approaches(np.abs(off_m), walk, loose, effort.nearest, effort.newest)
            found += [Flip(k, image) for k in near]
            if effort.whole:
                found += [Flip(k, image, until) for k, until in pairwise(near)]
    if effort.whole:
        found += _between(heard, way_m, walk, loose, effort)
    met = [_met(heard, way_m, flip, loose) for flip in dict.fromkeys(found)]
    found = [flip for flip in met if flip is not None]
    jumps_m = [float(np.hypot(*(flip.image.of(way_m[flip.since]) - way_m[flip.since]))) for flip in found]
    return [found[k] for k in np.argsort(np.array(jumps_m), kind="stable")[: effort.flips].tolist()]


def _between(
    heard: HeardRadios, way_m: Array, walk: Walk, loose: NDArray[np.bool_], effort: Effort
) -> list[Flip]:
    """Reflections there and back, in the line through the two radios that tell most for some time.

    Whoever is heard by other radios before and after may still have been on either side meanwhile.
    """
    found: list[Flip] = []
    for stretch in np.unique(heard.t // RECENT_S).tolist():
        off_s = heard.t - (stretch + 0.5) * RECENT_S
        about = heard.slab[np.abs(off_s) <= 1.5 * RECENT_S]
        own = loose.copy()
        own[: about.min()] = own[about.max() + 1 :] = False
        for image, off_m in across(radios_of(heard.some(np.abs(off_s) <= 0.5 * RECENT_S)), way_m):
            near = closest_approaches(np.abs(off_m), walk, own, effort.nearest, effort.newest)
            found += [Flip(k, image, until) for k, until in pairwise(near)]
    return found


def end_of(flip: Flip, loose: NDArray[np.bool_]) -> int:
    """The last keyframe that an image has of its own: where something leads on again, if not before."""
    end = flip.since + int(np.argmin(loose[flip.since :]))
    return end if flip.until is None else min(end, flip.until)


def _met(heard: HeardRadios, way_m: Array, flip: Flip, loose: NDArray[np.bool_]) -> Flip | None:
    """An image that puts him there where he is heard of next; None: what he has heard contradicts it.

    Args:
        heard: what he has heard.
        way_m: where he was at each keyframe, k × 2 (m).
        flip: the image.
        loose: see `loose_steps`.
    """
    end = end_of(flip, loose)
    heard = heard.some(heard.slab >= flip.since)
    within = heard.slab <= end
    if within.any() or flip.until is not None or not len(within):
        return None if heard.some(within).contradicts(flip.image) else flip
    # Nothing was heard before his unit led again: what it has led since then goes along as it is.
    met = int(heard.slab.min())
    off_m = flip.image.of(way_m[met]) - way_m[met]
    if heard.some(heard.slab == met).contradicts(Image(east_m=float(off_m[0]), north_m=float(off_m[1]))):
        return None
    return flip._replace(image=flip.image.through(way_m[end], way_m[end] + off_m))


def exposed(heard: HeardRadios, now: float) -> bool:
    """Whether an image fits what was heard last as well as where somebody is.

    Args:
        heard: what he has heard.
        now: end of the window (s).
    """
    last = heard.some(heard.t > now - RECENT_S)
    radios = radios_of(last)
    images = [image for image, _ in across(radios, last.here_m)] or [
        image for radio_m in radios for image in around(radio_m, 0.0)
    ]
    return any(not last.contradicts(image) for image in images)
