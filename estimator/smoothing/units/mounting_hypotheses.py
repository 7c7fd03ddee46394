"""How units may be worn, and the solutions of a window that follow."""

import math
from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.fusion.entering.introduce import turn_sigma
from estimator.fusion.entering.unit_mounting import RIGHT, Mounting, mount, mounting_of
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.measurements.bearing import within_pi
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.own_ways import own_ways
from estimator.smoothing.units.turned_starts import as_turned, same_turn, turned_starts

MIRRORED_RARE, TURNED_RARE = math.log(0.0025), math.log(0.0075)
"""Log odds that a unit is mirrored, and that it is turned: one of a hundred is worn wrongly."""
MIRRORED, TURNED = Mounting(True), Mounting(False, math.pi)
"""Wrong ways. How far a unit is turned is found: half round, none of them is as it was told."""
SLACKS_M = (3.0, 0.5, 0.1)
ITERATIONS = 8
HOPELESS = 60.0
"""What another way costs more before these, in log likelihood, that is given up at once."""


class MountingHypothesis(NamedTuple):
    """How units may be worn, and what follows.

    Attributes:
        worn: of those that differ from what they are taken for, by number of the node.
        x: the solution, flat.
        cost: of it, with what is unlikely beforehand, in log likelihood.
    """

    worn: tuple[tuple[int, Mounting], ...]
    x: Array
    cost: float


def hypotheses(
    state: FusionState,
    numbers: Sequence[int],
    x: Array,
    build: Callable[[FusionState], Problem],
    resting: float,
    anew: bool,
) -> list[MountingHypothesis]:
    """How units may be worn: first as they are taken to be; none where that has no solution.

    Args:
        state: the fusion.
        numbers: of the nodes whose units are asked about.
        x: the window's solution, flat.
        build: makes the window's problem of another state.
        resting: see `Problem.solve`.
        anew: also with everybody where his own unit has led him from the beginning: the solution may have
            bent the good ones to a wrong one.
    """
    plain = unlearned(state)
    floors: NDArray[np.bool_] | None = None
    wrong = [number for number in numbers if mounting_of(state.life(number)) != RIGHT]
    tried: list[dict[int, Mounting]] = [{}, *({number: RIGHT} for number in wrong)]
    for number in numbers:
        for way in (MIRRORED, TURNED):
            if mounting_of(state.life(number)) == way == MIRRORED:
                continue
            tried.append({number: way})
            tried += [{other: RIGHT, number: way} for other in wrong if other != number]
    found: list[MountingHypothesis] = []
    for each in tried:
        other = plain.copy()
        for number, way in each.items():
            mount(other, number, way)
        trial = build(other)
        # How a unit is worn says nothing of heights: whichever way it is, it costs by the same floors.
        floors = trial.rows.through(x) if floors is None else floors
        trial.rows.floors = floors
        odds = _odds(other, numbers)
        most = math.inf if not found else found[0].cost + odds
        turned = next((number for number, way in each.items() if way == TURNED), None)
        starts = [_reckoned(trial, x, each), *([_reckoned(trial, x)] if anew else [])]
        if turned is not None:
            starts = [way for start in starts for way in turned_starts(trial, start, turned)]
        ways = [_led(trial, start, most, resting) for start in starts]
        if not each:
            # As it is: how far off a start may be that is none may lead it away.
            ways.append(_rested(trial, x, resting))
        solved = min((way for way in ways if way is not None), key=lambda way: way.cost, default=None)
        if solved is None and not found:
            break
        if solved is None:
            continue
        if turned is None:
            found.append(MountingHypothesis(tuple(each.items()), solved.x, solved.cost - odds))
            continue
        way, led = as_turned(trial, solved.x, turned)
        told = (RIGHT, mounting_of(state.life(turned)))
        if not any(same_turn(way, one) for one in told) and not rather_faces(state, turned, way):
            worn = (each | {turned: way}).items()
            found.append(MountingHypothesis(tuple(worn), led, solved.cost - odds))
    best = min(found, key=lambda guess: guess.cost, default=None)
    if best is not None and best is not found[0]:
        # What was found along with it, as it is: that others lie better elsewhere speaks against no unit.
        trial = build(plain)
        trial.rows.floors = floors
        again = _led(trial, _reckoned(trial, best.x, dict(best.worn)), math.inf, resting)
        odds = _odds(plain, numbers)
        if again is not None and again.cost - odds < found[0].cost:
            found[0] = MountingHypothesis((), again.x, again.cost - odds)
    return found


