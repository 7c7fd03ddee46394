"""Powers and ranges that a walk's radio has told, as rows of numbers, and what they cost, compiled."""

import numpy as np
from numba import njit

from estimator.fusion.memory.ledger import RSSI
from estimator.graph.dense import Array, Indices
from estimator.measurements.rssi import ANTENNA_M, DB_PER_NEPER

T, EAST, NORTH, UP, THERE_E, THERE_N, OFF_DB, EXPONENT, VARIANCE, RADIO, SINCE_T = range(11)
"""Of each power: epoch (s); where its bearer is by the solution: east, north, and how much higher than the
other end (m); the other end: east, north (m); what is left of it (dB); n; variance of its noise (dB²); which
radio the other end is; from when on that one lies where it is (s). Of a range the same in metres; n is 0."""
HEARD = 11
MOST = 4.0
"""What a power costs at most (log likelihood): one in twenty is an outlier, whatever it is off by."""


@njit(cache=True, error_model="numpy", forceinline=True)
def cost_of(off_db: float, variance: float) -> float:
    """What a power costs that is off by so much (log likelihood)."""
    cost: float = min(0.5 * off_db * off_db / variance, MOST)
    return cost


@njit(cache=True, error_model="numpy")
def cost_since(since: Indices, off_db: Array, variance: Array, cost: float) -> float:
    """What some of m powers cost, beside what all else does."""
    for i in since:
        cost += cost_of(off_db[i], variance[i])
    return cost


@njit(cache=True, error_model="numpy", forceinline=True)
def fall_of(squared_m2: float) -> float:
    """By how much n = 1 lets a power fall over a distance (dB)."""
    fall_db: float = 0.5 * DB_PER_NEPER * np.log(squared_m2)
    return fall_db


@njit(cache=True, error_model="numpy")
def falls(heard: Array) -> Array:
    """By how much n = 1 lets each power fall where its bearer is by the solution, m (dB).

    Of a range its length (m).
    """
    fall_db = np.empty(len(heard))
    for i in range(len(heard)):
        row = heard[i]
        east, north = row[EAST] - row[THERE_E], row[NORTH] - row[THERE_N]
        squared_m2 = east * east + north * north + row[UP] ** 2 + ANTENNA_M**2
        fall_db[i] = fall_of(squared_m2) if row[EXPONENT] > 0.0 else np.sqrt(squared_m2)
    return fall_db


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
                found[w, 0] += cost_of(off_db[i], variance[i])
                found[w, 1] += 1.0
            else:
                found[w, 2] += 1.0
    return found
