"""The likeliest of the ways that somebody may have gone who is followed by ranges alone, and the others.

A parabola about one way knows nothing of its images. So the window is solved from each of them too: the
likeliest counts, and how likely the others are is told along with it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.images import EVER, Image
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.images.alternatives import Mode, same_now
from estimator.smoothing.images.candidates import WAYS, asked_again, asked_of
from estimator.smoothing.images.companions import CostedImage, companions_of, costed_images
from estimator.smoothing.images.earlier_images import LEAST, still_likely
from estimator.smoothing.images.flip_ambiguity import (
    LIVE,
    RECENT_S,
    Effort,
    Flip,
    exposed,
    flips,
    loose_steps,
)
from estimator.smoothing.images.heading_images import faced, reports_from, turns, turns_whole
from estimator.smoothing.images.heard_radios import heard_by
from estimator.smoothing.images.image_estimates import Loose, apply_image, now_of
from estimator.smoothing.images.image_starts import SAME_RAD, ImageSolution, ImageStart, Subject, heading
from estimator.smoothing.images.near_radios import starts_near_radios
from estimator.smoothing.images.parts import Parts
from estimator.smoothing.images.same_floors import hold_floors
from estimator.smoothing.images.solutions import FAR, solutions
from estimator.smoothing.images.unknown_north import turned_maps
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

LEAST_TRIED = 2
"""So many images of each way are solved at least, where there are many ways."""


class JudgedImages(NamedTuple):
    """What is known of a window's images.

    Attributes:
        problem: the window; its prior may be an image of what it was.
        solved: the likeliest solution.
        modes: the others.
        exposed: an image fits what somebody has heard last as well: he may cross to it unseen.
        asked: walks of which it was asked where they are, by index: what the others face is still open.
    """

    problem: Problem
    solved: Solution
    modes: list[Mode]
    exposed: bool
    asked: frozenset[int]


def likeliest_image(problem: Problem, solved: Solution, effort: Effort = LIVE) -> JudgedImages:
    """The likeliest solution among the images of those who are followed by ranges alone, and the others.

    Args:
        problem: of a window.
        solved: a solution.
        effort: how much is asked.
    """
    again = asked_again(problem)
    if any(_compared(problem, solved, i, effort) for i in range(len(problem.layout.walks))):
        for _ in range(2):
            solved = hold_floors(problem, solved, effort.resting)
    problem, solved, before = still_likely(problem, solved)
    solved, apart = starts_near_radios(problem, solved, effort.whole)
    # Where nobody was known before, hardly anything tells yet.
    new = any(_is_new(problem.layout, i) for i in range(len(problem.layout.walks)))
    tied = {walk.number: problem.coupled.groups.home(i)[0] for i, walk in enumerate(problem.layout.walks)}
    group = [tied[walk.number] for walk in problem.layout.walks]
    told, open_to, changed = list[Mode](), dict[int, bool](), set(group)
    parts: Parts | None = None
    for _ in range(effort.rounds):
        if problem.rows.floors is not None:
            solved = hold_floors(problem, solved, effort.resting)
        led = _loose(problem, solved)
        asked = asked_of(problem, solved, led, again, effort)
        most = max(effort.tried * WAYS // max(len(asked), WAYS), LEAST_TRIED)
        # What was told of those who are tied to him was told beside somebody at a place where he is not.
        some = [i for i in asked if group[i] in changed]
        told, changed = [mode for mode in told if tied[mode.of] not in changed], set()
        for i in some:
            entered = solved
            if parts is None or parts.x is not solved.x:
                parts = Parts(problem, solved.x)
            solved, others, open_ = _judged(parts, solved, i, led, effort._replace(tried=most))
            if solved is not entered:
                changed.add(group[i])
                gone = solved.x - entered.x
                told = [m._replace(x=m.x + gone) if tied[m.of] != group[i] else m for m in told]
            # Those who change sides together are found at the image of each of them.
            known = [*before, *told]
            told += [m for m in others if not any(same_now(problem.layout, m.x, k.x) for k in known)]
            open_to[i] = open_ or bool(others)
        # Where it was not asked of all who may face anything, it is asked again soon anyway.
        if not changed or len(asked) < len(led) - len(again):
            break
    for mode in apart:
        if not any(same_now(problem.layout, mode.x, x) for x in (solved.x, *(m.x for m in (*before, *told)))):
            told.append(mode)
    # How all of a map is turned nobody finds out by asking again.
    sides = [mode for mode in before if mode.since_t != EVER]
    if problem.prior is None:
        was = solved
        solved, turned = turned_maps(problem, solved)
        told = [*(told if solved is was else []), *turned]
    problem.rows.widen(solved.x, solved.linear.jacobian)
    problem.rows.floors = None
    open_now = new or bool(sides) or any(open_to.values())
    return JudgedImages(problem, solved, [*before, *told], open_now, frozenset(open_to))


def _compared(problem: Problem, solved: Solution, index: int, effort: Effort) -> bool:
    """Whether solutions will be compared that put somebody elsewhere."""
    walk = problem.layout.walks[index]
    if not walk.node.moving:
        return False
    own = loose_steps(problem, solved, index)
    return bool(walk.node.otherwise or walk.node.turned or _flips(problem, solved, index, own, effort))


def _flips(
    problem: Problem, solved: Solution, index: int, own: NDArray[np.bool_], effort: Effort
) -> list[Flip]:
    walk, way_m = problem.layout.walks[index], problem.layout.states(solved.x, index)[:, :2]
    now = float(problem.layout.grid[-1])
    return flips(heard_by(problem, solved, walk), way_m, walk, own, now, effort)


def _is_new(layout: Layout, index: int) -> bool:
    """Whether somebody whom no unit leads has entered just now."""
    walk = layout.walks[index]
    entered_t = float(layout.times[walk.first, index])
    return walk.begins and walk.way is None and float(layout.grid[-1]) - entered_t < RECENT_S


def _loose(problem: Problem, solved: Solution) -> Loose:
    """Those walks that ranges alone have led, or a unit that may have faced anything."""
    found = {}
    for i, walk in enumerate(problem.layout.walks):
        if walk.node.moving:
            loose = loose_steps(problem, solved, i)
            if walk.node.turned or loose.any():
                found[i] = loose
    return found


def _judged(
    parts: Parts, solved: Solution, index: int, loose: Loose, effort: Effort
) -> tuple[Solution, list[Mode], bool]:
    """The likeliest solution among the images of one walk, the others, and whether he is exposed."""
    problem, layout = parts.problem, parts.problem.layout
    walk, now = layout.walks[index], float(layout.grid[-1])
    problem.rows.widen(solved.x, solved.linear.jacobian)
    own, heard = loose[index], heard_by(problem, solved, walk)
    way_m = layout.states(solved.x, index)[:, :2]
    found = _flips(problem, solved, index, own, effort) if own.any() else []
    if walk.node.turned:
        # Each way before has several headings since.
        effort = effort._replace(tried=effort.tried * 3 // 2)
        found += turns(problem, heard, way_m, index)
    known = _again(layout, solved.x, index, own)
    begun = _begun(parts, index, loose, known, found)
    starts = (ImageStart(apply_image(layout, solved.x, index, flip, loose), flip) for flip in begun)
    best, *others = solutions(Subject(problem, index, effort.whole), parts, solved, starts, effort.tried)
    modes = _modes(layout, best, others, index, loose)
    last = bool(own[walk.last - 1])
    return best.solved, modes, last and exposed(heard, now)


def _again(layout: Layout, x: Array, index: int, loose: NDArray[np.bool_]) -> list[Flip]:
    """The images that were likely when the window was last solved, the likeliest first."""
    walk = layout.walks[index]
    known = [o for o in walk.node.otherwise if o.of == walk.number and o.since_t >= layout.grid[0]]
    known.sort(key=lambda other: -other.share)
    since = [int(np.searchsorted(layout.grid, other.since_t - 1e-6)) for other in known]
    by_rad = _turned_by(layout, x, index)
    ways = [
        faced(o.way, within_pi(o.way.turned_rad - by_rad))
        if by_rad != 0.0 and o.way.turned_rad != 0.0
        else o.way
        for o in known
    ]
    return [
        Flip(k, way)
        for k, way in zip(since, ways, strict=True)
        if walk.first <= k < walk.last and (loose[k] or way.turned_rad != 0.0)
    ]


def _turned_by(layout: Layout, x: Array, index: int) -> float:
    """By how much a unit's way is turned in an estimate since its images were told (rad)."""
    if layout.walks[index].way is None:
        return 0.0
    # Where it begins: a filter that does not know where its newest step led swings to and fro with it.
    now, was = (layout.states(one, index)[reports_from(layout, index), 3] for one in (x, layout.start()))
    turned = within_pi(now - was)
    return turned if abs(turned) > SAME_RAD else 0.0