def _odds(state: FusionState, numbers: Sequence[int]) -> float:
    """Log odds beforehand of how some units are worn."""
    total = 0.0
    for number in numbers:
        node = state.life(number)
        worn = mounting_of(node)
        total += MIRRORED_RARE if worn.mirrored else 0.0
        if worn.turned_rad != 0.0:
            # What it faces may be anything: each angle is as much rarer as that is wider than what was told.
            total += TURNED_RARE - math.log(ANYWHERE_RAD / turn_sigma(node))
    return total


def _led(problem: Problem, x: Array, known: float, resting: float) -> Solution | None:
    """Where units worn another way lead to; None: it is hopeless, or hangs in the air there.

    Args:
        problem: of the window, worn so.
        x: where to begin, flat.
        known: what it may cost to be as likely as it is thought to be, in log likelihood.
        resting: see `Problem.solve`.
    """
    try:
        begun = problem.solve(x, SLACKS_M, len(SLACKS_M), resting)
    except ValueError:
        return None
    return None if begun.cost > known + HOPELESS else _rested(problem, begun.x, resting)


def _rested(problem: Problem, x: Array, resting: float) -> Solution | None:
    """The solution from an estimate, flat, that is near it; None: it hangs in the air there."""
    try:
        return problem.solve(x, iterations=ITERATIONS, resting=resting)
    except ValueError:
        return None


def rather_faces(state: FusionState, number: int, way: Mounting) -> bool:
    """Whether a unit that seems to be turned rather faces as it was told, as loosely as that was.

    What it faces and how it is turned on its boot are one angle. Where nobody has told what it faces, another
    heading explains all that a turn does, and is not as rare: those are asked about as images of its way.

    Args:
        state: the fusion.
        number: of the node.
        way: how the unit may be worn.
    """
    sigma_rad = turn_sigma(state.life(number))
    return not way.mirrored and 0.5 * (within_pi(way.turned_rad) / sigma_rad) ** 2 < -TURNED_RARE


def unlearned(state: FusionState) -> FusionState:
    """A copy in which nothing is known of how noisy units and radios are: a wrong world has made it."""
    other = state.copy()
    other.noise = {}
    for node in list(other.nodes.values()):
        other.keep(replace(node, walk_factors=(1.0, 1.0)))
    return other


def _reckoned(problem: Problem, x: Array, some: Collection[int] | None = None) -> Array:
    """An estimate with units gone their own way from where they began, flat; crumbs lie along it.

    Args:
        problem: of the window.
        x: where all others are, flat.
        some: numbers of the units; None: all that began in it.
    """
    layout, begins = problem.layout, problem.layout.state.ledger.table("begins")
    known = () if problem.prior is None else problem.prior.keys
    there = x.copy()
    chosen = {
        walk.number: i
        for i, walk in enumerate(layout.walks)
        if walk.way is not None
        and ("walk", walk.number) not in known
        and (some is None or walk.number in some)
    }
    for number, i in chosen.items():
        rows = begins[begins[:, 1] == number]
        first = layout.states(there, i)[layout.walks[i].first]
        first[:3], first[3:] = rows[0, 4:7], (rows[rows[:, 2] == 1.0][-1, 10], 0.0, 0.0)
    return own_ways(problem, there, chosen)
