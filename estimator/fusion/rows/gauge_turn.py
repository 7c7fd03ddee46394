"""Readings between nodes turn no map: what a tick's solution has turned it by nevertheless is turned back.

A solution that is linearised anew at each step holds readings at one estimate against a Kirchhoff matrix of
earlier ones. Where nothing but what was said of headings at the door holds the map, it is turned by what the
two differ by, tick after tick (decision 0027).
"""

import numpy as np
from numba import njit

from estimator.fusion.rows.gauss_newton import Minimum
from estimator.fusion.rows.rows import A_E, B_E, KIND, ONE, linearise
from estimator.graph.dense import Array, Indices
from estimator.graph.gauge import (
    UNIT_M,
    Turning,
    change_pairs,
    held,
    pivot,
    turn_about,
    turn_pairs,
    turned_along,
)

ENDS = ((0, A_E), (3, B_E))
"""Where the place of each end of a reading stands among its numbers, and where it stood a moment ago."""


@njit(cache=True, error_model="numpy", nogil=True)
def undo_turn(
    table: Array,
    columns: Indices,
    found: Minimum,
    before: Array,
    matrix: Array,
    vector: Array,
    reference: Array,
    x: Array,
    changed: Turning,
    base_m: Array,
) -> Array:
    """Turn a tick's solution back, and re-express the prior at its turned places.

    Along a turn g = (J x, 1) of the map the true gradient is that of what was known, gᵣᵀ b − gᵣᵀ L (x − r),
    and of readings that tell where north is. The solution has held the whole at rest by derivatives taken at
    x₀, for which a turn is another one: (gᵣ − g₀)ᵀ (b − L (x − r)) of it is left, and what readings have told
    by where a node stood a moment ago, which turns with its unit.

    Args:
        table: of m readings.
        columns: which numbers each depends on, m × 9.
        found: what they have led to.
        before: x₀, where they were linearised last, n.
        matrix: L of what was known, n × n or larger, changed: said at the new estimate.
        vector: its b, n.
        reference: where it was linearised, r, n.
        x: the estimate, n, changed.
        changed: which of the numbers change with a turn.
        base_m: east and north of the base, 2 (m).

    Returns:
        Derivatives of the readings at the new estimate, that know no turn by where a node stood, m × 9.
    """
    n, jacobian, residual = len(x), np.empty(columns.shape), np.empty(len(table))
    pivot_m = pivot(matrix, reference, changed, base_m)
    was, turned_by = turn_about(reference, changed, pivot_m), 0.0
    ways = np.empty((2, n))
    ways[0], ways[1] = was, x - reference
    known = held(matrix, ways)
    pulled, told = vector - known[1], np.dot(was, known[0])
    slipped = np.dot(was - turn_about(before, changed, pivot_m), pulled)
    linearise(table, columns, x, jacobian, residual)
    turn = turn_about(x, changed, pivot_m)
    for r in range(len(table)):
        leaked, absolute = 0.0, 0.0
        for end in range(len(ENDS)):
            if table[r, KIND] != ONE and columns[r, ENDS[end][0]] >= 0:
                leaked += aside(table[r], jacobian[r], end)
        for i in range(columns.shape[1]):
            if columns[r, i] >= 0:
                absolute += jacobian[r, i] * turn[columns[r, i]]
        slipped += leaked * found.information[r] * found.residual[r]
        told += (absolute + leaked) ** 2 * found.information[r]
    if told > 0.0 and np.isfinite(slipped / told):
        turned_by = slipped / told
    still_m = np.zeros(2)
    turn_pairs(x, changed.places, pivot_m, turned_by)
    turn_pairs(x, changed.speeds, still_m, turned_by)
    x[changed.headings] += turned_by
    nothing = np.zeros(n)
    change_pairs(matrix, nothing, changed.places, turned_along(reference, x, changed.places, pivot_m))
    change_pairs(matrix, nothing, changed.speeds, turned_along(reference, x, changed.speeds, still_m))
    linearise(table, columns, x, jacobian, residual)
    for r in range(len(table)):
        hold_aside(table[r], columns[r], jacobian[r], x, pivot_m)
    return jacobian


@njit(cache=True, error_model="numpy")
def aside(row: Array, own: Array, end: int) -> float:
    """What a turn changes of a reading by where one of its ends stood a moment ago, which turns as well.

    Args:
        row: of the reading.
        own: its derivatives, 9.
        end: which one.
    """
    first, moment = ENDS[end]
    return float(own[first + 1] * row[moment] - own[first] * row[moment + 1])


@njit(cache=True, error_model="numpy")
def hold_aside(row: Array, own_columns: Indices, own: Array, x: Array, pivot_m: Array) -> None:
    """Let the end of a reading that stood elsewhere a moment ago be turned with the map, by its place.

    Args:
        row: of the reading.
        own_columns: which numbers it depends on, 9.
        own: its derivatives, 9, changed.
        x: the estimate, n.
        pivot_m: what the map is turned about, 2 (m).
    """
    for end in range(len(ENDS)):
        first = ENDS[end][0]
        if row[KIND] == ONE or own_columns[first] < 0:
            continue
        way_e = x[own_columns[first]] - pivot_m[0]
        way_n = x[own_columns[first + 1]] - pivot_m[1]
        share = aside(row, own, end) / (way_e**2 + way_n**2 + UNIT_M**2)
        own[first] -= share * way_n
        own[first + 1] += share * way_e
