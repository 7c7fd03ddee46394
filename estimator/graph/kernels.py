"""Inner loops, compiled."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.graph.dense import Array

Integers = NDArray[np.int64]


@njit(cache=True)
def scatter_rows(
    slab: Integers,
    columns: Integers,
    jacobian: Array,
    information: Array,
    residual: Array,
    diagonal: Array,
    border: Array,
    corner: Array,
    gradient: Array,
    corner_gradient: Array,
) -> None:
    """Add HᵀP⁻¹H and HᵀP⁻¹r of m readings to a chain.

    Args:
        slab: keyframe that each reading belongs to, m; any where it touches none.
        columns: which numbers it depends on, m × k: those of the keyframe first (below its width), those of
            the border after them; −1: unused.
        jacobian: derivatives, m × k.
        information: P⁻¹, m.
        residual: z − h(x), m.
        diagonal: k × n × n, changed.
        border: k × n × s, changed.
        corner: s × s, changed.
        gradient: k × n, changed.
        corner_gradient: s, changed.
    """
    width = diagonal.shape[1]
    m, k = columns.shape
    for r in range(m):
        w = information[r]
        j = slab[r]
        for a in range(k):
            ca = columns[r, a]
            ja = jacobian[r, a]
            if ca < 0 or ja == 0.0:
                continue
            pulled = ja * w
            if ca < width:
                gradient[j, ca] += pulled * residual[r]
            else:
                corner_gradient[ca - width] += pulled * residual[r]
            for b in range(k):
                cb = columns[r, b]
                jb = jacobian[r, b]
                if cb < 0 or jb == 0.0:
                    continue
                if ca < width:
                    if cb < width:
                        diagonal[j, ca, cb] += pulled * jb
                    else:
                        border[j, ca, cb - width] += pulled * jb
                elif cb >= width:
                    corner[ca - width, cb - width] += pulled * jb


@njit(cache=True)
def eliminate(
    first: int,
    last: int,
    diagonal: Array,
    link: Array,
    border: Array,
    gradient: Array,
    factors: Array,
) -> None:
    """Operation 3 of paper A (eq. 17) for keyframes `first` to `last` − 1, one after the other.

    What it needs to go back stays in the place of what it used: W = C⁻¹ [Eᵀ B g], and C⁻¹ in `factors`. What
    the border loses by it, Wᵀ W, is left to be taken off at once.

    Args:
        first: keyframe to begin with.
        last: keyframe to stop before.
        diagonal: D, k × n × n.
        link: E, keyframe j + 1 by keyframe j, (k − 1) × n × n; left as W of the same shape, transposed.
        border: B, k × n × s.
        gradient: g, k × n.
        factors: takes C⁻¹, k × n × n.
    """
    length, width = gradient.shape
    for j in range(first, last):
        lower = np.linalg.cholesky(diagonal[j])
        inverse = np.zeros((width, width))
        for c in range(width):
            inverse[c, c] = 1.0 / lower[c, c]
            for r in range(c + 1, width):
                total = 0.0
                for i in range(c, r):
                    total += lower[r, i] * inverse[i, c]
                inverse[r, c] = -total / lower[r, r]
        factors[j] = inverse
        wide = np.dot(inverse, border[j])
        pull = np.dot(inverse, gradient[j])
        border[j] = wide
        gradient[j] = pull
        if j < length - 1:
            half = np.dot(inverse, link[j].T.copy())
            back = half.T.copy()
            diagonal[j + 1] -= np.dot(back, half)
            border[j + 1] -= np.dot(back, wide)
            gradient[j + 1] -= np.dot(back, pull)
            link[j] = back


@njit(cache=True)
def substitute(
    factors: Array, link: Array, border: Array, gradient: Array, fixed: Array, last: int, steps: Array
) -> None:
    """Steps of the keyframes before `last`, from its end back; `steps` (k × n) holds those from `last` on."""
    length = len(gradient)
    for j in range(last - 1, -1, -1):
        right = gradient[j] - np.dot(border[j], fixed)
        if j < length - 1:
            right -= np.dot(link[j].T, steps[j + 1])
        steps[j] = np.dot(factors[j].T, right)


@njit(cache=True)
def selected_inverse(
    factors: Array, link: Array, border: Array, border_covariance: Array, found: Array, ahead: Array
) -> None:
    """Covariance of each keyframe (`found`, k × n × n) and with the next (`ahead`, (k − 1) × n × n)."""
    length, width, lasting = border.shape
    next_border = np.zeros((width, lasting))
    for j in range(length - 1, -1, -1):
        back = factors[j].T.copy()
        to_border = -np.dot(back, border[j])
        with_border = np.dot(to_border, border_covariance)
        covariance = np.dot(back, factors[j])
        if j < length - 1:
            to_next = -np.dot(back, link[j].T.copy())
            with_next = np.dot(to_next, found[j + 1]) + np.dot(to_border, next_border.T.copy())
            with_border += np.dot(to_next, next_border)
            covariance += np.dot(with_next, to_next.T.copy())
            ahead[j] = with_next
        covariance += np.dot(with_border, to_border.T.copy())
        found[j] = 0.5 * (covariance + covariance.T)
        next_border = with_border


@njit(cache=True)
def strongest(t: Array, group: Array, value: Array, span: float, least: int) -> Array:
    """Which values are the largest of their group within `span` before and after, m (1 or 0).

    Args:
        t: ascending within each group, m.
        group: groups one after the other, m.
        value: m.
        span: in the unit of `t`.
        least: there must be so many values within the span.
    """
    count = len(t)
    found = np.zeros(count)
    for i in range(count):
        best, near = True, 1
        for step in (-1, 1):
            j = i + step
            while 0 <= j < count and group[j] == group[i] and abs(t[j] - t[i]) <= span:
                near += 1
                if value[j] > value[i]:
                    best = False
                j += step
        found[i] = 1.0 if best and near >= least else 0.0
    return found
