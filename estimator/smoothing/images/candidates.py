"""Of whom it is asked where he may be instead, each time that a window is solved.

Of everybody whom ranges alone lead, or did a moment ago, and of whom an image is likely. What a unit faces,
and where those are who were silent once, is asked of some each time, in turns: what it costs does not grow
with the crew.
"""

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

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
FOUND, IN_TURN, MISPLACED = 1, 2, 3
"""Of so many units it is asked again what they face, though it was found; of so many that may face anything
in turns; and of so many of the others, those whom readings contradict most."""
SETTLED, SETTLED_S = 1, 60.0
"""Of so many it is asked again each time who were silent once, and have been led again for so long, with no
image left of where they are."""


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
    alone = [i for i in loose if not layout.walks[i].node.otherwise]
    led = [i for i in alone if not loose[i].any()]
    found, unsure = [i for i in led if i in again], [i for i in led if i not in again]
    settled = [] if effort.whole else [i for i in alone if i not in led and _is_settled(layout, i, loose[i])]
    if effort.whole:
        some = {*_each_time(layout, found, WAYS), *unsure}
    else:
        some = {*_each_time(layout, found, FOUND), *_each_time(layout, unsure, IN_TURN)}
        some.update(_each_time(layout, settled, SETTLED))
        rest = [i for i in unsure if i not in some]
        if len(rest) > MISPLACED:
            against = _contradicted(problem, solved)
            rest.sort(key=lambda i: -float(against[i]))
        some.update(rest[:MISPLACED])
    return [i for i in loose if i in some or i not in (*led, *settled)]


def _is_settled(layout: Layout, index: int, loose: NDArray[np.bool_]) -> bool:
    """Whether a unit has led a walk again for so long that images of it would have been found."""
    walk = layout.walks[index]
    led_t = layout.times[min(int(np.flatnonzero(loose)[-1]) + 1, walk.last), index]
    led = walk.way is not None and not walk.node.turned
    return bool(led and layout.grid[-1] - led_t > SETTLED_S)


def _each_time(layout: Layout, walks: list[int], most: int) -> list[int]:
    """So many of some walks, those first who were not asked about for longest; no rhythm leaves anybody out.

    Args:
        layout: of the window; its state is told who is asked about.
        walks: their indices.
        most: how many of them.
    """
    state, now = layout.state, float(layout.grid[-1])
    lives = {i: state.life(layout.walks[i].number) for i in walks}
    # In one window the same are asked about again.
    some = sorted(walks, key=lambda i: (lives[i].image_asked_t != now, lives[i].image_asked_t))[:most]
    for i in some:
        state.keep(replace(lives[i], image_asked_t=now))
    return some


def _contradicted(problem: Problem, solved: Solution) -> Array:
    """How many readings of each walk contradict a solution."""
    layout = problem.layout
    found = np.zeros(len(layout.walks))
    for columns in problem.rows.columns.T:
        on = (columns >= 0) & (columns < layout.width) & (columns % STATES == 0)
        np.add.at(found, columns[on] // STATES, 1.0 - solved.weighted.good[on])
    return found
