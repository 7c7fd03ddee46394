"""How much likelier readings are if a unit's frame has turned at some moment by some angle, compiled.

All moments and angles are looked at in one call. Where all others are, and how his way began, is held; P0 and
n are found anew for each: a wrong way makes their law flat, and then no power tells of another one.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices
from estimator.measurements.rssi import ANTENNA_M, DB_PER_NEPER
from estimator.smoothing.units.heard_powers import (
    EXPONENT,
    OFF_DB,
    RADIO,
    SINCE_T,
    THERE_E,
    THERE_N,
    UP,
    VARIANCE,
    T,
    cost_of,
    cost_since,
    fall_of,
    falls,
)
from estimator.smoothing.units.power_law import Foretold, PowerLaw, fit_law, law_before

T_OF, EAST_OF, NORTH_OF, PSI, BETA, STRETCH = range(6)
"""Of each moment: epoch (s); where the unit's bearer was: east, north (m); ψ, β and s − 1 there."""
APART_RAD = np.pi / 6.0
TURNS_RAD = np.arange(2, 11) * APART_RAD
"""A smaller angle each window finds by itself."""
BETWEEN_RAD2 = APART_RAD**2 / 12.0
KICKED = 4.0
"""What it costs that a radio lies elsewhere, which contradicts any way."""


class ToldWay(NamedTuple):
    """What a unit has told of its bearer's way.

    Attributes:
        begin_t: epoch from which displacements are summed up (s).
        sums: displacements up to each power, and their moments in time: east, north, m × 4.
        moments: see `T_OF`, k × 6, row by row in memory: for others `turn_gains` is not compiled beforehand.
        at_moments: the same sums up to these, k × 4.
        bent: what it costs the solution's way that the unit has told another one since then, k.
    """

    begin_t: float
    sums: Array
    moments: Array
    at_moments: Array
    bent: Array


@njit(cache=True, error_model="numpy")
def turn_gains(heard: Array, told: ToldWay, early_m2: float, law: Array) -> Array:
    """Log likelihood of a turn at each of k moments by each angle, over that of none, k × `TURNS_RAD`.

    Without a turn he has gone as the solution has it, or as his unit has told since then, whichever is
    likelier; or the radio that tells most of a turn lies elsewhere.

    Args:
        heard: the powers, m × `HEARD`.
        told: his way.
        early_m2: variance of a place by when exactly a turn right round was (m²).
        law: by how much P0 and n are more than usual, and their usual spread, 2 × 2 (dB, 1).
    """
    m, moments = len(heard), told.moments
    gains = np.zeros((len(moments), len(TURNS_RAD)))
    each = np.zeros(int(heard[:, RADIO].max()) + 1 if m else 1)
    by_power, by_exponent = 1.0 / law[0, 1] ** 2, 1.0 / law[1, 1] ** 2
    unusual = 0.5 * (law[0, 0] ** 2 * by_power + law[1, 0] ** 2 * by_exponent)
    usual = PowerLaw(by_power, 0.0, by_exponent, -law[0, 0] * by_power, -law[1, 0] * by_exponent, unusual)
    fall_db, went, none_db = falls(heard), np.empty((m, 2)), np.empty(m)
    other = Foretold(np.empty(m), np.empty(m), np.empty(m))
    for j in range(len(moments)):
        t = moments[j, T_OF]
        since = np.flatnonzero((heard[:, T] > t) & (heard[:, SINCE_T] <= t))
        powers = since[heard[since, EXPONENT] > 0.0]
        before = law_before(heard, fall_db, t, usual)
        walk_since(told, j, since, went)
        none_db[:], beside = heard[:, OFF_DB], unusual + told.bent[j]
        least = cost_since(since, none_db, heard[:, VARIANCE], beside)
        foretell(heard, fall_db, moments[j], since, went, 0.0, early_m2, other)
        by_law = fit_law(powers, before, other)
        if cost_since(since, other.off_db, other.variance, by_law) < least:
            none_db[:], beside = other.off_db, by_law
        for a in range(len(TURNS_RAD)):
            foretell(heard, fall_db, moments[j], since, went, TURNS_RAD[a], early_m2, other)
            by_law, each[:] = fit_law(powers, before, other), 0.0
            for i in since:
                # What lies between two angles all powers share: it is as unsure without a turn.
                none = cost_of(none_db[i], other.variance[i])
                each[int(heard[i, RADIO])] += none - cost_of(other.off_db[i], other.variance[i])
            gains[j, a] = beside - by_law + each.sum() - max(each.max() - KICKED, 0.0)
    return gains


@njit(cache=True, error_model="numpy")
def walk_since(told: ToldWay, j: int, since: Indices, went: Array) -> None:
    """Put his way from a moment to each of some powers into `went`, m × 2: along ψ and to its left (m)."""
    sums, start = told.sums, told.at_moments[j]
    beta, scale = told.moments[j, BETA], 1.0 + told.moments[j, STRETCH]
    passed_s = told.moments[j, T_OF] - told.begin_t
    for i in since:
        east, north = sums[i, 0] - start[0], sums[i, 1] - start[1]
        since_e = sums[i, 2] - start[2] - east * passed_s
        since_n = sums[i, 3] - start[3] - north * passed_s
        went[i, 0], went[i, 1] = scale * (east - beta * since_n), scale * (north + beta * since_e)


@njit(cache=True, error_model="numpy")
def foretell(
    heard: Array,
    fall_db: Array,
    moment: Array,
    since: Indices,
    went: Array,
    by_rad: float,
    early_m2: float,
    other: Foretold,
) -> None:
    """Foretell powers by his unit's way since a moment, its frame turned there by an angle.

    Args:
        heard: the powers, m × `HEARD`.
        fall_db: see `falls`.
        moment: of the turn, see `T_OF`.
        since: which powers it changes.
        went: see `walk_since`.
        by_rad: the angle; 0: the frame has not turned.
        early_m2: see `turn_gains`.
        other: takes what is foretold.
    """
    other_fall_db, off_db, variance = other
    cosine, sine = np.cos(moment[PSI] + by_rad), np.sin(moment[PSI] + by_rad)
    between = 0.0 if by_rad == 0.0 else BETWEEN_RAD2
    early = early_m2 * 0.5 * (1.0 - np.cos(by_rad))
    for i in since:
        row = heard[i]
        east = moment[EAST_OF] + cosine * went[i, 0] - sine * went[i, 1] - row[THERE_E]
        north = moment[NORTH_OF] + sine * went[i, 0] + cosine * went[i, 1] - row[THERE_N]
        squared_m2 = east * east + north * north + row[UP] ** 2 + ANTENNA_M**2
        unsure_m2 = between * (went[i, 0] ** 2 + went[i, 1] ** 2) + early
        if row[EXPONENT] == 0.0:
            off_db[i] = row[OFF_DB] + fall_db[i] - np.sqrt(squared_m2)
            variance[i] = row[VARIANCE] + unsure_m2
            continue
        other_fall_db[i] = fall_of(squared_m2)
        off_db[i] = row[OFF_DB] + row[EXPONENT] * (other_fall_db[i] - fall_db[i])
        slope = DB_PER_NEPER * row[EXPONENT]
        variance[i] = row[VARIANCE] + unsure_m2 * slope * slope / (squared_m2 + unsure_m2)
