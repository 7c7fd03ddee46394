"""Errors that some rows of a chain share: one number for each set of rows, eliminated where they stand."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array


class SharedErrors(NamedTuple):
    """Rows that share errors, set by set.

    Attributes:
        rows: the rows of the first set, of the second and so on.
        ends: where each set begins in them, and where the last one ends, sets + 1.
        own: the row that tells of each set's error beforehand, as a reading of nil, sets.
    """

    rows: Integers
    ends: Integers
    own: Integers


def sharing(of: Integers, chosen: Integers, first: int) -> SharedErrors:
    """The sets among some rows.

    Args:
        of: which set each of m rows is in, m; −1: none.
        chosen: the rows that are looked at, ascending.
        first: the row that tells of the first set's error beforehand; those of the others follow.
    """
    among = chosen[of[chosen] >= 0]
    rows = among[np.argsort(of[among], kind="stable")]
    sets, begins = np.unique(of[rows], return_index=True)
    return SharedErrors(rows, np.append(begins, len(rows)), first + sets)


@njit(cache=True, nogil=True)
def eliminate_shared(
    shared: SharedErrors,
    slab: Integers,
    columns: Integers,
    jacobian: Array,
    information: Array,
    residual: Array,
    diagonal: Array,
    wide: Array,
    corner: Array,
    corner_gradient: Array,
) -> None:
    """Take off a chain what its rows do not tell because they share errors.

    With u = Hᵀ P⁻¹ 1 and s = 1ᵀ P⁻¹ 1 of a set's rows, its own row included, the error's elimination
    (Schur complement, paper A, eq. 17) leaves Hᵀ P⁻¹ H − u uᵀ / s, and Hᵀ P⁻¹ r − u (1ᵀ P⁻¹ r) / s.

    Args:
        shared: the sets; the rows of one have one keyframe.
        slab: see `scatter_rows`, with all that follow.
        columns: the same.
        jacobian: the same.
        information: the same.
        residual: the same.
        diagonal: the same.
        wide: the same.
        corner: the same.
        corner_gradient: the same.
    """
    width, last = diagonal.shape[1], len(corner_gradient)
    pulled, is_touched = np.zeros(width + last), np.zeros(width + last, dtype=np.bool_)
    touched = np.empty(width + last, dtype=np.int64)
    for one in range(len(shared.own)):
        own, count = shared.own[one], 0
        weight, pull = information[own], information[own] * residual[own]
        for at in range(shared.ends[one], shared.ends[one + 1]):
            row = shared.rows[at]
            weight += information[row]
            pull += information[row] * residual[row]
            for c in range(columns.shape[1]):
                column = columns[row, c]
                if column >= 0 and jacobian[row, c] != 0.0:
                    if not is_touched[column]:
                        touched[count], is_touched[column] = column, True
                        count += 1
                    pulled[column] += information[row] * jacobian[row, c]
        # In order, so that the sums are the same whatever order the rows have named their columns in.
        touched[:count].sort()
        for i in range(count if weight > 0.0 else 0):
            a = touched[i]
            share = pulled[a] / weight
            k = slab[shared.rows[shared.ends[one]]]
            if a < width:
                wide[k, a, last] -= share * pull
            else:
                corner_gradient[a - width] -= share * pull
            for j in range(count):
                b = touched[j]
                if a < width and b < width:
                    diagonal[k, a, b] -= share * pulled[b]
                elif a < width:
                    wide[k, a, b - width] -= share * pulled[b]
                elif b >= width:
                    corner[a - width, b - width] -= share * pulled[b]
        for i in range(count):
            pulled[touched[i]], is_touched[touched[i]] = 0.0, False
