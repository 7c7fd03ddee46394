"""Whose unit's frame has turned on the way: it was switched off and on again, or its bearer walks backwards.

By powers alone a window bends his way a little, finds them noisier, and shows him elsewhere as sure. So where
they cost more than when it was last asked in vain, all moments and angles of a turn are looked at; where one
is likely, the window is solved with it. Until that is taken, covariances hold where he would be by it.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.images import ALWAYS, Alternative, turned_about
from estimator.fusion.memory.ledger import CLAIMED, RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import mixture_cost
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.smoothing.images.frame_turns import (
    EAST_OF,
    HEARD,
    KICKED,
    TURNS_RAD,
    ToldWay,
    power_costs,
    turn_gains,
)
from estimator.smoothing.images.heading_images import drops_along
from estimator.smoothing.images.mounting_hypotheses import unlearned
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.layout import Walk
from estimator.smoothing.keyframes.walks import HEADING, SCALE
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

HINT, LATELY_S = 4.0, 20.0
"""Powers of so long that cost so much more (log likelihood) than they did hint at a turn."""
LOOK_S, EVERY_S = 100.0, 8.0
"""How far back turns are looked for, and how far apart."""
RARE, PAUSED = -10.0, -6.5
"""Log odds of a turn at one moment by one angle: in all of them, one in two hundred; one in eighty where the
unit told nothing for a while just before, as one that is switched off and on again."""
PAUSE_S = 3.0
TRIED, TAKEN = 3.0, 9.0
"""Log odds from which on the window is solved with a turn; and log likelihood of both solutions from which on
it is taken: of those that fit best, among all moments and angles."""
LEAST = 0.02
"""What is less likely is not told of."""
LIKELY = 0.2
"""From which share on it is asked again soon."""
SPEED_MPS, LEAST_RAD = 1.0, 0.5
EARLY_M2 = 4.0 * (SPEED_MPS * EVERY_S) ** 2 / 12.0
SLACKS_M, ITERATIONS = (3.0, 0.5, 0.1), 8
SHORTEST = 4
"""Keyframes that a walk has at least."""
EPSILON_S = 1e-3
STAIR_M = 0.5 * physics.FLOOR_M
"""Who is higher or lower than a radio by more is on a stair, or beyond a floor: that is in the way."""
Build = Callable[[FusionState], Problem]


class Turn(NamedTuple):
    """A turn of a unit's frame.

    Attributes:
        of: index of the walk.
        keyframe: before it.
        by_rad: how far, to the left.
        across2: variance of where he is by when exactly it was (m²).
    """

    of: int
    keyframe: int
    by_rad: float
    across2: float


def turned_frames(
    problem: Problem, solved: Solution, build: Build, resting: float
) -> tuple[Problem, Solution]:
    """Let a unit's frame turn where that is clearly likelier; where it is not clear, its node is told.

    Args:
        problem: of a window; its state is told who may have turned, and who has.
        solved: its solution.
        build: makes the same problem of another state.
        resting: see `Problem.solve`.
    """
    state, layout, rows = problem.layout.state, problem.layout, problem.rows
    powers = bool((rows.pairs[:, 1] == RSSI).any()) and not _is_open(problem)
    units = {
        i: walk.way
        for i, walk in enumerate(layout.walks)
        if powers and walk.way is not None and _askable(state.life(walk.number), walk)
    }
    asked = {layout.walks[i].number for i in units}
    for node in list(state.nodes.values()):
        if node.detours and node.index not in asked:
            state.keep(replace(node, detours=()))
    m, now = len(rows.pairs), float(layout.grid[-1])
    if not units:
        return problem, solved
    # As it was assumed: what was learned of it a wrong way has made. Through a floor a power tells nothing.
    share = physics.SHARED_NOISE
    variance = rows.nominal[:m] ** 2 * (1.0 - share + share * rows.alike[:m])
    variance[rows.through(solved.x)] = np.inf
    numbers = np.array([float(layout.walks[i].number) for i in units])
    costs = power_costs(rows.pairs, solved.linear.residual[:m], variance, now - LATELY_S, numbers)
    for (i, way), (cost, count, ranged) in zip(units.items(), costs.tolist(), strict=True):
        node = state.life(layout.walks[i].number)
        if ranged or not count:
            state.keep(replace(node, detours=()))
            continue
        each, paused_t = cost / count, _pause(node, way, now)
        if not (node.detours or paused_t is not None or (each - node.power_cost) * count > HINT):
            state.keep(replace(node, power_cost=min(node.power_cost, each)))
            continue
        turn, detours = _asked(problem, solved, i, way, variance, paused_t)
        state.keep(replace(node, detours=detours, power_cost=node.power_cost if detours else each))
        taken = None if turn is None else _taken(problem, solved, turn, build, resting)
        if taken is not None:
            return taken
    return problem, solved


def may_have_turned(state: FusionState) -> bool:
    """Whether anybody's unit may so well have turned that it is asked again soon."""
    return any(sum(other.share for other in node.detours) > LIKELY for node in state.nodes.values())