def _begun(parts: Parts, index: int, loose: Loose, again: list[Flip], new: list[Flip]) -> list[Flip]:
    """Images to begin from: the cheapest of each that is known, then new ones that do not cost far too much.

    Args:
        parts: of a window, with all others where they are in its estimate.
        index: of the walk.
        loose: see `image_estimates.Loose`.
        again: images that were likely when the window was last solved.
        new: others.
    """
    others = companions_of(parts.problem, index, loose)
    best, found = [], list[CostedImage]()
    for flip in again:
        ways = costed_images(parts, index, loose, flip, others)
        # As it was told; what else its unit may face then, if it was told before, is asked as of new ones.
        told = [one for one in ways if flip.image.turned_rad in (0.0, one.flip.image.turned_rad)]
        best.append(min(told, key=lambda one: one.cost).flip)
        found += [one for one in ways if one.flip.image != flip.image]
    for flip in new:
        found += costed_images(parts, index, loose, flip, others)
    found.sort(key=lambda one: one.cost)
    # A way of minutes that is turned as a whole is far off at its end, however well it fits once solved.
    near = [one for one in found if one.cost < FAR or turns_whole(one.flip.image)]
    return [*best, *(one.flip for one in near)]


def _modes(
    layout: Layout, best: ImageSolution, others: list[ImageSolution], index: int, loose: Loose
) -> list[Mode]:
    """Solutions by how likely they are, and as images of the likeliest one."""
    odds = [float(np.exp(best.solved.cost - one.solved.cost)) for one in others]
    total, found = 1.0 + sum(odds), []
    for one, each in zip(others, odds, strict=True):
        if each > LEAST:
            ways, images = _between(layout, index, best, one), {}
            for i, way in ways.items():
                walk = layout.walks[i]
                if loose[i][walk.last - 1] or walk.node.turned:
                    images[walk.number] = now_of(walk, way)
            number, since_t = layout.walks[index].number, layout.grid[max(one.flip.since, best.flip.since)]
            found.append(Mode(number, each / total, one.solved.x, float(since_t), ways[index], images))
    return found


def _between(layout: Layout, index: int, best: ImageSolution, one: ImageSolution) -> dict[int, Image]:
    """One solution as images of the ways of the likeliest one, by index of the walk."""
    was, gone = (dict([(index, each.flip), *each.flip.along]) for each in (best, one))
    found = {}
    for i in sorted({*was, *gone}):
        back = was[i].image.back() if i in was else Image()
        image = gone[i].image.after(back) if i in gone else back
        if image.turned_rad != 0.0:
            # What it began from was not where it has led to.
            by_rad = heading(layout, i, one.solved.x) - heading(layout, i, best.solved.x)
            image = faced(image, within_pi(by_rad))
        found[i] = image
    return found
