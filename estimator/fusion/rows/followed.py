"""What a tick's ranges and powers make of the rivals of units, compiled as one call: see `learned.rival`."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion.learned import rival
from estimator.fusion.learned.rival import (
    EPOCH,
    EXPONENT,
    LINK,
    MEMORY_S,
    UNIT,
    drawn,
    follow,
    odds_of,
    upper_of,
)
from estimator.fusion.rows.foretold import foretell
from estimator.graph.dense import Array, Indices

AGAIN_S = 5.0
"""As long as its unit is believed a rival follows it within so many seconds: it was right until now."""
CALM, STIRRED = -5.0, -1.0
"""Log odds between which a rival goes its own way more and more."""
T, STATE, COVARIANCE, ODDS, RANGED = 0, slice(1, 5), slice(5, 15), 15, 16
"""Columns of a rival, see `rival.Rival`; without an epoch there is none."""
WIDTH = 17
NONE = (math.nan,) * WIDTH
OF, NUMBER = 0, slice(1, 4)
"""Columns of what a link tells: number of the unit, and a row as `rival.odds_of` has it."""
TELLS = 4


class Followed(NamedTuple):
    """Units' rivals after a tick's ranges and powers.

    Attributes:
        heard: there are readings that may tell of any unit, asked about or not.
        rivals: of each unit, units × `WIDTH`; no epoch: none tells of it.
        links: what the links of those that have an epoch tell, k × `TELLS`, in order of units and links.
    """

    heard: bool
    rivals: Array
    links: Array


@njit(cache=True)
def followed(
    table: Array,
    epochs: Array,
    units: Indices,
    pose_t: Array,
    powers: NDArray[np.bool_],
    rivals: Array,
    links: Array,
    matrix: Array,
    x: Array,
) -> Followed:
    """Let the rivals of units follow a tick's ranges and powers, before these are taken in.

    Args:
        table: of m readings, see `rows.Row`.
        epochs: theirs, m (s).
        units: where the position of each begins.
        pose_t: epoch that each position refers to (s); NaN: the unit is not asked about.
        powers: of which units powers are told as well.
        rivals: of each unit until now, units × `WIDTH`.
        links: what their links have told, k × `TELLS`.
        matrix: L, n × n or larger.
        x: the estimate, n.
    """
    n = len(x)
    told, own = foretell(table, epochs, units, powers, matrix[:n, :n], x)
    found, tell = np.full((len(units), WIDTH), np.nan), np.empty((len(links) + len(told), TELLS))
    count = 0
    for i in range(len(units)):
        mine = np.flatnonzero(told[:, UNIT] == i)
        if np.isnan(pose_t[i]) or len(mine) == 0:
            continue
        readings, gains = told[mine], np.empty(len(mine))
        place_m, unsure = x[units[i] : units[i] + 2].copy(), covariance_of(own[i])
        if np.isnan(rivals[i, T]):
            t, state, upper = min(readings[0, EPOCH], pose_t[i]), np.zeros(4), np.eye(4)
            state[:2], upper[:2, :2] = place_m, unsure
            known = upper_of(upper)
        else:
            t, state, known = rivals[i, T], rivals[i, STATE].copy(), rivals[i, COVARIANCE].copy()
        begun_t = t
        state, covariance, t = follow(state, known, t, readings, gains)
        until = max(t, pose_t[i])
        newer = told_by_links(links[np.flatnonzero(links[:, OF] == i)][:, NUMBER], readings, gains)
        odds = odds_of(newer, until)
        believed = min(max((STIRRED - odds) / (STIRRED - CALM), 0.0), 1.0)
        share = believed * -math.expm1((begun_t - until) / AGAIN_S)
        state, known = drawn(state, covariance, until - t, place_m, unsure, share)
        found[i, T], found[i, STATE], found[i, COVARIANCE], found[i, ODDS] = until, state, known, odds
        ranged_t = -np.inf if np.isnan(rivals[i, T]) else rivals[i, RANGED]
        # A power has an exponent, a range has none.
        found[i, RANGED] = ranged_t if (readings[:, EXPONENT] > 0.0).all() else max(t, ranged_t)
        for row in newer:
            tell[count, OF], tell[count, NUMBER] = i, row
            count += 1
    return Followed(len(told) > 0, found, tell[:count])


@njit(cache=True)
def covariance_of(own: Array) -> Array:
    """Of a place, from the variances of east, of north and of their sum, 2 × 2 (m²)."""
    across = 0.5 * (own[2] - own[0] - own[1])
    return np.array([[own[0], across], [across, own[1]]])


@njit(cache=True)
def told_by_links(known: Array, told: Array, gains: Array) -> Array:
    """What each link tells with more readings, of those that have told anything lately, in order of links.

    Args:
        known: what they have told, k × 3, see `rival.odds_of`.
        told: the readings, m × `rival.TOLD`, in order of epoch.
        gains: log likelihood of each by the rival less that by the unit, m.
    """
    count, newest_t = len(known), told[-1, EPOCH]
    found = np.empty((count + len(told), 3))
    found[:count] = known
    for r in range(len(told)):
        at, kept, tells = 0, 0.0, 1.0
        while at < count and found[at, 0] != told[r, LINK]:
            at += 1
        if at < count:
            waited_s = max(told[r, EPOCH] - found[at, 1], 0.0)
            kept = found[at, 2] * math.exp(-waited_s / MEMORY_S)
            tells = min(waited_s / rival.SPELL_S, 1.0)
        count = max(count, at + 1)
        gain = min(max(kept + tells * gains[r], rival.LEAST), rival.MOST)
        found[at, 0], found[at, 1], found[at, 2] = told[r, LINK], told[r, EPOCH], gain
    lately = np.flatnonzero(found[:count, 1] > newest_t - MEMORY_S)
    return found[lately[np.argsort(found[lately, 0], kind="mergesort")]]