def _askable(node: NodeState, walk: Walk) -> bool:
    """Whether a unit leads its bearer, and it is known what it faced."""
    if node.index != walk.number or walk.last - walk.first < SHORTEST:
        return False
    worn = any(other.by_unit for other in node.otherwise)
    settled = not (worn or node.turned) and node.changed is None and node.apart is None
    return node.mode == "unit" and settled


def _is_open(problem: Problem) -> bool:
    """Whether crumbs may lie along a way that is wrong from its beginning (decision 0060).

    Then a turn would be taken, and another one, where it is a unit that is worn the wrong way round.
    """
    known = () if problem.prior is None else problem.prior.keys
    droppers = np.unique(problem.layout.state.ledger.table("drops")[:, 2]).astype(int).tolist()
    return any(("walk", w.number) not in known and w.number in droppers for w in problem.layout.walks)


def _pause(node: NodeState, way: Way, now: float) -> float | None:
    """When a unit began to tell again that had told nothing for a while (s), if it did lately."""
    whole_t = node.whole_t
    if not max(now - LOOK_S, way.begin_t + 2.0 * PAUSE_S) < whole_t < now:
        return None
    before, until = way.unseen_s(np.array([whole_t - 2.0 * PAUSE_S, whole_t])).tolist()
    return whole_t if until - before > PAUSE_S else None


def _asked(
    problem: Problem, solved: Solution, index: int, way: Way, variance: Array, paused_t: float | None
) -> tuple[Turn | None, tuple[Alternative, ...]]:
    """The turn with which to solve the window, if one is so likely; and where he may be by any."""
    layout, walk = problem.layout, problem.layout.walks[index]
    times = layout.times[walk.first : walk.last + 1, index]
    every = max(round(EVERY_S / float(np.diff(layout.grid).max())), 1)
    at = np.arange(len(times) - 2, 0, -every)[::-1]
    paused = -1 if paused_t is None else int(np.searchsorted(times, paused_t + EPSILON_S)) - 1
    if 0 < paused < len(times) - 1:
        at = np.union1d(at, [paused])
    at = at[times[at] > times[-1] - LOOK_S]
    heard, told, law = _heard(problem, solved, index, way, at, variance)
    odds = turn_gains(heard, told, EARLY_M2, law) + np.where(at == paused, PAUSED, RARE)[:, None]
    most = float(odds.max(initial=0.0))
    share = np.exp(odds - most)
    share /= share.sum() + math.exp(-most)
    by_angle, when = share.sum(axis=0), share.sum(axis=1)
    found = list[Alternative]()
    for angle in np.flatnonzero(by_angle > LEAST).tolist():
        about_m = told.moments[share[:, angle].argmax(), EAST_OF : EAST_OF + 2]
        there = turned_about(about_m, float(TURNS_RAD[angle]))
        found.append(Alternative(walk.number, float(by_angle[angle]), there, ALWAYS, there))
    if most < TRIED:
        return None, tuple(found)
    t, when = times[at], when / when.sum()
    middle_t = float(when @ t)
    k = int(np.abs(t - middle_t).argmin())
    by_rad = float(TURNS_RAD[share[k].argmax()])
    unsure_s2 = 0.0 if at[k] == paused else float(when @ (t - middle_t) ** 2) + EVERY_S**2 / 12.0
    across2 = 2.0 * SPEED_MPS**2 * unsure_s2 * math.sin(0.5 * by_rad) ** 2
    return Turn(index, walk.first + int(at[k]), by_rad, across2), tuple(found)


def _heard(
    problem: Problem, solved: Solution, index: int, way: Way, at: Indices, variance: Array
) -> tuple[Array, ToldWay, Array]:
    """What `turn_gains` asks of a walk at some of its keyframes: its powers, its way, the law of powers."""
    layout, rows, walk = problem.layout, problem.rows, problem.layout.walks[index]
    state = layout.state
    times, states = layout.times[walk.first : walk.last + 1, index], layout.states(solved.x, index)
    first = rows.pairs[:, 2] == walk.number
    mine = (first | (rows.pairs[:, 3] == walk.number)) & (rows.pairs[:, 1] == RSSI) & (variance < np.inf)
    chosen = np.flatnonzero(mine & (rows.pairs[:, 0] > times[-1] - LOOK_S))
    a_m, b_m = rows.places(solved.x)
    chosen = chosen[np.abs(a_m[chosen, 2] - b_m[chosen, 2]) < STAIR_M]
    is_first, ends_m = first[chosen], (a_m[chosen], b_m[chosen])
    here_m, there_m = np.where(is_first[:, None], ends_m, ends_m[::-1])
    other = np.where(is_first, rows.pairs[chosen, 3], rows.pairs[chosen, 2]).astype(np.intp)
    exponent, border = np.zeros(len(state.sources)), layout.length * layout.width
    law = np.array([[0.0, physics.RSSI_POWER_SIGMA_DB], [0.0, physics.RSSI_EXPONENT_SIGMA]])
    for (kind, source), start in layout.technologies.items():
        if kind == "rssi":
            power, exponent[source] = solved.x[border + start : border + start + 2].tolist()
            law[:, 0] = power - physics.RSSI_POWER_DBM, exponent[source] - physics.RSSI_EXPONENT
    drops, lies_t = state.ledger.table("drops"), np.full(len(state.owners), -np.inf)
    own = drops[drops[:, 2] == walk.number]
    lies_t[own[:, 1].astype(np.intp)] = own[:, 0]
    heard = np.empty((len(chosen), HEARD))
    heard[:, 0], heard[:, 1:3], heard[:, 3] = rows.t[chosen], here_m[:, :2], here_m[:, 2] - there_m[:, 2]
    heard[:, 4:6], heard[:, 6] = there_m[:, :2], solved.linear.residual[chosen]
    heard[:, 7], heard[:, 8] = exponent[rows.pairs[chosen, 6].astype(np.intp)], variance[chosen]
    heard[:, 9], heard[:, 10] = np.unique(other, return_inverse=True)[1], lies_t[other]

    def summed(t: Array) -> Array:
        return way.between(np.full(len(t), way.begin_t), t)[:, [0, 1, 3, 4]].copy()

    motion = solved.motions[index]
    misfit = 0.5 * np.einsum("ki,kij,kj->k", motion.residual, motion.information, motion.residual)
    bent = np.cumsum(misfit[::-1])[::-1][at] * max(*walk.node.walk_factors, 1.0)
    told_of = states[walk.first + at][:, [0, 1, *range(HEADING, SCALE + 1)]]
    moments = np.ascontiguousarray(np.column_stack([times[at], told_of]))
    return heard, ToldWay(way.begin_t, summed(heard[:, 0]), moments, summed(times[at]), bent), law


