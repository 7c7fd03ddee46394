"""At which moment, and by which angle, a unit's frame is likely to have turned, by what its bearer hears."""

import math
from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.images import ALWAYS, Alternative, turned_about
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.graph.dense import Array, Indices
from estimator.smoothing.keyframes.displacement_sums import Way
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.keyframes.walks import HEADING, SCALE
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.frame_turns import EAST_OF, TURNS_RAD, ToldWay, turn_gains
from estimator.smoothing.units.heard_powers import (
    EAST,
    EXPONENT,
    HEARD,
    NORTH,
    OFF_DB,
    RADIO,
    SINCE_T,
    THERE_E,
    THERE_N,
    UP,
    VARIANCE,
    T,
)

LOOK_S, EVERY_S = 100.0, 8.0
"""How far back turns are looked for, and how far apart."""
RARE, PAUSED = -10.0, -6.5
"""Log odds of a turn at one moment by one angle: in all of them, one in two hundred; one in eighty where the
unit told nothing for a while just before, as one that is switched off and on again."""
TRIED = 3.0
"""Log odds from which on the window is solved with a turn."""
LEAST = 0.02
"""What is less likely is not told of."""
SPEED_MPS = 1.0
EARLY_M2 = 4.0 * (SPEED_MPS * EVERY_S) ** 2 / 12.0
EPSILON_S = 1e-3
WALLS_M2 = 1.0
"""What ranges are unsure by because of walls: solutions take no account of these before they rest (m²)."""
STAIR_M = 0.5 * physics.FLOOR_M
"""Who is higher or lower than a radio by more is on a stair, or beyond a floor: that is in the way."""


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


def suspected_turn(
    problem: Problem, solved: Solution, index: int, way: Way, variance: Array, paused_t: float | None
) -> tuple[Turn | None, tuple[Alternative, ...]]:
    """The turn with which to solve the window, if one is so likely; and where he may be by any.

    Args:
        problem: of the window.
        solved: its solution.
        index: of the walk.
        way: what its unit has told.
        variance: of the noise of each pair as it was assumed, m; infinite: it tells nothing.
        paused_t: when the unit began to tell again; None: it has not paused (s).
    """
    layout, walk = problem.layout, problem.layout.walks[index]
    times = layout.times[walk.first : walk.last + 1, index]
    at, paused = _moments(times, float(np.diff(layout.grid).max()), paused_t)
    exponent, law = _power_laws(layout, solved.x)
    heard = _heard(problem, solved, walk, times[-1] - LOOK_S, variance, exponent)
    told = _told_way(layout, solved, index, way, at, heard[:, T])
    odds = turn_gains(heard, told, EARLY_M2, law) + np.where(at == paused, PAUSED, RARE)[:, None]
    most = float(odds.max(initial=0.0))
    share = np.exp(odds - most)
    share /= share.sum() + math.exp(-most)
    detours = _detours(walk.number, told, share)
    if most < TRIED:
        return None, detours
    t, when = times[at], share.sum(axis=1)
    when = when / when.sum()
    middle_t = float(when @ t)
    k = int(np.abs(t - middle_t).argmin())
    by_rad = float(TURNS_RAD[share[k].argmax()])
    unsure_s2 = 0.0 if at[k] == paused else float(when @ (t - middle_t) ** 2) + EVERY_S**2 / 12.0
    across2 = 2.0 * SPEED_MPS**2 * unsure_s2 * math.sin(0.5 * by_rad) ** 2
    return Turn(index, walk.first + int(at[k]), by_rad, across2), detours


def _moments(times: Array, spacing_s: float, paused_t: float | None) -> tuple[Indices, int]:
    """Keyframes of a walk before which its unit may have turned, and the one where it paused; −1: nowhere."""
    every = max(round(EVERY_S / spacing_s), 1)
    at = np.arange(len(times) - 2, 0, -every)[::-1]
    paused = -1 if paused_t is None else int(np.searchsorted(times, paused_t + EPSILON_S)) - 1
    if 0 < paused < len(times) - 1:
        at = np.union1d(at, [paused])
    return at[times[at] > times[-1] - LOOK_S], paused


