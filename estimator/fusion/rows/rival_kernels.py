"""What a tick's ranges and powers make of the rivals of units, compiled as one call: see `learned.rival`."""

import math
from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.learned import rival
from estimator.fusion.learned.rival import (
    EPOCH,
    EXPONENT,
    LINK,
    MEMORY_S,
    UNIT,
    follow,
    led_by_unit,
    odds_of,
)
from estimator.fusion.rows.predicted_pairs import predict_pairs
from estimator.fusion.rows.prediction import Prediction
from estimator.fusion.rows.rows import table_from
from estimator.graph.dense import Array
from estimator.graph.symmetric import upper_of

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
START, ASKED_T, BY_POWERS, RIVAL = 0, 1, 2, slice(3, 3 + WIDTH)
"""Columns of a unit: where its position begins; the epoch that this refers to (s), NaN: the unit is not asked
about; whether powers are told as well; its rival until now."""
ASKED = 3 + WIDTH


class Units(NamedTuple):
    """Units of which a tick's ranges and powers are asked.

    Attributes:
        rows: of each `START` and what stands with it, units × `ASKED`.
        links: what the links of their rivals have told until now, k × `TELLS`.
    """

    rows: Array
    links: Array


class RivalUpdate(NamedTuple):
    """Units' rivals after a tick's ranges and powers.

    Attributes:
        heard: there are readings that may tell of any unit, asked about or not.
        rivals: of each unit, units × `WIDTH`; no epoch: none tells of it.
        links: what the links of those that have an epoch tell, k × `TELLS`, in order of units and links.
    """

    heard: bool
    rivals: Array
    links: Array


def units_from(rows: Sequence[Sequence[float]], links: Sequence[bytes]) -> Units:
    """Units and what the links of their rivals have told, as tables.

    Args:
        rows: of each unit, see `Units`.
        links: of each unit, see `Rival.links`; empty: it has no rival.
    """
    told, first = np.frombuffer(b"".join(links), dtype=np.float64).reshape(-1, TELLS - 1), 0
    table = np.empty((len(told), TELLS))
    table[:, NUMBER] = told
    for unit, some in enumerate(links):
        last = first + len(some) // (told.itemsize * (TELLS - 1))
        table[first:last, OF], first = unit, last
    return Units(table_from(rows, ASKED), table)


def links_of(found: RivalUpdate) -> list[bytes]:
    """What the links of each unit tell after a tick, see `Rival.links`."""
    units = found.links[:, OF].tolist()
    firsts = [bisect_left(units, unit) for unit in range(len(found.rivals) + 1)]
    return [found.links[first:last, NUMBER].tobytes() for first, last in pairwise(firsts)]


@njit(cache=True)
def update_rivals(
    table: Array,
    epochs: Array,
    units: Units,
    seen: Prediction,
    x: Array,
) -> RivalUpdate:
    """Let the rivals of units follow a tick's ranges and powers, before these are taken in.

    Args:
        table: of m readings, see `rows.Row`.
        epochs: theirs, m (s).
        units: of which they are asked.
        seen: what is known of the readings before they are taken in.
        x: the estimate, n.
    """
    rows, links = units.rows, units.links
    starts, powers = rows[:, START].astype(np.intp), rows[:, BY_POWERS] != 0.0
    told, own = predict_pairs(table, epochs, starts, powers, seen, x)
    found, tell = np.full((len(rows), WIDTH), np.nan), np.empty((len(links) + len(told), TELLS))
    count = 0
    for i in range(len(rows)):
        mine, pose_t, known_of = np.flatnonzero(told[:, UNIT] == i), rows[i, ASKED_T], rows[i, RIVAL]
        if np.isnan(pose_t) or len(mine) == 0:
            continue
        readings, gains = told[mine], np.empty(len(mine))
        place_m, unsure = x[starts[i] : starts[i] + 2].copy(), own[i]
        if np.isnan(known_of[T]):
            t, state, upper = min(readings[0, EPOCH], pose_t), np.zeros(4), np.eye(4)
            state[:2], upper[:2, :2] = place_m, unsure
            known = upper_of(upper)
        else:
            t, state, known = known_of[T], known_of[STATE].copy(), known_of[COVARIANCE].copy()
        begun_t = t
        state, covariance, t = follow(state, known, t, readings, gains)
        until = max(t, pose_t)
        newer = told_by_links(links[np.flatnonzero(links[:, OF] == i)][:, NUMBER], readings, gains)
        odds = odds_of(newer, until)
        believed = min(max((STIRRED - odds) / (STIRRED - CALM), 0.0), 1.0)
        share = believed * -math.expm1((begun_t - until) / AGAIN_S)
        state, known = led_by_unit(state, covariance, until - t, place_m, unsure, share)
        found[i, T], found[i, STATE], found[i, COVARIANCE], found[i, ODDS] = until, state, known, odds
        ranged_t = -np.inf if np.isnan(known_of[T]) else known_of[RANGED]
        # A power has an exponent, a range has none.
        found[i, RANGED] = ranged_t if (readings[:, EXPONENT] > 0.0).all() else max(t, ranged_t)
        for row in newer:
            tell[count, OF], tell[count, NUMBER] = i, row
            count += 1
    return RivalUpdate(len(told) > 0, found, tell[:count])


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
