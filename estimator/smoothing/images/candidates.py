"""Of whom it is asked where he may be instead, each time that a window is solved.

Of everybody whom ranges alone have led, and of whom an image is likely. What a unit faces is asked of some
units each time: what it costs does not grow with the crew.
"""

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.smoothing.images.flip_ambiguity import Effort
from estimator.smoothing.images.image_estimates import Loose
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

WAYS = 3
"""Of so many ways as many images are asked about as there are; of more, fewer of each."""
FOUND, CLOCK, MISPLACED = 1, 2, 3
"""Of so many units it is asked again what they face, though it was found; of so many that may face anything
by the clock; and of so many of the others, those whom readings contradict most."""


def asked_again(problem: Problem) -> list[int]:
    """Let units face anything again of which it was found, as long as a window knows all that told it.

    What was heard by chance may have spoken for the wrong side, and what is heard later against it.

    Args:
        problem: of the window; these walks may face anything in it.

    Returns:
        Their indices.
    """
    layout, begins = problem.layout, problem.layout.state.ledger.table("begins")
    known = () if problem.prior is None else problem.prior.keys
    unsure = begins[(begins[:, 2] == 1.0) & (begins[:, 11] > physics.TURNED_SIGMA_RAD), 1]
    found = []
    for i, walk in enumerate(layout.walks):
        asked = walk.node.moving and not walk.node.turned and walk.number in unsure
        if asked and ("walk", walk.number) not in known:
            layout.walks[i] = walk._replace(node=replace(walk.node, turned=True))
            found.append(i)
    return found


def asked_of(problem: Problem, solved: Solution, loose: Loose, again: list[int], effort: Effort) -> list[int]:
    """Of whom it is asked where he is.

    Args:
        problem: of a window.
        solved: its solution.
        loose: see `image_estimates.Loose`.
        again: those of whose units it was found what they face.
        effort: how much is asked.

    Returns:
        Indices of their walks.
    """
    layout = problem.layout
    led = [i for i in loose if not loose[i].any() and not layout.walks[i].node.otherwise]
    found, unsure = [i for i in led if i in again], [i for i in led if i not in again]
    if effort.whole:
        some = {*_each_time(layout, found, WAYS), *unsure}
    else:
        some = {*_each_time(layout, found, FOUND), *_each_time(layout, unsure, CLOCK)}
        rest = [i for i in unsure if i not in some]
        if len(rest) > MISPLACED:
            against = _contradicted(problem, solved)
            rest.sort(key=lambda i: -float(against[i]))
        some.update(rest[:MISPLACED])
    return [i for i in loose if i in some or i not in led]


def _each_time(layout: Layout, walks: list[int], most: int) -> list[int]:
    """So many of some walks, by the clock: at the next times others.

    Args:
        layout: of the window.
        walks: their indices.
        most: how many of them.
    """
    first = int(layout.grid[-1]) * most % max(len(walks), 1)
    return (walks[first:] + walks[:first])[:most]


def _contradicted(problem: Problem, solved: Solution) -> Array:
    """How many readings of each walk contradict a solution."""
    layout = problem.layout
    found = np.zeros(len(layout.walks))
    for columns in problem.rows.columns.T:
        on = (columns >= 0) & (columns < layout.width) & (columns % STATES == 0)
        np.add.at(found, columns[on] // STATES, 1.0 - solved.weighted.good[on])
    return found