def _taken(
    problem: Problem, solved: Solution, turn: Turn, build: Build, resting: float
) -> tuple[Problem, Solution] | None:
    """The window with a unit's frame turned; None: that is not clearly likelier than as it is."""
    layout, walk = problem.layout, problem.layout.walks[turn.of]
    plain = unlearned(layout.state)
    other = plain.copy()
    t = float(layout.times[turn.keyframe, turn.of])
    _let_turn(other, walk.number, t, turn.across2)
    as_it_is, turned = build(plain), build(other)
    try:
        known = as_it_is.solve(solved.x, iterations=ITERATIONS, resting=resting)
        found = turned.solve(_start(as_it_is, known.x, turn), SLACKS_M, resting=resting)
    except ValueError:
        return None
    gain = known.cost - found.cost - max(_most(as_it_is, known, turned, found, walk) - KICKED, 0.0)
    before, after = layout.states(found.x, turn.of)[turn.keyframe : turn.keyframe + 2, HEADING].tolist()
    if gain < TAKEN or abs(after - before) < LEAST_RAD:
        return None
    state = layout.state
    _let_turn(state, walk.number, t, turn.across2)
    # What was learned a wrong way has made.
    node, state.noise = state.life(walk.number), {}
    state.keep(replace(node, walk_factors=(1.0, 1.0), rival=None, detours=(), power_cost=math.inf))
    state.due = True
    text = f"the unit of {node.node} faces elsewhere than it did, by {round(math.degrees(after - before))}°"
    state.say(
        "unit_changed", state.newest_t, node.node, f"{text}: it began anew, or {node.node} walks backwards"
    )
    anew = build(state)
    return anew, anew.solve(found.x, resting=resting)


def _most(one: Problem, as_one: Solution, other: Problem, as_other: Solution, walk: Walk) -> float:
    """What the radio tells that tells most for one solution over another, of those a walk's radio hears."""
    m, pairs = len(one.rows.pairs), one.rows.pairs
    costs = [
        mixture_cost(found.linear.residual[:m], rows.sigma[:m], *rows.noise[:m].T)
        for rows, found in ((one.rows, as_one), (other.rows, as_other))
    ]
    told = np.zeros(len(one.layout.state.owners))
    for own, there in ((2, 3), (3, 2)):
        mine = pairs[:, own] == walk.number
        np.add.at(told, pairs[mine, there].astype(np.intp), (costs[0] - costs[1])[mine])
    return float(told.max())


def _start(problem: Problem, x: Array, turn: Turn) -> Array:
    """An estimate with a way turned after a keyframe, flat, and all that was dropped along it."""
    layout, walk, there = problem.layout, problem.layout.walks[turn.of], x.copy()
    states = layout.states(there, turn.of)
    image = turned_about(states[turn.keyframe, :2].copy(), turn.by_rad)
    later = states[turn.keyframe + 1 : walk.last + 1]
    later[:, :2] = image.of(later[:, :2])
    later[:, HEADING] += turn.by_rad
    drops_along(layout, there, walk, image, turn.keyframe)
    return there


def _let_turn(state: FusionState, number: int, t: float, across2: float) -> None:
    """Let a unit's frame turn by anything right after an epoch (s): a step without displacement or time."""
    at_t, rest = t + EPSILON_S, (0.0, 0.0, 0.0, across2, 0.0, ANYWHERE_RAD**2, 0.0, 0.0, CLAIMED)
    state.ledger.add("steps", at_t, number, at_t, *rest)
