"""What ranges are too long by where something stands between two radios, told by how much they scatter.

A range through walls takes now one path and now another. What it is too long by is about exponential: as much
in the mean as it scatters (Wylie and Holtzman, The non-line of sight problem in mobile location estimation,
ICUPC 1996; Chen, A non-line-of-sight error mitigation algorithm in location estimation, WCNC 1999). Lengths
alone do not tell it, for the map bends until they fit. What no map explains is that readings which follow
each other on a link differ (von Neumann, Distribution of the ratio of the mean square successive difference
to the variance, 1941). A breadcrumb that was moved makes them differ as well: which were is asked before. An
obstruction that does not scatter is not seen here. On a stair a floor may be between that is near: the more
two radios differ in height, the likelier.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.levels import STOREY_M

SHARED = 0.3
"""Readings that share less of their error look through other walls: how they differ tells nothing."""
EACH = 2.0 / 3.0
"""How much a difference tells of a variance, in readings: each reading is in two of them."""
GLITCH, GLITCH_M, GLITCHES = 0.02, 3.0, 2
"""How often a reading is odd by itself, and by how much; and how many make one difference."""
FLOOR = 2
"""Which of the excesses, none counted as one, is a floor's: half a metre."""
NEVER = 1e-9
"""No excess is rarer than this."""
ODD = 6.0
"""In sigmas: one that differs by more does not tell how noisy a radio is."""
FEW, COUNTED = 50, 20.0
"""So many readings tell of nothing; and as so many counts what was thought of a clear link's noise before."""
ROUNDS, SETTLED = 20, 0.01
BEGIN, HALF = (1.0, 0.1), 0.6745
"""It begins at so much of what the nearer half of all readings tells, which lies within so many sigmas. Among
walls a noise that begins large explains them all; where it begins small, a noisy radio is a wall."""


class Excess(NamedTuple):
    """What each of m ranges is too long by.

    Attributes:
        mean_m: m (m).
        scatter_m2: variance that each has for itself, m (m²).
        doubt_m2: variance that readings of one link share, m (m²).
    """

    mean_m: Array
    scatter_m2: Array
    doubt_m2: Array


def excess_of(
    among: NDArray[np.bool_], source: Integers, link: Integers, alike: Array, residual: Array, steep_m: Array
) -> Excess:
    """What some of m readings are too long by, those of each technology by themselves; the others by nothing.

    Args:
        among: which are asked, m.
        source: number of each one's technology, m.
        link: see `excess`.
        alike: see `excess`.
        residual: see `excess`.
        steep_m: see `excess`.
    """
    found = Excess(*np.zeros((3, len(among))))
    for technology in np.unique(source[among]):
        at = np.flatnonzero(among & (source == technology))
        for number, told in zip(found, excess(link[at], alike[at], residual[at], steep_m[at]), strict=True):
            number[at] = told
    return found


def excess(link: Integers, alike: Array, residual: Array, steep_m: Array) -> Excess:
    """What ranges of one technology are too long by.

    Args:
        link: number of each one's link, m; readings of a link in order of epoch.
        alike: which number in its row of alike readings each is, m: see `fusion.learned.link_correlation`.
        residual: measured less predicted, m (m): only how it scatters on a link counts.
        steep_m: by how much the ends of each differ in height, m (m).
    """
    rungs, counts = np.array((0.0, *physics.EXCESS_M)), np.array(physics.EXCESS_COUNTS)
    odds = _odds(link, alike, residual, np.minimum(steep_m / STOREY_M, 1.0), rungs, counts)
    mean = odds @ rungs
    squared = odds @ rungs**2
    return Excess(mean, squared, squared - mean**2 + (physics.EXCESS_UNSURE * mean) ** 2)


@njit(cache=True, error_model="numpy")
def _odds(link: Integers, alike: Array, residual: Array, floor: Array, rungs: Array, counts: Array) -> Array:
    """Probability of each excess for each reading, m × rungs: the likelier of what two beginnings lead to."""
    before, kept, off = _differences(link, alike, residual)
    felt = np.flatnonzero(~np.isnan(off))
    odds, best = np.zeros((len(link), len(rungs))), -math.inf
    odds[:, 0] = 1.0
    if len(felt) < FEW:
        return odds
    usual = max(np.median(np.abs(off[felt])) / HALF, physics.SIGMA_FLOOR_M)
    for begin in BEGIN:
        found, likely = _expectation_maximisation(
            before, kept, off, felt, floor, begin * usual, rungs, counts
        )
        if likely > best:
            odds, best = found, likely
    return odds


