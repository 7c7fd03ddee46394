"""A turn of the whole map: of that readings between nodes say nothing.

With derivatives taken at places r, their Kirchhoff matrix knows nothing of the turn (J r, 1), places by J r
and headings by 1; with those taken at x it knows nothing of (J x, 1) instead; and both together know of any
turn, which nobody measured (the observability constraint of Huang, Mourikis, Roumeliotis 2010).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices

UNIT_M = 1.0
"""Nearer than this to the pivot, a place hardly moves when the map is turned."""
FAR = 0.5
"""A place that has moved by more than this share of its way from the pivot is not where it was thought to be:
to say there what was said here would make up knowledge, or lose it."""
ANYWHERE_M = 1000.0
"""Where no reading holds the map, it is turned about the base, give or take this."""


class Turning(NamedTuple):
    """Which numbers change when the map is turned as a whole.

    Attributes:
        places: east and north of places that turn with it, m × 2: not of those that were told.
        speeds: those of velocities, k × 2.
        headings: of units, h.
    """

    places: Indices
    speeds: Indices
    headings: Indices


@njit(cache=True, error_model="numpy")
def turn_about(here: Array, changed: Turning, pivot_m: Array) -> Array:
    """By how much each number changes with a turn of the map, per radian: J (x − c), J v and 1; n.

    Args:
        here: x, n.
        changed: which of the numbers change with a turn.
        pivot_m: c, what the map is turned about, east and north, 2 (m).
    """
    found, (places, speeds, headings) = np.zeros(len(here)), changed
    for e, n in places:
        found[e], found[n] = pivot_m[1] - here[n], here[e] - pivot_m[0]
    for e, n in speeds:
        found[e], found[n] = -here[n], here[e]
    found[headings] = 1.0
    return found


@njit(cache=True, error_model="numpy")
def turn_pairs(here: Array, pairs: Indices, pivot_m: Array, by_rad: float) -> None:
    """Turn places, or velocities, to the left.

    Args:
        here: x, n, changed.
        pairs: which of the numbers are their east and north, m × 2.
        pivot_m: what they are turned about, 2 (m); velocities about nil.
        by_rad: how far (rad).
    """
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    for e, n in pairs:
        way_e, way_n = here[e] - pivot_m[0], here[n] - pivot_m[1]
        here[e] = pivot_m[0] + way_e * cosine - way_n * sine
        here[n] = pivot_m[1] + way_e * sine + way_n * cosine


@njit(cache=True, error_model="numpy")
def held(matrix: Array, ways: Array) -> Array:
    """L of each of some changes, k × n.

    Four rows at a time: each sum waits for its last term, four of them need not wait for each other.

    Args:
        matrix: L, n × n or larger.
        ways: the changes, k × n.
    """
    (k, n), found = ways.shape, np.empty(ways.shape)
    whole = n - n % 4
    for way in range(k):
        own, sums = ways[way], found[way]
        for i in range(0, whole, 4):
            first, second, third, fourth = matrix[i], matrix[i + 1], matrix[i + 2], matrix[i + 3]
            one = two = three = four = 0.0
            for j in range(n):
                one += first[j] * own[j]
                two += second[j] * own[j]
                three += third[j] * own[j]
                four += fourth[j] * own[j]
            sums[i], sums[i + 1], sums[i + 2], sums[i + 3] = one, two, three, four
        for i in range(whole, n):
            row, total = matrix[i], 0.0
            for j in range(n):
                total += row[j] * own[j]
            sums[i] = total
    return found


@njit(cache=True, error_model="numpy")
def pivot(matrix: Array, reference: Array, changed: Turning, base_m: Array) -> Array:
    """The place about which a turn of the whole map is known least, 2 (m).

    A turn about c moves places r by J (r − c), velocities v by J v and headings by 1: g₁ + T t, where T moves
    all places by t = −J c. What is known of it, (g₁ + T t)ᵀ L (g₁ + T t), is least for TᵀL T t = −TᵀL g₁.

    Args:
        matrix: L of what is known, n × n or larger.
        reference: where it was linearised, n.
        changed: which of the numbers change with a turn.
        base_m: east and north of the base, 2 (m).
    """
    ways = np.zeros((3, len(reference)))
    ways[0] = turn_about(reference, changed, base_m)
    for e, n in changed.places:
        ways[1, e] = ways[2, n] = 1.0
    known = np.dot(held(matrix, ways), ways.T)
    known[1, 1] += ANYWHERE_M**-2
    known[2, 2] += ANYWHERE_M**-2
    moved_m = np.linalg.solve(known[1:, 1:].copy(), -known[1:, 0])
    found_m: Array = base_m + np.array([-moved_m[1], moved_m[0]])
    return found_m


@njit(cache=True, error_model="numpy")
def turned_along(was: Array, now: Array, pairs: Indices, pivot_m: Array) -> Array:
    """What takes deviations from x for such from r: those along J x, a turn, are along J r; m × 2 × 2.

    A = I + J (r − x) (J x)ᵀ / |x|² of each pair, for x and r from the pivot; I of what has moved too far.

    Args:
        was: r, n.
        now: x, n.
        pairs: which of the numbers are east and north of places or of velocities, m × 2.
        pivot_m: what they are turned about, 2 (m).
    """
    change = np.zeros((len(pairs), 2, 2))
    for i in range(len(pairs)):
        e, n = pairs[i]
        off_e, off_n = was[e] - now[e], was[n] - now[n]
        way_e, way_n = now[e] - pivot_m[0], now[n] - pivot_m[1]
        squared = way_e**2 + way_n**2 + UNIT_M**2
        share = 1.0 / squared if off_e**2 + off_n**2 <= FAR**2 * squared else 0.0
        change[i, 0, 0] = 1.0 + share * off_n * way_n
        change[i, 0, 1] = -share * off_n * way_e
        change[i, 1, 0] = -share * off_e * way_n
        change[i, 1, 1] = 1.0 + share * off_e * way_e
    return change


@njit(cache=True)
def change_pairs(matrix: Array, vector: Array, pairs: Indices, changes: Array) -> None:
    """AᵀLA and Aᵀb in the place of L and b, where A changes pairs of numbers among themselves.

    L is gone through once, by rows as it lies in memory: by columns it takes several times as long.

    Args:
        matrix: L, n × n or larger, changed.
        vector: b, n, changed.
        pairs: which numbers, m × 2; none is in two of them.
        changes: the block of A of each pair, m × 2 × 2.
    """
    paired = np.zeros(len(vector), dtype=np.bool_)
    for i in range(len(pairs)):
        e, n = pairs[i]
        paired[e] = paired[n] = True
        ee, en, ne, nn = changes[i, 0, 0], changes[i, 0, 1], changes[i, 1, 0], changes[i, 1, 1]
        for k in (e, n):
            change_along(matrix, k, pairs, changes, 0, i + 1)
        for k in range(len(vector)):
            one, other = matrix[e, k], matrix[n, k]
            matrix[e, k], matrix[n, k] = one * ee + other * ne, one * en + other * nn
        for k in (e, n):
            change_along(matrix, k, pairs, changes, i + 1, len(pairs))
        one, other = vector[e], vector[n]
        vector[e], vector[n] = one * ee + other * ne, one * en + other * nn
    for k in range(len(vector)):
        if not paired[k]:
            change_along(matrix, k, pairs, changes, 0, len(pairs))


@njit(cache=True, forceinline=True)
def change_along(matrix: Array, row: int, pairs: Indices, changes: Array, first: int, last: int) -> None:
    """Change pairs of numbers among themselves in one row of L.

    Args:
        matrix: L, n × n or larger, changed.
        row: which one.
        pairs: see `change_pairs`.
        changes: see `change_pairs`.
        first: the first of the pairs to change.
        last: the one to stop before.
    """
    for i in range(first, last):
        e, n = pairs[i]
        one, other = matrix[row, e], matrix[row, n]
        matrix[row, e] = one * changes[i, 0, 0] + other * changes[i, 1, 0]
        matrix[row, n] = one * changes[i, 0, 1] + other * changes[i, 1, 1]


@njit(cache=True)
def turning(by_rad: float) -> Array:
    """What turns ways, … × 2, to the left by an angle: R with `ways @ R`, 2 × 2."""
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    return np.array([[cosine, sine], [-sine, cosine]])
