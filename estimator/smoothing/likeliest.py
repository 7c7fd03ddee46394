"""The likeliest of the ways that somebody may have gone who is followed by ranges alone, and the others.

A parabola about one way knows nothing of its images. So the window is solved from each of them too: the
likeliest counts, and how likely the others are is told along with it.
"""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.images import Image
from estimator.graph.dense import Array
from estimator.smoothing.earlier import CLEARER, ITERATIONS, LEAST, earlier
from estimator.smoothing.flips import LIVE, Effort, Flip, end_of, exposed, flips, heard_by, loose_steps
from estimator.smoothing.layout import Layout, Walk
from estimator.smoothing.otherwise import Mode, same_place
from estimator.smoothing.solve import Problem
from estimator.smoothing.solved import Solved
from estimator.smoothing.turns import reports_from, turn, turns

LEAST_TRIED, WAYS = 2, 3
"""So many images of each way are solved at least; beyond so many ways it is fewer for each."""
SOON = 4
"""Iterations after which an image is given up that is hopeless."""
FAR, HOPELESS = 600.0, 50.0
"""What an image costs more, in log likelihood, that is not solved at all, and that is given up."""
SAME_RAD = 0.4
"""Headings nearer to each other than this are one, and not at rest yet."""
BEGINNINGS = 3
"""Images of a way that put somebody at the same place now, from keyframes this near, are the same."""


class Judged(NamedTuple):
    """What is known of a window's images.

    Attributes:
        problem: the window; its prior may be an image of what it was.
        solved: the likeliest solution.
        modes: the others.
        exposed: an image fits what somebody has heard last as well: he may cross to it unseen.
    """

    problem: Problem
    solved: Solved
    modes: list[Mode]
    exposed: bool


class _Tried(NamedTuple):
    """A solution, where it puts somebody at epochs that are asked for (m), and the image it began from.

    Attributes:
        solved: the solution.
        places_m: the places, k × 2.
        facing_rad: where it is one of several headings, the last of them; else none.
        flip: the image.
    """

    solved: Solved
    places_m: Array
    facing_rad: float | None
    flip: Flip

    def same(self, other: Self) -> bool:
        """Whether both are the same solution: one of a heading may not be at rest yet far from its start."""
        if self.facing_rad is not None and other.facing_rad is not None:
            return bool(np.cos(self.facing_rad - other.facing_rad) > np.cos(SAME_RAD))
        return same_place(self.places_m, other.places_m)


