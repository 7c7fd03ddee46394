"""Who is carried while his unit stands: ranges and powers tell how he goes, and his unit that he does not.

A firefighter who is down is dragged or carried out; his boot hardly moves against what it lies on. Taken at
its word, a standstill is the surest thing that a unit tells: the readings that contradict it are outliers,
then breadcrumbs seem to have been kicked, and he is shown where he lay. So where his rival (`learned.rival`)
has any say, a window is also solved with what his unit has told while it stood left out.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion.entering.carried_bearer import HARDLY_MPS, JOLT_M, let_be_carried
from estimator.fusion.entering.unbelieved_steps import leave_behind, unbelieve
from estimator.fusion.memory.ledger import GIVEN, RANGE, UNSEEN, own_rows
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.unreliable_unit import is_contradicted, is_noisy, leads_elsewhere
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Walk
from estimator.smoothing.keyframes.pauses import runs
from estimator.smoothing.keyframes.walks import PLACES
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.agreeing_ranges import ranges_agree
from estimator.smoothing.units.frame_turns import KICKED
from estimator.smoothing.units.marginal_cost import marginal_cost
from estimator.smoothing.units.mounting_hypotheses import unlearned
from estimator.smoothing.units.told_most import told_most

LONG_S, LOOK_S = 5.0, 100.0
"""How long a unit stands at least, and how far back that is looked for."""
AGAIN = 0.3
"""It is asked again after so much of the time since it began to stand."""
CARRIED_MPS = 1.5
"""Nobody is carried faster than so."""
LATEST_S = (10.0, 20.0, 40.0, 80.0)
"""So long before its end he may have been taken up: he may have stood before."""
TAKEN = 9.0
"""Log likelihood over all ways from which on he was carried; `taken_turns.TAKEN` is as much."""
PLAIN = 18.0
"""Log odds of a rival that is right beyond doubt."""
HARDLY = 6.0
"""What is less likely by more (log likelihood) hardly may be."""
ITERATIONS, PLACE = 12, range(PLACES)


class Standstill(NamedTuple):
    """A time in which a unit told that it stood (s)."""

    since_t: float
    until_t: float


class Carrying(NamedTuple):
    """A window in which somebody was carried.

    Attributes:
        standstill: when.
        x: its solution, flat.
        gain: log likelihood over all ways, more than where he was not.
        placed: ranges have told where he went.
    """

    standstill: Standstill
    x: Array
    gain: float
    placed: bool


def carried_bearers(
    problem: Problem, solved: Solution, build: Callable[[FusionState], Problem], resting: float
) -> tuple[Problem, Solution]:
    """Let those have been carried of whom that is clearly likelier than that they stood.

    Args:
        problem: of a window; its state is told who was.
        solved: its solution.
        build: makes the same problem of another state.
        resting: see `Problem.solve`.
    """
    state, layout = problem.layout.state, problem.layout
    for i, walk in enumerate(layout.walks):
        node = state.life(walk.number)
        if not _led(node, walk) or not is_contradicted(node):
            continue
        steps = own_rows(state.ledger.table("steps"), walk.number)
        stood = list(standstills(steps, state.newest_t - LOOK_S))
        known = leads_elsewhere(node, *layout.end_of(solved.x, i))
        if not stood or not (known or _is_due(node, stood[-1], state.newest_t)):
            continue
        asked = stood if known else stood[-1:]
        tried = [(_tried(problem, solved, i, one, build, resting), one) for one in asked]
        found = [_longest(some, one) for some, one in tried if some]
        best = max(found, key=lambda carrying: carrying.gain, default=None)
        if best is None:
            continue
        # As long as it is not clear, look again soon.
        state.keep(replace(node, standing_asked_t=state.newest_t))
        state.suspected = state.suspected or best.gain > 0.0
        if best.gain > TAKEN or (best.gain > -HARDLY and _is_plain(node, best.standstill)):
            let_be_carried(state, node.node, *best.standstill, best.placed)
            problem = build(state)
            solved = problem.solve(best.x, resting=resting)
    return problem, solved


def standstills(steps: Array, since_t: float) -> Iterator[Standstill]:
    """When a unit told that it stood.

    Args:
        steps: its rows of the ledger, in order of epoch.
        since_t: only of those that end later (s).
    """
    t, from_t = steps[:, 0], steps[:, 2]
    told, believed = t > from_t, steps[:, GIVEN] != UNSEEN
    still = told & believed & (np.hypot(steps[:, 3], steps[:, 4]) < HARDLY_MPS * (t - from_t))
    for begin, end in runs(told & ~still):
        jolt_m = steps[begin : end + 1, 3:5].sum(axis=0)
        still[begin : end + 1] = believed[begin : end + 1].all() and np.hypot(*jolt_m) < JOLT_M
    for begin, end in runs(still | ~told):
        if t[end] > since_t and t[end] - from_t[begin] > LONG_S and still[begin : end + 1].any():
            yield Standstill(float(from_t[begin]), float(t[end]))


def _led(node: NodeState, walk: Walk) -> bool:
    """Whether a unit leads its bearer."""
    if walk.way is None or node.index != walk.number or node.mode != "unit":
        return False
    return node.apart is None and node.carried_t is None and node.changed is None


def _is_due(node: NodeState, stood: Standstill, now: float) -> bool:
    """Whether it is to be asked whether he was carried whose unit has become far noisier, and no more.

    He may be shown where his rival has him by then. The longer ago it stood, the more rarely it is asked.
    """
    waited_s = now - node.standing_asked_t
    return is_noisy(node) and waited_s > max(LONG_S, AGAIN * (now - stood.since_t))


def _is_plain(node: NodeState, stood: Standstill) -> bool:
    """Whether a rival is plainly right while a unit still stands: it is told by what changes where he stands.

    Of a window readings at one place share their errors: however much they change there, they say little.
    """
    stands = node.unit_t is not None and stood.until_t >= node.unit_t
    return stands and node.rival is not None and node.rival.odds > PLAIN


def _tried(
    problem: Problem,
    solved: Solution,
    index: int,
    stood: Standstill,
    build: Callable[[FusionState], Problem],
    resting: float,
) -> list[Carrying]:
    """The window with somebody carried in the end of a standstill: in ever more of it while that helps."""
    layout, walk = problem.layout, problem.layout.walks[index]
    plain = unlearned(layout.state)
    # What he is heard counts alike in both, as of who has gone on.
    leave_behind(plain, walk.number, *stood)
    as_it_is = build(plain)
    # Who is carried says nothing of floors: both cost by the same ones.
    as_it_is.rows.floors = floors = as_it_is.rows.through(solved.x)
    placed, found = _ranged(problem, walk, stood), list[Carrying]()
    try:
        known = as_it_is.solve(solved.x, iterations=ITERATIONS, resting=resting)
        before = marginal_cost(as_it_is, known, PLACE).all
        for since_t in _beginnings(problem, known.x, index, stood):
            other, carried_in = plain.copy(), stood._replace(since_t=since_t)
            unbelieve(other, walk.number, *carried_in, placed)
            trial = build(other)
            trial.rows.floors = floors
            start = _shifted(problem, known.x, index, carried_in)
            carried = trial.solve(start, METRES_OFF, len(METRES_OFF) + ITERATIONS, resting)
            most = max(told_most(as_it_is, known, trial, carried, walk) - KICKED, 0.0)
            gain = before - marginal_cost(trial, carried, PLACE).all - most
            if not ranges_agree(trial, carried, walk.number, since_t):
                gain = min(gain, 0.0)
            found.append(Carrying(carried_in, carried.x, gain, placed))
            if gain < max(one.gain for one in found) - HARDLY:
                break
    except ValueError:
        # Readings contradict each other beyond all measure: what has been found so far counts.
        pass
    return found


def _beginnings(problem: Problem, x: Array, index: int, stood: Standstill) -> list[float]:
    """Since when somebody may have been carried in a standstill (s), the latest first.

    Not so late that he would have got to where his rival has him faster than anybody is carried.
    """
    soonest_s = float(np.hypot(*_off_m(problem, x, index))) / CARRIED_MPS
    latest = [stood.until_t - s for s in LATEST_S if soonest_s < s < stood.until_t - stood.since_t]
    return [*latest, stood.since_t]


def _longest(found: Sequence[Carrying], stood: Standstill) -> Carrying:
    """The longest time in which somebody may have been carried: who stood for some of it is less sure.

    By powers alone nobody knows when that began.
    """
    most = max(one.gain for one in found)
    longest = max((one for one in found if one.gain > most - HARDLY), key=lambda one: -one.standstill.since_t)
    since_t = longest.standstill.since_t
    if not longest.placed:
        since_t = min(since_t, max(stood.since_t, stood.until_t - LOOK_S))
    return longest._replace(gain=most, standstill=stood._replace(since_t=since_t))


def _ranged(problem: Problem, walk: Walk, stood: Standstill) -> bool:
    """Whether ranges tell where a walk's radio was in a time."""
    pairs = problem.rows.pairs
    inside = (pairs[:, 0] > stood.since_t) & (pairs[:, 0] <= stood.until_t) & (pairs[:, 1] == RANGE)
    return bool((pairs[inside, 2:4] == walk.number).any())


def _off_m(problem: Problem, x: Array, index: int) -> Array:
    """From where a solution has a walk end to where its rival does: east, north (m); nil: it has none."""
    rival = problem.layout.state.life(problem.layout.walks[index].number).rival
    if rival is None:
        return np.zeros(2)
    shown_m, t = problem.layout.end_of(x, index)
    return np.asarray(rival.place(t)[0] - shown_m)


def _shifted(problem: Problem, x: Array, index: int, stood: Standstill) -> Array:
    """An estimate, flat, with a way shifted from a standstill on by as much as its rival is off it now."""
    layout, walk, there = problem.layout, problem.layout.walks[index], x.copy()
    times, states = layout.times[walk.first : walk.last + 1, index], layout.states(there, index)
    share = np.clip((times - stood.since_t) / (stood.until_t - stood.since_t), 0.0, 1.0)
    states[walk.first : walk.last + 1, :2] += share[:, None] * _off_m(problem, x, index)
    return there
