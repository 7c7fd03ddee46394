"""What is known from before is turned along with the map, and said anew where its reference moves.

So nobody learns where north is from readings that say nothing of it, see `graph.gauge`.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices
from estimator.graph.gauge import change_pairs, turned_along
from estimator.smoothing.chain.chain import Remainder
from estimator.smoothing.keyframes.layout import Layout

STEADY_M = 2.0
"""A place as far from the pivot as this, that seems to have gone round it, may as well have been moved."""


@njit(cache=True)
def turn_between(was_m: Array, now_m: Array, known_per_m2: Array) -> float:
    """By how much places are turned about the pivot, by least squares (rad), less than a quarter turn.

    Somewhat less than it is where all of them are near the pivot: they may as well have been moved. Of where
    one was that hardly was known it tells nothing that it is elsewhere.

    Args:
        was_m: from the pivot to where they were, m × 2.
        now_m: to where they are, m × 2.
        known_per_m2: how well it was known where each was, m (1/m²).
    """
    across = along = 0.0
    for i in range(len(was_m)):
        weight = known_per_m2[i] / (known_per_m2[i] + STEADY_M**-2)
        across += weight * (was_m[i, 0] * now_m[i, 1] - was_m[i, 1] * now_m[i, 0])
        along += weight * (was_m[i, 0] * now_m[i, 0] + was_m[i, 1] * now_m[i, 1])
    return float(np.arctan2(across, max(along, 0.0) + STEADY_M**2))


@njit(cache=True)
def moved_from(
    reference: Array, here: Array, places: Indices, speeds: Indices, pivot_m: Array, turned_by: float
) -> Array:
    """Deviations of an estimate from a prior's reference, with the map's turn taken out, n.

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


def turned(left: Remainder, layout: Layout, pivot_m: Array, was: Array, now: Array) -> Remainder:
    """A remainder re-expressed at the present places of standing nodes.

    Each deviation from x is taken for one from r in which the part along J x, a turn about the pivot, is one
    along J r, see `turned_along`.

    Args:
        left: of a keyframe and the border; the keyframe's derivatives were taken where it is.
        layout: of the window.
        pivot_m: what the map is turned about, east and north, 2 (m).
        was: r, where the derivatives by the border were taken, flat.
        now: x, the estimate, flat.
    """
    turning = [start for number, start in layout.stands.items() if number not in layout.landmarks]
    starts = np.array(turning, dtype=np.intp)
    at, size = starts[:, None] + np.arange(2), layout.length * layout.width
    change = turned_along(was[size:], now[size:], at, pivot_m)
    if (change == np.eye(2)).all():
        return left
    matrix, vector, own = left.matrix.copy(), left.vector.copy(), layout.width + at
    change_pairs(matrix, vector, own, change)
    return Remainder(0.5 * (matrix + matrix.T), vector)