@njit(cache=True, error_model="numpy")
def _expectation_maximisation(
    before: Integers,
    kept: Array,
    off: Array,
    felt: Integers,
    floor: Array,
    sigma: float,
    rungs: Array,
    counts: Array,
) -> tuple[Array, float]:
    """Odds of each excess by expectation maximisation, and the log likelihood of the differences then.

    Learned on the way: the noise of a clear link, and how common each excess is where no floor is between.
    """
    m, n = len(before), len(rungs)
    odds, share = np.zeros((m, n)), counts / counts.sum()
    told, onward, back, level = np.zeros((m, n)), np.zeros((m, n)), np.zeros((m, n)), np.empty(n)
    without = np.log(np.maximum(1.0 - floor, NEVER))
    for _ in range(ROUNDS):
        shapes = _shapes(sigma, rungs)
        for r in range(n):
            # What scatters less than the radio itself is not seen.
            level[r] = math.log(share[r]) if r == 0 or rungs[r] >= sigma else -math.inf
        for k in felt:
            for r in range(n):
                if level[r] > -math.inf:
                    told[k, r] = EACH * _log_density(off[k], shapes[r])
        _sum_along_links(before, kept, told, onward, back)
        for i in range(m):
            most = -math.inf
            for r in range(n):
                usual = without[i] + level[r]
                if r == FLOOR and level[r] > -math.inf:
                    usual = math.log(_usual(share, floor[i], r))
                odds[i, r] = onward[i, r] + back[i, r] + usual
                most = max(most, odds[i, r])
            total = 0.0
            for r in range(n):
                odds[i, r] = 1.0 if odds[i, r] == most else math.exp(odds[i, r] - most)
                total += odds[i, r]
            for r in range(n):
                odds[i, r] /= total
        common, squares, clear = counts.copy(), COUNTED * sigma**2, COUNTED
        for k in felt:
            for r in range(n):
                beside = 1.0 if r != FLOOR else (1.0 - floor[k]) * share[r] / _usual(share, floor[k], r)
                common[r] += odds[k, r] * beside
            if abs(off[k]) < ODD * sigma:
                squares += odds[k, 0] * off[k] ** 2
                clear += odds[k, 0]
        known, share = share, common / common.sum()
        was, sigma = sigma, max(math.sqrt(squares / clear), physics.SIGMA_FLOOR_M)
        if abs(sigma - was) < SETTLED * was and np.abs(share - known).max() < SETTLED:
            break
    likely, shapes = float((counts * np.log(share)).sum()), _shapes(sigma, rungs)
    for k in felt:
        density = 0.0
        for r in range(n):
            density += _usual(share, floor[k], r) * math.exp(_log_density(off[k], shapes[r]))
        likely += EACH * math.log(max(density, 1e-300))
    return odds, likely


@njit(cache=True)
def _usual(share: Array, floor: float, rung: int) -> float:
    """How common an excess is where there is a floor between with probability `floor`, and never nil."""
    return float(max((1.0 - floor) * share[rung] + (floor if rung == FLOOR else 0.0), NEVER))


@njit(cache=True, error_model="numpy")
def _sum_along_links(before: Integers, kept: Array, told: Array, onward: Array, back: Array) -> None:
    """Sum log odds along each link, forward and backward; they fade as the link's error does."""
    m, n = told.shape
    # Number by number: a sum of rows would be an array of its own each, and half of all the work.
    for i in range(m):
        last = before[i]
        for r in range(n):
            onward[i, r], back[i, r] = told[i, r], 0.0
            if last >= 0:
                onward[i, r] += kept[i] * onward[last, r]
    for i in range(m - 1, -1, -1):
        last = before[i]
        if last >= 0:
            for r in range(n):
                back[last, r] = kept[i] * (told[i, r] + back[i, r])


@njit(cache=True)
def _differences(link: Integers, alike: Array, residual: Array) -> tuple[Integers, Array, Array]:
    """What precedes each reading on its link, and how it differs from that.

    Returns:
        The reading before it (−1: none), m; what it shares of that one's error, 0 to 1, m; how it differs, as
        noisy as one reading, NaN where it shares too little, m (m).
    """
    m = len(link)
    newest = np.full(link.max() + 1 if m else 0, -1)
    before, kept, off = np.full(m, -1), np.zeros(m), np.full(m, np.nan)
    for i in range(m):
        last = newest[link[i]]
        newest[link[i]], before[i] = i, last
        if last >= 0:
            kept[i] = min(max((alike[i] - 1.0) / alike[last], 0.0), 1.0)
            if kept[i] > SHARED:
                off[i] = (residual[i] - residual[last]) / math.sqrt(2.0)
    return before, kept, off


@njit(cache=True)
def _shapes(sigma: float, rungs: Array) -> Array:
    """What differences between readings with each excess are like, rungs × 4.

    Height of the usual ones and of the odd ones; half the precision of these, and what that of the usual ones
    is more. An excess scatters by as much; now and then a reading is odd by itself.
    """
    found = np.empty((len(rungs), 4))
    for r in range(len(rungs)):
        usual = sigma * sigma + rungs[r] * rungs[r]
        odd = usual + GLITCH_M * GLITCH_M
        found[r, 0] = (1.0 - GLITCHES * GLITCH) / math.sqrt(usual)
        found[r, 1], found[r, 2] = GLITCHES * GLITCH / math.sqrt(odd), 0.5 / odd
        found[r, 3] = 0.5 / usual - found[r, 2]
    return found


@njit(cache=True, forceinline=True)
def _log_density(off: float, shape: Array) -> float:
    """Log density of a difference, up to a constant: no difference is so large that it is without bounds."""
    squared = off * off
    return float(math.log(shape[1] + shape[0] * math.exp(-shape[3] * squared)) - shape[2] * squared)
