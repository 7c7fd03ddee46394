"""Maps that nothing but ranges and powers holds: all of it may be turned, or mirrored.

Distances tell nothing of directions. Where no unit leads anybody and one radio that is heard stands at a told
place, each solution of a window is one of a circle of them: which one, its start and its noise have chosen.
Where two stand at told places it is one of two. As long as the window knows where everybody began, it is
solved from some of the others as well.
"""

import math
from collections.abc import Sequence

import numpy as np

from estimator.fusion import physics
from estimator.fusion.images import EVER, Image, mirrored, turned_about
from estimator.graph.dense import Array
from estimator.smoothing.images.alternatives import APART_M, Mode, same_now
from estimator.smoothing.images.earlier_images import LEAST, moved
from estimator.smoothing.images.local_solution import local_solution
from estimator.smoothing.images.solutions import FAR, SLACKS_M
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

TURNS_RAD = (0.5 * math.pi, math.pi, 1.5 * math.pi)
"""With the map as it is, so many turns have the second moments of all there are."""


def turned_maps(problem: Problem, solved: Solution) -> tuple[Solution, list[Mode]]:
    """A window's solution, and what it is with all of its map turned, if nothing tells where north is.

    Args:
        problem: of a window that reaches back to where everybody began.
        solved: its solution.

    Returns:
        The solution, or one that is turned and clearly likelier; the others.
    """
    layout = problem.layout
    led = [walk for walk in layout.walks if walk.node.role == "responder"]
    if not led or any(walk.way is not None for walk in layout.walks):
        return solved, []
    images = _images(problem, solved.x)
    if not images:
        return solved, []
    found = [(Image(), solved), *_solved(problem, solved, images)]
    shown, best = min(found, key=lambda one: one[1].cost)
    if best.cost > solved.cost - physics.MODE_MARGIN:
        # A map that swings round for little could not be followed.
        shown, best = Image(), solved
    others = [(image.after(shown.back()), there) for image, there in found if there is not best]
    odds = [min(math.exp(best.cost - there.cost), 1.0) for _, there in others]
    modes = []
    for (image, there), each in zip(others, odds, strict=True):
        if each > LEAST:
            ways, share = {walk.number: image for walk in led}, each / (1.0 + sum(odds))
            modes.append(Mode(led[0].number, share, there.x, EVER, image, ways))
    return best, modes


def _images(problem: Problem, x: Array) -> list[Image]:
    """Turns about the told place that is heard most, else about where somebody began, and a reflection."""
    layout, told_m = problem.layout, _told_m(problem)
    centre_m = told_m[0] if told_m else layout.states(x, 0)[layout.walks[0].first, :2].copy()
    unknown = any(layout.state.life(number).absolute.believed_m is None for number in layout.stands)
    if not _reaches_out(layout, x, centre_m) or (len(told_m) > 1 and not unknown):
        # Of who walks alone among told places it is asked by himself, see `flip_ambiguity`.
        return []
    images = [turned_about(centre_m, by_rad) for by_rad in TURNS_RAD]
    if len(told_m) > 1:
        east, north = told_m[1] - centre_m
        images.append(mirrored(centre_m, math.atan2(north, east)))
    return images


def _told_m(problem: Problem) -> list[Array]:
    """The told places of radios that are heard, each once, that of the one heard most first."""
    heard, often = np.unique(problem.rows.pairs[:, 2:4], return_counts=True)
    count = dict(zip(heard.tolist(), often.tolist(), strict=True))
    told: dict[tuple[float, float], int] = {}
    for node in problem.layout.state.lives():
        where = node.place_m or node.absolute.believed_m
        if not node.moving and where is not None and node.index in count:
            told[where[0], where[1]] = told.get((where[0], where[1]), 0) + count[node.index]
    return [np.array(where) for where in sorted(told, key=lambda where: (-told[where], where))]


def _reaches_out(layout: Layout, x: Array, centre_m: Array) -> bool:
    """Whether anybody is so far from what the map is turned about that he would be elsewhere."""
    now_m = np.array([layout.states(x, i)[-1, :2] for i in range(len(layout.walks))])
    return bool((np.hypot(*(now_m - centre_m).T) > APART_M).any())


def _solved(problem: Problem, solved: Solution, images: Sequence[Image]) -> list[tuple[Image, Solution]]:
    """The solutions that images of all that nobody has told a place lead to, each once."""
    layout, found = problem.layout, list[tuple[Image, Solution]]()
    free = [walk.number for walk in layout.walks if walk.node.role == "responder"]
    free += [number for number in layout.stands if layout.state.life(number).absolute.believed_m is None]
    for image in images:
        x = moved(layout, solved.x, dict.fromkeys(free, image))
        if problem.at(x).cost > solved.cost + FAR:
            continue
        there = local_solution(problem, x, SLACKS_M, solved)
        known = (solved, *(one for _, one in found))
        if there is not None and not any(same_now(layout, there.x, one.x) for one in known):
            found.append((image, there))
    return found