def _detours(number: int, told: ToldWay, share: Array) -> tuple[Alternative, ...]:
    """Where a node may be by a turn by each angle, by how likely each is at each moment."""
    by_angle, found = share.sum(axis=0), list[Alternative]()
    for angle in np.flatnonzero(by_angle > LEAST).tolist():
        about_m = told.moments[share[:, angle].argmax(), EAST_OF : EAST_OF + 2]
        there = turned_about(about_m, float(TURNS_RAD[angle]))
        found.append(Alternative(number, float(by_angle[angle]), there, ALWAYS, there))
    return tuple(found)


def _power_laws(layout: Layout, x: Array) -> tuple[Array, Array]:
    """N of each technology's powers; by how much P0 and n are more than usual, and their usual spread."""
    exponent, border = np.zeros(len(layout.state.sources)), layout.length * layout.width
    law = np.array([[0.0, physics.RSSI_POWER_SIGMA_DB], [0.0, physics.RSSI_EXPONENT_SIGMA]])
    for (kind, source), start in layout.technologies.items():
        if kind == "rssi":
            power, exponent[source] = x[border + start : border + start + 2].tolist()
            law[:, 0] = power - physics.RSSI_POWER_DBM, exponent[source] - physics.RSSI_EXPONENT
    return exponent, law


def _heard(
    problem: Problem, solved: Solution, walk: Walk, since_t: float, variance: Array, exponent: Array
) -> Array:
    """The powers and ranges of a walk since an epoch, as `turn_gains` takes them, m × `HEARD`."""
    state, rows, pairs = problem.layout.state, problem.rows, problem.rows.pairs
    first = pairs[:, 2] == walk.number
    mine = (first | (pairs[:, 3] == walk.number)) & (pairs[:, 1] <= RSSI) & (variance < np.inf)
    chosen = np.flatnonzero(mine & (pairs[:, 0] > since_t))
    a_m, b_m = rows.places(solved.x)
    ranged = pairs[chosen, 1] == RANGE
    chosen = chosen[ranged | (np.abs(a_m[chosen, 2] - b_m[chosen, 2]) < STAIR_M)]
    ranged = pairs[chosen, 1] == RANGE
    is_first, ends_m = first[chosen], (a_m[chosen], b_m[chosen])
    here_m, there_m = np.where(is_first[:, None], ends_m, ends_m[::-1])
    other = np.where(is_first, pairs[chosen, 3], pairs[chosen, 2]).astype(np.intp)
    drops, lies_t = state.ledger.table("drops"), np.full(len(state.owners), -np.inf)
    own = drops[drops[:, 2] == walk.number]
    lies_t[own[:, 1].astype(np.intp)] = own[:, 0]
    heard = np.empty((len(chosen), HEARD))
    heard[:, T] = rows.t[chosen]
    heard[:, [EAST, NORTH]], heard[:, UP] = here_m[:, :2], here_m[:, 2] - there_m[:, 2]
    heard[:, [THERE_E, THERE_N]] = there_m[:, :2]
    heard[:, OFF_DB], heard[:, VARIANCE] = solved.linear.residual[chosen], variance[chosen]
    heard[ranged, VARIANCE] += WALLS_M2
    heard[:, EXPONENT] = np.where(ranged, 0.0, exponent[pairs[chosen, 6].astype(np.intp)])
    heard[:, RADIO], heard[:, SINCE_T] = np.unique(other, return_inverse=True)[1], lies_t[other]
    return heard


def _told_way(layout: Layout, solved: Solution, index: int, way: Way, at: Indices, heard_t: Array) -> ToldWay:
    """What the unit of a walk has told up to each of its powers, and up to each of some keyframes."""
    walk, motion = layout.walks[index], solved.motions[index]
    t, states = layout.times[walk.first + at, index], layout.states(solved.x, index)[walk.first + at]

    def summed(until_t: Array) -> Array:
        return way.between(np.full(len(until_t), way.begin_t), until_t)[:, [0, 1, 3, 4]].copy()

    moments = np.ascontiguousarray(np.column_stack([t, states[:, [0, 1, *range(HEADING, SCALE + 1)]]]))
    misfit = 0.5 * np.einsum("ki,kij,kj->k", motion.residual, motion.information, motion.residual)
    bent = np.cumsum(misfit[::-1])[::-1][at] * max(*walk.node.walk_factors, 1.0)
    return ToldWay(way.begin_t, summed(heard_t), moments, summed(t), bent)
