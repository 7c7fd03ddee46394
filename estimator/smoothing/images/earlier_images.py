"""Images of somebody's way that begin before the window: what is known from before it has one as well."""

from collections.abc import Mapping

import numpy as np

from estimator.fusion.images import EVER, Alternative, Image
from estimator.graph.dense import Array
from estimator.smoothing.images.alternatives import Mode
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

CLEARER = 0.3
"""Who is shown at one place is shown at another one when that is likelier by this much (log likelihood)."""
LEAST = 0.01
"""Odds below which another way is not told of."""
ITERATIONS = 8


def still_likely(problem: Problem, solved: Solution) -> tuple[Problem, Solution, list[Mode]]:
    """The likeliest of the images that were likely when their beginning left the window, and the others.

    How likely they were then stays as it was; what the window says comes on top.

    Args:
        problem: of a window.
        solved: its solution.

    Returns:
        The window, whose prior may be an image of what it was; its solution; the others.
    """
    modes: list[Mode] = []
    for other, images in _begun_before(problem.layout):
        if problem.prior is None and other.since_t == EVER:
            # The window knows all that speaks for it and against it: see `unknown_north`.
            continue
        prior = None if problem.prior is None else problem.prior.imaged(images)
        there = Problem(problem.layout, problem.rows, prior)
        try:
            found = there.solve(moved(problem.layout, solved.x, images), iterations=ITERATIONS)
        except ValueError:
            # It hangs in the air there: that is no solution.
            continue
        less = found.cost - solved.cost
        if less + np.log((1.0 - other.share) / other.share) < -CLEARER:
            back = {number: image.back() for number, image in images.items()}
            modes = [_after(mode, back) for mode in modes]
            if -less < -np.log(LEAST):
                way = other.way.back()
                modes.append(Mode(other.of, 1.0 - other.share, solved.x, other.since_t, way, back))
            problem, solved = there, found
        elif less < -np.log(LEAST):
            modes.append(Mode(other.of, other.share, found.x, other.since_t, other.way, images))
    return problem, solved, modes


def _begun_before(layout: Layout) -> list[tuple[Alternative, dict[int, Image]]]:
    """Each image that has begun before the window, and where it puts everybody, by number."""
    found: dict[tuple[int, float, Image], tuple[Alternative, dict[int, Image]]] = {}
    for node in layout.state.nodes.values():
        # Where a retired one may have been stands in his covariance: nothing will tell any more.
        for other in node.otherwise if node.mode != "retired" else ():
            if other.since_t < layout.grid[0]:
                found.setdefault(other.mode, (other, {}))[1][node.index] = other.image
    return list(found.values())


def _after(mode: Mode, back: Mapping[int, Image]) -> Mode:
    """A solution as images of another one than before."""
    images = {n: mode.images.get(n, Image()).after(back.get(n, Image())) for n in {*mode.images, *back}}
    return mode._replace(images=images)


def moved(layout: Layout, x: Array, images: Mapping[int, Image]) -> Array:
    """An estimate with nodes at images of where they are, flat."""
    there, size = x.copy(), layout.length * layout.width
    for i, walk in enumerate(layout.walks):
        image, states = images.get(walk.number), layout.states(there, i)
        if image is not None and walk.way is None:
            image.move(states)
        elif image is not None:
            states[:, :2] = image.of(states[:, :2])
            states[:, 3] += image.turned_rad
    for number, image in images.items():
        if number in layout.stands:
            start = size + layout.stands[number]
            there[start : start + 2] = image.of(there[start : start + 2])
    return there
