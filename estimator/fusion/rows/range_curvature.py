"""What a line of sight that may be turned does to a range: who is so far from a radio is on an arc about it.

A linear state knows him on the arc's tangent. Where he may be far aside, as seen from the radio, tangents at
two places cross, and a range held against what is known from the one before would tell where on the arc he
is, which nobody measured. So to a range's own noise is added by how much the arc and its tangent differ over
what the state leaves open, with the readings held already: the residual of a statistical linearisation about
the posterior (García-Fernández, Svensson, Morelande, Särkkä 2015, eq. 11), in closed form. A window needs
none: it takes the derivatives of all its readings at one estimate.
"""

import numpy as np
from numba import njit

from estimator.fusion.rows.rows import A_E, B_E, VALUE, A, B
from estimator.graph.dense import Array, Indices

NOWHERE_M = 1e-6
"""From so near a line of sight has no direction."""
SMALL_RAD2 = 1e-7
"""Of a smaller variance rounding leaves nothing of 1 − cos, or something negative."""


@njit(cache=True, error_model="numpy")
def sight_turns(
    table: Array, columns: Indices, jacobian: Array, residual: Array, aside: Array, levers_m: Array
) -> None:
    """How lines of sight turn on the ground plane, by the numbers that ranges depend on.

    Args:
        table: of m ranges, see `rows.Row`.
        columns: which numbers each depends on, m × 9.
        jacobian: its derivatives by them, m × 9.
        residual: z − h(x) of each, m.
        aside: takes the derivatives of its line's direction, m × 9 (rad/m).
        levers_m: takes how far aside a turn leads, as seen along the line, m (m/rad).
    """
    aside[:], levers_m[:] = 0.0, 0.0
    for r in range(len(table)):
        first = 0 if columns[r, 0] >= 0 else 3
        east, north = jacobian[r, first], jacobian[r, first + 1]
        lever_m = (table[r, VALUE] - residual[r]) * (east**2 + north**2)
        if lever_m > NOWHERE_M:
            levers_m[r] = lever_m
            aside[r, 0], aside[r, 1] = -north / lever_m, east / lever_m
            aside[r, 3], aside[r, 4] = north / lever_m, -east / lever_m


@njit(cache=True, error_model="numpy")
def arc_error(variance: Array) -> Array:
    """E (1 − cos ψ)² with ψ ~ N(0, v): by what share of its lever an arc is off its tangent, squared.

    3/2 − 2 exp(−v/2) + exp(−2v) / 2; of small variances it is 3/4 v².

    Args:
        variance: v, m (rad²).
    """
    found = np.empty(len(variance))
    for i in range(len(variance)):
        found[i] = arc_share(variance[i])
    return found


@njit(cache=True, error_model="numpy")
def arc_share(variance: float) -> float:
    """`arc_error` of one angle."""
    if variance < SMALL_RAD2:
        return 0.75 * variance**2
    return float(1.5 - 2.0 * np.exp(-0.5 * variance) + 0.5 * np.exp(-2.0 * variance))


@njit(cache=True, error_model="numpy")
def ranges_alike(table: Array) -> Array:
    """How many ranges of a tick have each one's line of sight, m: what its arc is off by is the same for all.

    Args:
        table: of m ranges, see `rows.Row`.
    """
    m = len(table)
    counts, ends = np.ones(m), table[:, A] + table[:, B]
    for r in range(m):
        for s in range(r):
            # Few of them can have the same ends.
            if ends[r] == ends[s] and same_line(table[r], table[s]):
                counts[r] += 1.0
                counts[s] += 1.0
    return counts


@njit(cache=True, error_model="numpy")
def same_line(one: Array, other: Array) -> bool:
    """Whether two ranges are between the same ends, whichever of them measured."""
    crossed = one[A] != other[A]
    first, second = (B, A) if crossed else (A, B)
    if one[A] != other[first] or one[B] != other[second]:
        return False
    # An end that is fixed has no block, but a place.
    for end, own, its in ((A, A_E, B_E if crossed else A_E), (B, B_E, A_E if crossed else B_E)):
        if one[end] < 0.0 and (one[own] != other[its] or one[own + 1] != other[its + 1]):
            return False
    return True
