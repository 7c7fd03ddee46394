"""Whose unit faces elsewhere after a pause: looking back, all pauses of all units are asked about at once.

By powers alone a way is bent a little with each solution of a window, and with the next one nothing seems to
have turned (`turned_frames`). Of a whole incident far more tells of it.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.memory.ledger import COLUMNS, GIVEN, UNSEEN, own_rows
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.pauses import PAUSE_S, runs
from estimator.smoothing.keyframes.walks import HEADING
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.taken_turns import LEAST_RAD, TAKEN, let_turn

TURN = COLUMNS["steps"].index("turn2")


class Pause(NamedTuple):
    """A time in which a unit told nothing.

    Attributes:
        of: index of its walk.
        since_t: when it began (s).
        until_t: when it ended (s).
    """

    of: int
    since_t: float
    until_t: float


def turned_at_pauses(
    problem: Problem, solved: Solution, build: Callable[[FusionState], Problem], resting: float
) -> tuple[Problem, Solution]:
    """Let units have turned in their pauses where that is clearly likelier.

    Args:
        problem: of the whole incident; its state is told which have.
        solved: its solution.
        build: makes the same problem of another state.
        resting: see `Problem.solve`.
    """
    layout = problem.layout
    asked = [pause for index in range(len(layout.walks)) for pause in pauses(layout, index)]
    if not asked:
        return problem, solved
    floors = problem.rows.through(solved.x)
    try:
        found = _turned(problem, asked, floors, build).solve(solved.x, METRES_OFF, resting=resting)
        turns = [pause for pause in asked if abs(_turned_rad(layout, found.x, pause)) > LEAST_RAD]
        if not turns or solved.cost - found.cost < TAKEN:
            return problem, solved
        trial = _turned(problem, turns, floors, build)
        found = trial.solve(found.x, resting=resting)
    except ValueError:
        # Who may face anything after each pause may hang in the air: then nothing is known of turns.
        return problem, solved
    if solved.cost - found.cost < TAKEN * len(turns):
        return problem, solved
    anew = build(trial.layout.state)
    return anew, anew.solve(found.x, resting=resting)


def pauses(layout: Layout, index: int) -> list[Pause]:
    """When the unit of a walk told nothing for a while, and then told again.

    Not those in which it is known to have turned already.

    Args:
        layout: of the incident.
        index: of the walk.
    """
    walk = layout.walks[index]
    if walk.way is None:
        return []
    steps = own_rows(layout.state.ledger.table("steps"), walk.number)
    turned_t, steps = steps[steps[:, TURN] >= ANYWHERE_RAD**2, 0], steps[steps[:, 0] > steps[:, 2]]
    found = []
    for begin, end in runs(steps[:, GIVEN] == UNSEEN):
        pause = Pause(index, float(steps[begin, 2]), float(steps[end, 0]))
        known = (turned_t > pause.since_t - PAUSE_S) & (turned_t < pause.until_t + PAUSE_S)
        inside = layout.times[walk.first, index] < pause.since_t and end + 1 < len(steps)
        if pause.until_t - pause.since_t > PAUSE_S and inside and not known.any():
            found.append(pause)
    return found


def _turned(
    problem: Problem,
    asked: list[Pause],
    floors: NDArray[np.bool_],
    build: Callable[[FusionState], Problem],
) -> Problem:
    """The incident with units turned by anything at the ends of pauses.

    A turn says nothing of heights: it costs by the same floors as without, the pairs that go through one.
    """
    other, layout = problem.layout.state.copy(), problem.layout
    for pause in asked:
        let_turn(other, layout.walks[pause.of].number, pause.until_t, 0.0)
    trial = build(other)
    trial.rows.floors = floors
    return trial


def _turned_rad(layout: Layout, x: Array, pause: Pause) -> float:
    """By how much a unit has turned in a pause (rad)."""
    walk = layout.walks[pause.of]
    times, headings = (
        layout.times[walk.first : walk.last + 1, pause.of],
        layout.states(x, pause.of)[:, HEADING],
    )
    own = headings[walk.first : walk.last + 1]
    before, after = np.searchsorted(times, [pause.since_t, pause.until_t], side="right")
    return float(own[min(after, len(own) - 1)] - own[max(before - 1, 0)])
