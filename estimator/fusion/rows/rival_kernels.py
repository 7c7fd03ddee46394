"""What a tick's ranges and powers make of the rivals of units, compiled as one call: see `learned.rival`."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.learned import rival
from estimator.fusion.learned.rival import (
    COVARIANCE,
    EPOCH,
    EXPONENT,
    LINK,
    MEMORY_S,
    STATE,
    TOLD,
    UNIT,
    WAY,
    Rival,
    T,
    follow,
    led_by_unit,
    odds_of,
)
from estimator.fusion.rows.predicted_pairs import predict_pairs
from estimator.fusion.rows.prediction import Prediction
from estimator.graph.dense import Array
from estimator.graph.symmetric import upper_of

AGAIN_S = 5.0
"""As long as its unit is believed a rival follows it within so many seconds: it was right until now."""
CALM, STIRRED = -5.0, -1.0
"""Log odds between which a rival goes its own way more and more."""
ODDS, RANGED, LINKS = range(WAY, WAY + 3)
"""Columns of a rival behind those of its way: see `rival.Rival`; how many links tell of it."""
WIDTH = WAY + 3
NONE = np.full(WAY, math.nan).tobytes()
TELLS = 3
"""Columns of what a link tells, as `rival.odds_of` has it."""
START, ASKED_T, BY_POWERS, RANGED_T, KNOWN = range(5)
"""Columns of a unit: where its position begins; the epoch that this refers to (s), NaN: the unit is not asked
about; whether powers are told as well; of its rival until now, when it was ranged last (s), and how many
links told of it."""
ASKED = 5
LINK_BYTES, WAY_BYTES = 8 * TELLS, 8 * WAY


class Units(NamedTuple):
    """Units of which a tick's ranges and powers are asked.

    Attributes:
        rows: of each `START` and what stands with it, units × `ASKED`.
        ways: those of their rivals until now, units × `WAY`.
        links: what the links of these have told until now, k × `TELLS`, in order of units and links.
    """

    rows: Array
    ways: Array
    links: Array


class RivalUpdate(NamedTuple):
    """Units' rivals after a tick's ranges and powers.

    Attributes:
        heard: there are readings that may tell of any unit, asked about or not.
        rivals: of each unit, units × `WIDTH`; NaN: none tells of it.
        links: what the links of those that have an epoch tell, k × `TELLS`, in order of units and links.
    """

    heard: bool
    rivals: Array
    links: Array


def units_from(rows: Sequence[tuple[float, float, bool]], rivals: Sequence[Rival | None]) -> Units:
    """Units and their rivals, as tables.

    Args:
        rows: of each unit, see `START` and what stands with it, up to `BY_POWERS`.
        rivals: of each unit until now; None: it has none.
    """
    told, ways, links = list[float](), list[bytes](), list[bytes]()
    for row, known in zip(rows, rivals, strict=True):
        if known is None:
            told += (*row, -math.inf, 0.0)
            ways.append(NONE)
        else:
            told += (*row, known.ranged_t, len(known.links) // LINK_BYTES)
            ways.append(known.way)
            links.append(known.links)
    # Of an array that must not be written numba looks up the type anew with each call.
    return Units(
        np.array(told, dtype=np.float64).reshape(-1, ASKED),
        np.ndarray((len(ways), WAY), np.float64, bytearray().join(ways)),
        np.ndarray((sum(map(len, links)) // LINK_BYTES, TELLS), np.float64, bytearray().join(links)),
    )


def rivals_of(found: RivalUpdate) -> Iterator[Rival | None]:
    """The units' rivals after a tick; None: no reading tells of the unit."""
    ways, links, first = found.rivals[:, :WAY].tobytes(), found.links.tobytes(), 0
    for unit, (odds, ranged_t, told) in enumerate(found.rivals[:, WAY:].tolist()):
        if math.isnan(told):
            yield None
            continue
        last = first + int(told) * LINK_BYTES
        yield Rival(ways[unit * WAY_BYTES : (unit + 1) * WAY_BYTES], links[first:last], odds, ranged_t)
        first = last


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
    count = last = 0
    mine = np.empty(told.shape)
    for i in range(len(rows)):
        first, last = last, last + int(rows[i, KNOWN])
        heard, powers_alone, pose_t, known_of = 0, True, rows[i, ASKED_T], units.ways[i]
        for r in range(len(told)):
            if told[r, UNIT] == i:
                for c in range(TOLD):
                    mine[heard, c] = told[r, c]
                # A power has an exponent, a range has none.
                powers_alone = powers_alone and told[r, EXPONENT] > 0.0
                heard += 1
        if np.isnan(pose_t) or heard == 0:
            continue
        readings, gains = mine[:heard], np.empty(heard)
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
        newer = told_by_links(links[first:last], readings, gains)
        odds = odds_of(newer, until)
        believed = min(max((STIRRED - odds) / (STIRRED - CALM), 0.0), 1.0)
        share = believed * -math.expm1((begun_t - until) / AGAIN_S)
        state, known = led_by_unit(state, covariance, until - t, place_m, unsure, share)
        found[i, T], found[i, STATE], found[i, COVARIANCE], found[i, ODDS] = until, state, known, odds
        ranged_t = rows[i, RANGED_T]
        found[i, RANGED] = ranged_t if powers_alone else max(t, ranged_t)
        found[i, LINKS] = len(newer)
        tell[count : count + len(newer)] = newer
        count += len(newer)
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
    lately, ordered = 0, np.empty((count, 3))
    for k in range(count):
        if found[k, 1] > newest_t - MEMORY_S:
            at = lately
            while at > 0 and ordered[at - 1, 0] > found[k, 0]:
                ordered[at] = ordered[at - 1]
                at -= 1
            ordered[at] = found[k]
            lately += 1
    return ordered[:lately]
