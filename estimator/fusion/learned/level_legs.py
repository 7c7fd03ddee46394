"""Legs of a way without a stair: floors are level, so they tell what a unit's heights do by themselves."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices

STRIDE_M, LEG_M, SHORTEST_M = 0.5, 8.0, 4.0
"""A way is looked at by the stride, and tells by the leg; one that ends at a stair may be shorter."""
STEEP, SIGMAS = 0.12, 2.5
"""Who climbs by more for each metre, beside noise, is on a stair; ramps are 0.05 to 0.1."""
UNEVEN = 0.01
"""Sills and thresholds: the ground rises or falls by so much more, leg by leg (m/m)."""
ROUND = 0.5
"""Who gets no farther than this share of his way has turned round."""


class Legs(NamedTuple):
    """Legs without a stair, one after the other.

    Attributes:
        rise: what they climb for each metre (m/m), n.
        variance: of that, n.
        way_m: how long they are, n (m).
        turns: their bearers have turned round on them, or since the one before, n.
        of_row: for each displacement the leg that it is part of, or −1 − how many there are before it.
    """

    rise: Array
    variance: Array
    way_m: Array
    turns: Indices
    of_row: Indices


@njit(cache=True)
def legs_of(moved: Array) -> Legs:
    """Legs without a stair of a way; see `unit_rise.rises_of` for `moved`."""
    m = len(moved)
    rise, variance, way_m = np.empty(m + 1), np.empty(m + 1), np.empty(m + 1)
    turns, of_row, number = np.zeros(m + 1, dtype=np.intp), np.full(m, -1), 0
    # Of the leg, of the stride after it, which may be half on a stair, and of the one under way: way, east,
    # north, climb (m), variance of the climb (m²).
    leg, newest, stride, towards = np.zeros(5), np.zeros(5), np.zeros(5), np.zeros(2)
    fresh, begins = True, 0
    for i in range(m + 1):
        over = i == m or moved[i, 4] != 1.0
        if not over:
            stride[0] += math.hypot(moved[i, 0], moved[i, 1])
            stride[1:] += moved[i, :4]
            of_row[i] = -1 - number
            if stride[0] < STRIDE_M:
                continue
            over = abs(stride[3]) > STEEP * stride[0] + SIGMAS * math.sqrt(stride[4])
        elif i < m:
            of_row[i] = -1 - number
        if not over:
            leg += newest
            # The first stride after a stair may be half on it.
            newest[:] = stride
            newest *= 0.0 if fresh else 1.0
            stride[:] = 0.0
            fresh = False
        if leg[0] > (SHORTEST_M if over else LEG_M):
            rise[number], variance[number] = leg[3] / leg[0], leg[4] / leg[0] ** 2 + UNEVEN**2
            way_m[number] = leg[0]
            onward = leg[1] * towards[0] + leg[2] * towards[1]
            turns[number] = onward < 0.0 or math.hypot(leg[1], leg[2]) < ROUND * leg[0]
            towards[:] = leg[1:3]
            leg[:] = 0.0
            # Stride by stride a stair that is climbed slowly may not show.
            if abs(rise[number]) < STEEP + SIGMAS * math.sqrt(variance[number]):
                of_row[begins:i] = number
                number += 1
            begins = i
        if over:
            leg[:] = 0.0
            newest[:] = 0.0
            stride[:] = 0.0
            fresh, begins = True, i + 1
    return Legs(rise[:number], variance[:number], way_m[:number], turns[:number], of_row)