def likeliest(problem: Problem, solved: Solved, effort: Effort = LIVE) -> Judged:
    """The likeliest solution among the images of those who are followed by ranges alone, and the others.

    Args:
        problem: of a window.
        solved: a solution.
        effort: how much is asked.
    """
    problem, solved, before = earlier(problem, solved)
    for _ in range(effort.rounds):
        modes, alike, entered = list(before), bool(before), solved
        led = _loose(problem, solved)
        most = max(effort.tried * WAYS // max(len(led), WAYS), LEAST_TRIED)
        for i in led:
            solved, others, open_ = _judged(problem, solved, i, effort._replace(tried=most))
            modes += others
            alike = alike or open_ or bool(others)
        if solved is entered:
            break
        # What was told of the others was told beside somebody at a place where he is not.
    problem.rows.widen(solved.x, solved.linear.jacobian)
    return Judged(problem, solved, modes, alike)


def _loose(problem: Problem, solved: Solved) -> list[int]:
    """Those walks that ranges alone have led, or a unit that may have faced anything."""
    walks = enumerate(problem.layout.walks)
    return [
        i
        for i, walk in walks
        if walk.node.moving and (walk.node.turned or loose_steps(problem, solved, i).any())
    ]


def _judged(problem: Problem, solved: Solved, index: int, effort: Effort) -> tuple[Solved, list[Mode], bool]:
    """The likeliest solution among the images of one walk, the others, and whether he is exposed."""
    layout = problem.layout
    walk, now = layout.walks[index], float(layout.grid[-1])
    problem.rows.widen(solved.x, solved.linear.jacobian)
    loose, heard = loose_steps(problem, solved, index), heard_by(problem, solved, walk)
    way_m = layout.states(solved.x, index)[:, :2]
    found = flips(heard, way_m, walk, loose, now, effort) if loose.any() else []
    if walk.node.turned:
        found += turns(heard, way_m, walk, reports_from(layout, index))
    begun = [*_again(layout, walk, loose), *_cheapest(problem, solved.x, index, loose, found)]
    best, *others = _solutions(problem, solved, index, loose, begun, effort)
    last = bool(loose[walk.last - 1])
    modes = _modes(layout, best, others, walk, last or walk.node.turned)
    return best.solved, modes, last and exposed(heard, now)


def _flipped(layout: Layout, x: Array, index: int, loose: NDArray[np.bool_], flip: Flip) -> Array:
    """An estimate with a way where an image has it, flat; what a unit has reported goes along as it is."""
    there, walk = x.copy(), layout.walks[index]
    if flip.image.turned_rad != 0.0:
        turn(layout, there, index, flip)
        return there
    end = end_of(flip, loose) - flip.since
    states = layout.states(there, index)[flip.since : walk.last + 1]
    if walk.way is None:
        flip.image.move(states[: end + 1])
        return there
    was = states[end, :2].copy()
    states[: end + 1, :2] = flip.image.of(states[: end + 1, :2])
    states[end + 1 :, :2] += states[end, :2] - was
    return there


def _again(layout: Layout, walk: Walk, loose: NDArray[np.bool_]) -> list[Flip]:
    """The images that were likely when the window was last solved, the likeliest first."""
    known = [o for o in walk.node.otherwise if o.of == walk.number and o.since_t >= layout.grid[0]]
    known.sort(key=lambda other: -other.share)
    since = [int(np.searchsorted(layout.grid, other.since_t - 1e-6)) for other in known]
    return [
        Flip(k, other.way)
        for k, other in zip(since, known, strict=True)
        if walk.first <= k < walk.last and (loose[k] or other.way.turned_rad != 0.0)
    ]


def _cheapest(
    problem: Problem, x: Array, index: int, loose: NDArray[np.bool_], images: list[Flip]
) -> list[Flip]:
    """Images in order of what they cost unsolved, without those that cost far too much."""
    most = problem.at(x).cost + FAR
    costs = np.array([problem.at(_flipped(problem.layout, x, index, loose, flip)).cost for flip in images])
    return [images[k] for k in np.argsort(costs, kind="stable").tolist() if costs[k] < most]


def _solutions(
    problem: Problem,
    solved: Solved,
    index: int,
    loose: NDArray[np.bool_],
    begun: list[Flip],
    effort: Effort,
) -> list[_Tried]:
    """The solutions that images of a way lead to, that which is to be shown first."""
    layout, walk = problem.layout, problem.layout.walks[index]
    asked = slice(walk.first if effort.whole else walk.last, walk.last + 1)

    def tried_of(one: Solved, flip: Flip) -> _Tried:
        way = layout.states(one.x, index)
        turned = walk.node.turned and (flip.image.turned_rad != 0.0 or one is solved)
        return _Tried(one, way[asked, :2], float(way[walk.last, 3]) if turned else None, flip)

    found = [tried_of(solved, Flip(0, Image()))]
    tried: list[tuple[int, Array]] = []
    for flip in begun:
        x = _flipped(layout, solved.x, index, loose, flip)
        start_m = layout.states(x, index)[asked, :2].copy()
        if any(abs(flip.since - k) < BEGINNINGS and same_place(start_m, at) for k, at in tried):
            continue
        if len(tried) == effort.tried:
            break
        tried.append((flip.since, start_m))
        there = _solved(problem, x, found[0].solved.cost + HOPELESS)
        if there is None:
            continue
        new = tried_of(there, flip)
        same = next((k for k, one in enumerate(found) if one.same(new)), None)
        if same is None:
            found.append(new)
        elif there.cost < found[same].solved.cost - CLEARER:
            found[same] = new._replace(flip=found[same].flip)
    best = min(found, key=lambda one: one.solved.cost)
    if best.solved.cost > found[0].solved.cost - CLEARER:
        best = found[0]
    return [best, *(one for one in found if one is not best)]


def _solved(problem: Problem, x: Array, most: float) -> Solved | None:
    """The solution from an estimate; None where there is none, or it still costs more than `most` soon."""
    try:
        found = problem.solve(x, iterations=SOON)
        if found.cost > most:
            return None
        return found if found.rests else problem.solve(found.x, iterations=ITERATIONS)
    except ValueError:
        # It hangs in the air there.
        return None


def _modes(layout: Layout, best: _Tried, others: list[_Tried], walk: Walk, loose: bool) -> list[Mode]:
    """Solutions by how likely they are, and as images of the likeliest one."""
    odds = [float(np.exp(best.solved.cost - one.solved.cost)) for one in others]
    back, total = best.flip.image.back(), 1.0 + sum(odds)
    found = []
    for one, each in zip(others, odds, strict=True):
        if each > LEAST:
            image = one.flip.image.after(back)
            since_t = float(layout.grid[max(one.flip.since, best.flip.since)])
            images = {walk.number: image} if loose else {}
            found.append(Mode(walk.number, each / total, one.solved.x, since_t, image, images))
    return found
