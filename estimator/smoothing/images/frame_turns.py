"""How much likelier powers are if a unit's frame has turned at some moment by some angle, compiled.

All moments and angles are looked at in one call. Where all others are, and how his way began, is held; P0 and
n are found anew for each: a wrong way makes their law flat, and then no power tells of another one.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.memory.ledger import RSSI
from estimator.graph.dense import Array
from estimator.measurements.rssi import ANTENNA_M, DB_PER_NEPER

T, EAST, NORTH, UP, THERE_E, THERE_N, OFF_DB, EXPONENT, VARIANCE, RADIO, SINCE_T = range(11)
"""Of each power: epoch (s); where its bearer is by the solution: east, north, and how much higher than the
other end (m); the other end: east, north (m); what is left of it (dB); n; variance of its noise (dB²); which
radio the other end is; from when on that one lies where it is (s)."""
HEARD = 11
T_OF, EAST_OF, NORTH_OF, PSI, BETA, STRETCH = range(6)
"""Of each moment: epoch (s); where the unit's bearer was: east, north (m); ψ, β and s − 1 there."""
APART_RAD = np.pi / 6.0
TURNS_RAD = np.arange(2, 11) * APART_RAD
"""A smaller angle each window finds by itself."""
BETWEEN_RAD2 = APART_RAD**2 / 12.0
MOST = 4.0
"""What a power costs at most (log likelihood): one in twenty is an outlier, whatever it is off by."""
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
    m, moments, angles = len(heard), told.moments, len(TURNS_RAD)
    gains, each = np.zeros((len(moments), angles)), np.zeros(int(heard[:, RADIO].max()) + 1 if m else 0)
    fall, length, usual, went = np.empty(m), np.empty(m), np.empty(m), np.empty((m, 2))
    none_db, off_db, variance = np.empty(m), np.empty(m), np.empty(m)
    by_power, by_exponent = 1.0 / law[0, 1] ** 2, 1.0 / law[1, 1] ** 2
    unusual = 0.5 * (law[0, 0] ** 2 * by_power + law[1, 0] ** 2 * by_exponent)
    for i in range(m):
        row = heard[i]
        east, north = row[EAST] - row[THERE_E], row[NORTH] - row[THERE_N]
        squared_m2 = east * east + north * north + row[UP] ** 2 + ANTENNA_M**2
        fall[i] = 0.5 * DB_PER_NEPER * np.log(squared_m2)
        usual[i] = min(0.5 * row[OFF_DB] ** 2 / row[VARIANCE], MOST)
    for j in range(len(moments)):
        t, beta, scale = moments[j, T_OF], moments[j, BETA], 1.0 + moments[j, STRETCH]
        # What powers before it tell of P0 and n, beside what is usual.
        pp, pn, nn, p, n = by_power, 0.0, by_exponent, -law[0, 0] * by_power, -law[1, 0] * by_exponent
        beside, least = unusual + told.bent[j], unusual + told.bent[j]
        for i in range(m):
            row = heard[i]
            if row[T] > t and row[SINCE_T] <= t:
                least += usual[i]
                east, north = told.sums[i, 0] - told.at_moments[j, 0], told.sums[i, 1] - told.at_moments[j, 1]
                since_e = told.sums[i, 2] - told.at_moments[j, 2] - east * (t - told.begin_t)
                since_n = told.sums[i, 3] - told.at_moments[j, 3] - north * (t - told.begin_t)
                went[i, 0], went[i, 1] = scale * (east - beta * since_n), scale * (north + beta * since_e)
            elif usual[i] < MOST:
                weight = 1.0 / row[VARIANCE]
                pp, pn, nn = pp + weight, pn - weight * fall[i], nn + weight * fall[i] ** 2
                p, n = p + weight * row[OFF_DB], n - weight * fall[i] * row[OFF_DB]
        none_db[:] = heard[:, OFF_DB]
        for a in range(-1, angles):
            by_rad = 0.0 if a < 0 else TURNS_RAD[a]
            cosine, sine = np.cos(moments[j, PSI] + by_rad), np.sin(moments[j, PSI] + by_rad)
            between, early = (0.0, 0.0) if a < 0 else (BETWEEN_RAD2, early_m2 * 0.5 * (1.0 - np.cos(by_rad)))
            own_pp, own_pn, own_nn, own_p, own_n = pp, pn, nn, p, n
            for i in range(m):
                row = heard[i]
                if row[T] <= t or row[SINCE_T] > t:
                    continue
                east = moments[j, EAST_OF] + cosine * went[i, 0] - sine * went[i, 1] - row[THERE_E]
                north = moments[j, NORTH_OF] + sine * went[i, 0] + cosine * went[i, 1] - row[THERE_N]
                squared_m2 = east * east + north * north + row[UP] ** 2 + ANTENNA_M**2
                length[i] = 0.5 * DB_PER_NEPER * np.log(squared_m2)
                off_db[i] = row[OFF_DB] + row[EXPONENT] * (length[i] - fall[i])
                unsure_m2 = between * (went[i, 0] ** 2 + went[i, 1] ** 2) + early
                slope = DB_PER_NEPER * row[EXPONENT]
                variance[i] = row[VARIANCE] + unsure_m2 * slope * slope / (squared_m2 + unsure_m2)
                weight = 1.0 / variance[i]
                if 0.5 * off_db[i] ** 2 * weight < MOST:
                    own_pp, own_pn = own_pp + weight, own_pn - weight * length[i]
                    own_nn += weight * length[i] ** 2
                    own_p, own_n = own_p + weight * off_db[i], own_n - weight * length[i] * off_db[i]
            size = own_pp * own_nn - own_pn * own_pn
            power = (own_nn * own_p - own_pn * own_n) / size
            steeper = (own_pp * own_n - own_pn * own_p) / size
            # Those before it, and what is usual, as a parabola about the solution.
            total = unusual - p * power - n * steeper
            total += 0.5 * (pp * power**2 + 2.0 * pn * power * steeper + nn * steeper**2)
            by_law, each[:] = total, 0.0
            for i in range(m):
                row = heard[i]
                if row[T] <= t or row[SINCE_T] > t:
                    continue
                off = off_db[i] - power + steeper * length[i]
                cost = min(0.5 * off * off / variance[i], MOST)
                total += cost
                if a < 0:
                    off_db[i] = off
                else:
                    # What lies between two angles all powers share: it is as unsure without a turn.
                    each[int(row[RADIO])] += min(0.5 * none_db[i] ** 2 / variance[i], MOST) - cost
            if a >= 0:
                gains[j, a] = beside - by_law + each.sum() - max(each.max() - KICKED, 0.0)
            elif total < least:
                none_db[:], beside = off_db, by_law
    return gains


@njit(cache=True, error_model="numpy")
def power_costs(pairs: Array, off_db: Array, variance: Array, since_t: float, numbers: Array) -> Array:
    """What powers of some walks since an epoch cost, how many they are, and ranges as well, walks × 3.

    Args:
        pairs: the ledger's rows, m × 11.
        off_db: what is left of each, m (dB).
        variance: of its noise, m (dB²); infinite: it tells nothing.
        since_t: the epoch (s).
        numbers: of the walks' nodes.
    """
    found = np.zeros((len(numbers), 3))
    for i in range(len(pairs)):
        if pairs[i, 0] <= since_t or pairs[i, 1] > RSSI or variance[i] == np.inf:
            continue
        for w in range(len(numbers)):
            if pairs[i, 2] != numbers[w] and pairs[i, 3] != numbers[w]:
                continue
            if pairs[i, 1] == RSSI:
                found[w, 0] += min(0.5 * off_db[i] ** 2 / variance[i], MOST)
                found[w, 1] += 1.0
            else:
                found[w, 2] += 1.0
    return found
