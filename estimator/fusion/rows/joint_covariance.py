"""The joint covariance of the numbers that each reading of a tick depends on.

A tick's readings share their numbers: what each of these has to do with the others is found once, and all
that is asked of a reading (how unsure its prediction is, how far aside of its line of sight, how much
farther) is then a form of nine numbers.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.rows.rows import WIDTH
from estimator.graph.dense import Array, Indices
from estimator.graph.triangular import forward_all

BLOCK = 3
"""Numbers of a place, which follow each other."""


class TouchedNumbers(NamedTuple):
    """The numbers that a tick's readings depend on.

    Attributes:
        used: they are, k, ascending.
        others: all others, ascending.
        at: which of the first each reading depends on, m × 9; −1 where there is none.
        hubs: those of them of which it is asked what they have to do with any other one.
        hub: number of each among the hubs, k; −1: of it no more is asked than of its own block.
    """

    used: Indices
    others: Indices
    at: Indices
    hubs: Indices
    hub: Indices


@njit(cache=True, error_model="numpy")
def numbers_of(columns: Indices, n: int) -> TouchedNumbers:
    """The numbers of readings.

    Of two places between which there is a reading, one has to be a hub: that with more readings, so that a
    few who hear many radios are enough.

    Args:
        columns: which numbers each reading depends on, m × 9; see `rows.columns_of`.
        n: how many numbers there are.
    """
    m = len(columns)
    place, readings, hubs = np.full(n, -1), np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.bool_)
    for r in range(m):
        for i in range(WIDTH):
            if columns[r, i] >= 0:
                place[columns[r, i]] = 0
                if i >= 2 * BLOCK:
                    hubs[columns[r, i]] = True
                elif i % BLOCK == 0:
                    readings[columns[r, i]] += 1
    used = np.flatnonzero(place == 0)
    for k in range(len(used)):
        place[used[k]] = k
    at = np.full((m, WIDTH), -1)
    for r in range(m):
        a, b = columns[r, 0], columns[r, BLOCK]
        if a >= 0 and b >= 0:
            near = a if readings[a] >= readings[b] else b
            hubs[near : near + BLOCK] = True
        for i in range(WIDTH):
            if columns[r, i] >= 0:
                at[r, i] = place[columns[r, i]]
    hub, picked = np.full(len(used), -1), np.flatnonzero(hubs[used])
    for k in range(len(picked)):
        hub[picked[k]] = k
    return TouchedNumbers(used, np.flatnonzero(place < 0), at, picked, hub)


@njit(cache=True, error_model="numpy")
def joint(factor: Array, unscale: Array, numbers: TouchedNumbers, own: Array) -> None:
    """Covariance of the numbers of each reading.

    Args:
        factor: of the information about them, as `factorised` leaves it, k × k.
        unscale: the same, k.
        numbers: of m readings.
        own: takes the covariances, m × 9 × 9; where a reading has no number it stays as it is.
    """
    k = len(unscale)
    halves, blocks = np.zeros((k, k)), np.zeros((BLOCK, k))
    for c in range(k):
        halves[c, c] = unscale[c]
    forward_all(factor, halves, np.arange(k))
    for i in range(k):
        for apart in range(BLOCK):
            total, row, there = blocks[apart], halves[i], halves[i, apart:]
            for c in range(i + 1 - apart):
                total[c] += row[c] * there[c]
    # Before its own row a half of a number is nil.
    first = numbers.hubs[0] if len(numbers.hubs) else k
    across = np.dot(halves[first:, numbers.hubs].T, halves[first:])
    for r in range(len(own)):
        for i in range(WIDTH):
            one = numbers.at[r, i]
            if one < 0:
                continue
            for j in range(i + 1):
                other = numbers.at[r, j]
                if other < 0:
                    continue
                if numbers.hub[one] >= 0:
                    found = across[numbers.hub[one], other]
                elif numbers.hub[other] >= 0:
                    found = across[numbers.hub[other], one]
                else:
                    found = blocks[abs(one - other), min(one, other)]
                own[r, i, j] = own[r, j, i] = found


@njit(cache=True, error_model="numpy")
def variances(own: Array, jacobian: Array, found: Array) -> None:
    """Variance of a linear form of the numbers of each reading, such as its prediction, H Σ Hᵀ.

    Args:
        own: covariances, see `joint`, m × 9 × 9.
        jacobian: H of each, m × 9; 0 where there is no number.
        found: takes the variances, m.
    """
    for r in range(len(found)):
        found[r] = variance(own, jacobian, r)


@njit(cache=True, error_model="numpy", forceinline=True)
def variance(own: Array, jacobian: Array, r: int) -> float:
    """The same of reading `r` alone."""
    total = 0.0
    for i in range(WIDTH):
        if jacobian[r, i] != 0.0:
            half = 0.5 * jacobian[r, i] * own[r, i, i]
            for j in range(i):
                if jacobian[r, j] != 0.0:
                    half += jacobian[r, j] * own[r, i, j]
            total += 2.0 * jacobian[r, i] * half
    return max(total, 0.0)
