"""Walking on the level tells how a unit's heights rise or fall by themselves (decision 0128).

A boot's accelerometer that is off by a little lifts each stride by some millimetres, mostly the same way:
"still large errors for the height" (paper C, results), two storeys in some hundred metres. Floors are level
(its height correction). So what a unit seems to climb for each metre of a leg without a stair is the sum of
two slopes: that of its own, which hardly changes, and that of the ground, which is mostly nil, but may be a
hill's or a ramp's for many legs. Both are followed together, as a hidden Markov model on a grid (forwards and
backwards: Baum et al. 1970), with the moments of what the ground has climbed.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.learned.level_legs import Legs, legs_of
from estimator.graph.dense import Array

RISES = 0.015
"""Units rise by so much for each metre of way (m/m), root of mean squares: assumed."""
RISES_STEP, RISES_COUNT = 0.005, 33
"""The grid of what a unit rises by (m/m)."""
CHANGED_P, REPLACED_P = 0.03, 0.001
"""So often, leg by leg, that becomes a step more, or less; and anything."""
SLOPES = np.array([0.0, 0.015, 0.03, 0.045, 0.06, 0.08, 0.1, 0.13, 0.17])
"""The grid of the ground's slopes (m/m), up and down."""
GENTLE, INCLINED = 0.03, 0.1
"""What is not level slopes by so much (m/m), outside, and on ramps: half of it each."""
INCLINED_P, SETS_OUT_P, LEVELS_P = 0.2, 0.02, 0.1
"""So often a way begins on a slope, comes to one leg by leg, and leaves it."""
STAYS_P, RETURNS_P = 0.15, 0.5
"""Who turns round on a slope goes back along it so often, and on as rarely: it turns as well."""
UNLIKELY = 1e-12
"""What no slope explains is as unlikely of all."""
RISES_GRID = RISES_STEP * (np.arange(RISES_COUNT) - RISES_COUNT // 2)
SLOPES_GRID = np.concatenate([-SLOPES[:0:-1], SLOPES])
"""From the steepest fall to the steepest rise; the middle one is level."""


def _slope_shares() -> Array:
    """How the slopes of what is not level are distributed over the grid; none of them is nil."""
    edges = 0.5 * (SLOPES_GRID[1:] + SLOPES_GRID[:-1])
    widths = np.diff(np.concatenate([[2.0 * edges[0] - edges[1]], edges, [2.0 * edges[-1] - edges[-2]]]))
    shares = np.zeros(len(SLOPES_GRID))
    for sigma in (GENTLE, INCLINED):
        shares += np.exp(-0.5 * (SLOPES_GRID / sigma) ** 2) / sigma * widths
    shares[len(shares) // 2] = 0.0
    return np.asarray(shares / shares.sum())


SHARES = _slope_shares()
ANYTHING = np.exp(-0.5 * (RISES_GRID / RISES) ** 2)
"""How likely each rise is of a unit of which nothing is known."""
ANYTHING /= ANYTHING.sum()
OF_SLOPES = np.rint((SLOPES_GRID - SLOPES_GRID[0]) / RISES_STEP).astype(np.intp)
"""Which of `SUMS` each slope is with the least rise; with each other one it is one more."""
SUMS = SLOPES_GRID[0] + RISES_GRID[0] + RISES_STEP * np.arange(RISES_COUNT + OF_SLOPES[-1])
"""What a leg may rise by: all sums of a rise and a slope, as slopes are whole steps of rises."""


class Rises(NamedTuple):
    """By what a unit rises, as its legs have told.

    Attributes:
        of_rows: for each displacement what is not the ground's in it, for each metre (m/m), by all of them.
        mean: by now, without what the newest legs rose beside it (m/m).
        variance: of that.
        doubt_m: how unsure it is what the ground has climbed: a standard deviation (m).
    """

    of_rows: Array
    mean: float
    variance: float
    doubt_m: float


@njit(cache=True)
def rises_of(moved: Array, mean: float, variance: float) -> Rises:
    """What legs tell of a unit's rise and of the ground.

    Args:
        moved: a unit's displacements, m × 5, in order of epoch: east, north, up (m), variance of the last one
            (m²), and 1 where the unit has told it.
        mean: what it rises by, as is known beforehand (m/m).
        variance: of that.
    """
    legs, found = legs_of(moved), np.full(len(moved), mean)
    n, k = len(legs.rise), len(SLOPES_GRID)
    if n == 0:
        return Rises(found, mean, variance, 0.0)
    # Of each rise and slope: how likely, and first and second moments of what the ground has climbed.
    carried, likely = np.zeros((3, RISES_COUNT, k)), _likely(legs)
    known = _normal(mean, variance)
    for r in range(RISES_COUNT):
        for c in range(k):
            carried[0, r, c] = known[r] * INCLINED_P * SHARES[c]
        carried[0, r, k // 2] = known[r] * (1.0 - INCLINED_P)
    filtered, room = np.empty((n, RISES_COUNT, k)), np.empty((RISES_COUNT, k))
    for i in range(n):
        if i > 0:
            _go_onward(carried, legs.turns[i], room)
        total = 0.0
        for r in range(RISES_COUNT):
            for c in range(k):
                each, climb_m = likely[i, r + OF_SLOPES[c]], SLOPES_GRID[c] * legs.way_m[i]
                one, first = carried[0, r, c], carried[1, r, c]
                carried[2, r, c] = each * (carried[2, r, c] + 2.0 * climb_m * first + climb_m**2 * one)
                carried[1, r, c] = each * (first + climb_m * one)
                carried[0, r, c] = each * one
                total += each * one
        carried /= total
        filtered[i] = carried[0]
    newest, square, climbed_m, climbed_m2 = 0.0, 0.0, 0.0, 0.0
    for r in range(RISES_COUNT):
        for c in range(k):
            newest += carried[0, r, c] * RISES_GRID[r]
            square += carried[0, r, c] * RISES_GRID[r] ** 2
            climbed_m += carried[1, r, c]
            climbed_m2 += carried[2, r, c]
    rise, ground = _looking_back(filtered, legs, likely)
    for i in range(len(moved)):
        leg = legs.of_row[i]
        found[i] = legs.rise[leg] - ground[leg] if leg >= 0 else rise[max(-2 - leg, 0)]
    doubt_m = math.sqrt(max(climbed_m2 - climbed_m**2, 0.0))
    return Rises(found, newest, square - newest**2 + RISES_STEP**2 / 12.0, doubt_m)


@njit(cache=True)
def _likely(legs: Legs) -> Array:
    """How likely each leg is of each sum of a rise and a slope, but for a factor, n × sums."""
    found = np.empty((len(legs.rise), len(SUMS)))
    for i in range(len(found)):
        for s in range(len(SUMS)):
            found[i, s] = math.exp(-0.5 * (legs.rise[i] - SUMS[s]) ** 2 / legs.variance[i]) + UNLIKELY
    return found


@njit(cache=True)
def _normal(mean: float, variance: float) -> Array:
    """How likely each rise of the grid is."""
    found, total = np.empty(RISES_COUNT), 0.0
    for r in range(RISES_COUNT):
        found[r] = math.exp(-0.5 * (RISES_GRID[r] - mean) ** 2 / variance)
        total += found[r]
    for r in range(RISES_COUNT):
        found[r] /= total
    return found


@njit(cache=True)
def _looking_back(filtered: Array, legs: Legs, likely: Array) -> tuple[Array, Array]:
    """Mean rise and mean slope of the ground of each leg, by all of them, n each (m/m)."""
    n, k = len(filtered), filtered.shape[2]
    rise, ground = np.zeros(n), np.zeros(n)
    after = np.ones((RISES_COUNT, k))
    for i in range(n - 1, -1, -1):
        total, most = 0.0, 0.0
        for r in range(RISES_COUNT):
            for c in range(k):
                both = filtered[i, r, c] * after[r, c]
                rise[i] += both * RISES_GRID[r]
                ground[i] += both * SLOPES_GRID[c]
                total += both
                after[r, c] *= likely[i, r + OF_SLOPES[c]]
                most = max(most, after[r, c])
        rise[i], ground[i] = rise[i] / total, ground[i] / total
        for r in range(RISES_COUNT):
            for c in range(k):
                after[r, c] /= most
        after = _back(after, legs.turns[i])
    return rise, ground


@njit(cache=True)
def _go_onward(carried: Array, turns: bool, room: Array) -> None:
    """Carry on from a leg to the next one, in place, 3 × rises × slopes; `room`: rises × slopes."""
    k, last, of_slopes = carried.shape[2], RISES_COUNT - 1, np.empty(carried.shape[2])
    stays, returns, levels = _passages(turns)
    keeps = 1.0 - 2.0 * CHANGED_P - REPLACED_P
    for number in range(3):
        of_slopes[:] = 0.0
        for r in range(RISES_COUNT):
            here, total = carried[number, r], 0.0
            for c in range(k):
                total += here[c]
            for c in range(k):
                room[r, c] = SETS_OUT_P * SHARES[c] * total + stays * here[c] + returns * here[k - 1 - c]
            level = here[k // 2]
            room[r, k // 2] = (1.0 - SETS_OUT_P) * level + levels * (total - level)
            for c in range(k):
                of_slopes[c] += room[r, c]
        for r in range(RISES_COUNT):
            up, down, replaced = min(r + 1, last), max(r - 1, 0), REPLACED_P * ANYTHING[r]
            for c in range(k):
                beside = CHANGED_P * (room[up, c] + room[down, c])
                carried[number, r, c] = keeps * room[r, c] + beside + replaced * of_slopes[c]


@njit(cache=True)
def _back(after: Array, turns: bool) -> Array:
    """How likely what comes after is, of each rise and slope of the leg before: `_go_onward`, transposed."""
    k, found = after.shape[1], np.empty_like(after)
    stays, returns, levels = _passages(turns)
    moved, replaced = np.empty(k), np.zeros(k)
    for r in range(RISES_COUNT):
        for c in range(k):
            replaced[c] += ANYTHING[r] * after[r, c]
    for r in range(RISES_COUNT):
        up, down, sets_out = min(r + 1, RISES_COUNT - 1), max(r - 1, 0), 0.0
        for c in range(k):
            moved[c] = (1.0 - 2.0 * CHANGED_P - REPLACED_P) * after[r, c] + REPLACED_P * replaced[c]
            moved[c] += CHANGED_P * (after[up, c] + after[down, c])
            sets_out += SETS_OUT_P * SHARES[c] * moved[c]
        for c in range(k):
            found[r, c] = sets_out + levels * moved[k // 2] + stays * moved[c] + returns * moved[k - 1 - c]
        found[r, k // 2] = sets_out + (1.0 - SETS_OUT_P) * moved[k // 2]
    return found


@njit(cache=True)
def _passages(turns: bool) -> tuple[float, float, float]:
    """How often who is on a slope stays on it, goes back along it, and leaves it for the level."""
    stays, returns = (STAYS_P, RETURNS_P) if turns else (1.0 - LEVELS_P - SETS_OUT_P, 0.0)
    return stays, returns, 1.0 - stays - returns - SETS_OUT_P
