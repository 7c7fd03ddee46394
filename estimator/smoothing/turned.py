"""The map as a whole may be turned, and nobody learns from that where north is.

Readings between nodes say nothing of it. With derivatives taken at places r, their Kirchhoff matrix knows
nothing of the turn (J r, 1), places by J r and headings by 1; with those taken at x it knows nothing of
(J x, 1) instead; and both together know of any turn, which nobody measured (the observability constraint of
Huang, Mourikis, Roumeliotis 2010). So what is known from before is turned along with the map, and said anew
where its reference moves.
"""

import numpy as np

from estimator.graph.dense import Array
from estimator.smoothing.chain import Remainder
from estimator.smoothing.layout import Layout

STEADY_M = 2.0
"""A place as far from the base as this, that seems to have gone round it, may as well have been moved."""
UNIT_M = 1.0
"""Nearer than this to the base, a place hardly moves when the map is turned."""
FAR = 0.5
"""A place that has moved by more than this share of its way from the base is not where it was thought to be:
to say there what was said here would make up knowledge, or lose it."""


def turn_between(was_m: Array, now_m: Array) -> float:
    """By how much places are turned about the base, by least squares (rad), less than a quarter turn.

    Somewhat less than it is where all of them are near the base: they may as well have been moved.

    Args:
        was_m: from the base to where they were, m × 2.
        now_m: to where they are, m × 2.
    """
    across = float((was_m[:, 0] * now_m[:, 1] - was_m[:, 1] * now_m[:, 0]).sum())
    along = max(float((was_m * now_m).sum()), 0.0)
    return float(np.arctan2(across, along + STEADY_M**2))


def turn(ways: Array, by_rad: float) -> Array:
    """Ways, … × 2, turned to the left."""
    cosine, sine = np.cos(by_rad), np.sin(by_rad)
    return np.asarray(ways @ np.array([[cosine, sine], [-sine, cosine]]))


def across(ways: Array) -> Array:
    """J of ways, m × 2: a quarter turn to the left."""
    return np.stack([-ways[:, 1], ways[:, 0]], axis=1)


def turned(left: Remainder, layout: Layout, was: Array, now: Array) -> Remainder:
    """A remainder with what it knows of standing nodes said where they are now.

    Each deviation from x is taken for one from r in which the part along J x, a turn about the base, is one
    along J r: A = I + J (r − x) (J x)ᵀ / |x|².

    Args:
        left: of a keyframe and the border; the keyframe's derivatives were taken where it is.
        layout: of the window.
        was: r, where the derivatives by the border were taken, flat.
        now: x, the estimate, flat.
    """
    size = layout.length * layout.width
    starts = np.array(list(layout.stands.values()), dtype=np.intp)
    at = starts[:, None] + np.arange(2)
    base_m = np.array(layout.state.base_place()[:2])
    off_m, place_m = was[size + at] - now[size + at], now[size + at] - base_m
    squared = (place_m**2).sum(axis=1) + UNIT_M**2
    near = (off_m**2).sum(axis=1) <= FAR**2 * squared
    if not (off_m[near] != 0.0).any():
        return left
    share = np.where(near, 1.0 / squared, 0.0)
    change = np.eye(2) + share[:, None, None] * across(off_m)[:, :, None] * across(place_m)[:, None, :]
    matrix, vector, own = left.matrix.copy(), left.vector.copy(), layout.width + at
    matrix[:, own] = np.einsum("nkc,kcd->nkd", matrix[:, own], change)
    matrix[own] = np.einsum("kcd,kcn->kdn", change, matrix[own])
    vector[own] = np.einsum("kcd,kc->kd", change, vector[own])
    return Remainder(0.5 * (matrix + matrix.T), vector)
