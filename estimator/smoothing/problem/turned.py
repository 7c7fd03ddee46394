"""The map as a whole may be turned, and nobody learns from that where north is.

Readings between nodes say nothing of it. With derivatives taken at places r, their Kirchhoff matrix knows
nothing of the turn (J r, 1), places by J r and headings by 1; with those taken at x it knows nothing of
(J x, 1) instead; and both together know of any turn, which nobody measured (the observability constraint of
Huang, Mourikis, Roumeliotis 2010). So what is known from before is turned along with the map, and said anew
where its reference moves.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices
from estimator.smoothing.chain.chain import Remainder
from estimator.smoothing.keyframes.layout import Layout

STEADY_M = 2.0
"""A place as far from the pivot as this, that seems to have gone round it, may as well have been moved."""
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
        places: east and north of places, m × 2.
        speeds: those of velocities, k × 2.
        headings: of units, h.
    """

    places: Indices
    speeds: Indices
    headings: Indices


def pivot(matrix: Array, reference: Array, changed: Turning, base_m: Array) -> Array:
    """The place about which a turn of the whole map is known least, 2 (m).

    A turn about c moves places r by J (r − c), velocities v by J v and headings by 1: g₁ + T t, where T moves
    all places by t = −J c. What is known of it, (g₁ + T t)ᵀ L (g₁ + T t), is least for TᵀL T t = −TᵀL g₁.

    Args:
        matrix: L of what is known, n × n.
        reference: where it was linearised, n.
        changed: which of the numbers change with a turn.
        base_m: east and north of the base, 2 (m).
    """
    places, speeds, headings = changed
    turn_all, move_all = np.zeros(len(reference)), np.zeros((len(reference), 2))
    turn_all[places] = across(reference[places] - base_m)
    turn_all[speeds] = across(reference[speeds])
    turn_all[headings] = 1.0
    move_all[places, [0, 1]] = 1.0
    told = matrix @ move_all
    held = move_all.T @ told + np.eye(2) / ANYWHERE_M**2
    moved_m = np.asarray(np.linalg.solve(held, -(told.T @ turn_all)), dtype=np.float64)
    return np.asarray(base_m + across(moved_m[None])[0])


@njit(cache=True)
def turn_between(was_m: Array, now_m: Array) -> float:
    """By how much places are turned about the pivot, by least squares (rad), less than a quarter turn.

    Somewhat less than it is where all of them are near the pivot: they may as well have been moved.

    Args:
        was_m: from the pivot to where they were, m × 2.
        now_m: to where they are, m × 2.
    """
    across = along = 0.0
    for i in range(len(was_m)):
        across += was_m[i, 0] * now_m[i, 1] - was_m[i, 1] * now_m[i, 0]
        along += was_m[i, 0] * now_m[i, 0] + was_m[i, 1] * now_m[i, 1]
    return float(np.arctan2(across, max(along, 0.0) + STEADY_M**2))


def turn(ways: Array, by_rad: float) -> Array:
    """Ways, … × 2, turned to the left."""
    return np.asarray(ways @ turning(by_rad))


@njit(cache=True)
def turning(by_rad: float) -> Array:
    """What turns ways, … × 2, to the left by an angle: R with `ways @ R`, 2 × 2."""
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    return np.array([[cosine, sine], [-sine, cosine]])


def across(ways: Array) -> Array:
    """J of ways, m × 2: a quarter turn to the left."""
    found = np.empty(ways.shape)
    found[:, 0], found[:, 1] = -ways[:, 1], ways[:, 0]
    return found


@njit(cache=True)
def moved_from(
    reference: Array, here: Array, places: Indices, speeds: Indices, pivot_m: Array, turned_by: float
) -> Array:
    """What a prior takes for deviations from its reference, n.

    R(−θ) x − r + θ J r of places: what a turn of the whole map by θ moves is along (J r, 1) only, however
    large the turn, and of that the prior knows nothing but what was said of headings.

    Args:
        reference: r, n.
        here: x, n.
        places: which of the numbers are east and north of places, m × 2.
        speeds: which are those of velocities, k × 2.
        pivot_m: what the map is turned about, east and north, 2 (m).
        turned_by: θ (rad).
    """
    moved, cosine, sine = here - reference, np.cos(turned_by), np.sin(turned_by)
    for i in range(len(places) + len(speeds)):
        place = i < len(places)
        e, n = places[i] if place else speeds[i - len(places)]
        from_e, from_n = (pivot_m[0], pivot_m[1]) if place else (0.0, 0.0)
        was_e, was_n = reference[e] - from_e, reference[n] - from_n
        now_e, now_n = here[e] - from_e, here[n] - from_n
        moved[e] = cosine * now_e + sine * now_n - was_e - turned_by * was_n
        moved[n] = cosine * now_n - sine * now_e - was_n + turned_by * was_e
    return moved


@njit(cache=True)
def change_pairs(matrix: Array, vector: Array, pairs: Indices, changes: Array) -> None:
    """AᵀLA and Aᵀb in the place of L and b, where A changes pairs of numbers among themselves.

    Args:
        matrix: L, n × n, changed.
        vector: b, n, changed.
        pairs: which numbers, m × 2.
        changes: the block of A of each pair, m × 2 × 2.
    """
    for i in range(len(pairs)):
        e, n = pairs[i]
        ee, en, ne, nn = changes[i, 0, 0], changes[i, 0, 1], changes[i, 1, 0], changes[i, 1, 1]
        for k in range(len(vector)):
            one, other = matrix[k, e], matrix[k, n]
            matrix[k, e], matrix[k, n] = one * ee + other * ne, one * en + other * nn
        for k in range(len(vector)):
            one, other = matrix[e, k], matrix[n, k]
            matrix[e, k], matrix[n, k] = one * ee + other * ne, one * en + other * nn
        one, other = vector[e], vector[n]
        vector[e], vector[n] = one * ee + other * ne, one * en + other * nn


def turned(left: Remainder, layout: Layout, pivot_m: Array, was: Array, now: Array) -> Remainder:
    """A remainder with what it knows of standing nodes said where they are now.

    Each deviation from x is taken for one from r in which the part along J x, a turn about the pivot, is one
    along J r: A = I + J (r − x) (J x)ᵀ / |x|².

    Args:
        left: of a keyframe and the border; the keyframe's derivatives were taken where it is.
        layout: of the window.
        pivot_m: what the map is turned about, east and north, 2 (m).
        was: r, where the derivatives by the border were taken, flat.
        now: x, the estimate, flat.
    """
    size = layout.length * layout.width
    starts = np.array(list(layout.stands.values()), dtype=np.intp)
    at = starts[:, None] + np.arange(2)
    off_m, place_m = was[size + at] - now[size + at], now[size + at] - pivot_m
    squared = (place_m**2).sum(axis=1) + UNIT_M**2
    near = (off_m**2).sum(axis=1) <= FAR**2 * squared
    if not (off_m[near] != 0.0).any():
        return left
    share = np.where(near, 1.0 / squared, 0.0)
    change = np.eye(2) + share[:, None, None] * across(off_m)[:, :, None] * across(place_m)[:, None, :]
    matrix, vector, own = left.matrix.copy(), left.vector.copy(), layout.width + at
    change_pairs(matrix, vector, own, change)
    return Remainder(0.5 * (matrix + matrix.T), vector)
