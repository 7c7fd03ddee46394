"""What residuals say of a bias that each radio may have, compiled."""

import numpy as np
from numba import njit

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array


@njit(cache=True)
def scores_by_half(
    carried: Integers, weight: Array, residual: Array, radios: int
) -> tuple[Integers, Array, Array]:
    """Score and information of each radio's bias, in either half of its ranges by information.

    Args:
        carried: radios at both ends of each, m × 2, in order of epoch; −1: one that is not asked.
        weight: P⁻¹, m.
        residual: z − h(x), m (m).
        radios: how many there are.

    Returns:
        Which half it is to each end, m × 2; score and information of each radio in both, radios × 2.
    """
    m = len(carried)
    half = np.zeros((m, 2), dtype=np.int64)
    score, told, total = np.zeros((radios, 2)), np.zeros((radios, 2)), np.zeros(radios)
    for r in range(m):
        for end in range(2):
            if carried[r, end] >= 0:
                total[carried[r, end]] += weight[r]
    for r in range(m):
        for end in range(2):
            radio = carried[r, end]
            if radio < 0:
                continue
            late = 1 if told[radio, 0] > 0.5 * total[radio] else 0
            half[r, end] = late
            score[radio, late] += weight[r] * residual[r]
            told[radio, late] += weight[r]
    return half, score, told


@njit(cache=True)
def cross_information(
    right: Array,
    width: int,
    size: int,
    columns: Integers,
    slab: Integers,
    jacobian: Array,
    weight: Array,
    half: Integers,
    place: Integers,
) -> None:
    """Cross information Σ w J between biases and the other unknowns of a window, by ranges.

    Args:
        right: n × 2 c, of each of c radios in both halves; changed.
        width: columns of a keyframe.
        size: of all of them.
        columns: what each of m readings depends on, m × c.
        slab: its keyframe, m.
        jacobian: derivatives, m × c.
        weight: P⁻¹, m.
        half: see `scores_by_half`.
        place: which of the radios are at both ends, m × 2; −1: none.
    """
    for r in range(len(columns)):
        for end in range(2):
            if place[r, end] < 0:
                continue
            to = 2 * place[r, end] + half[r, end]
            for i in range(columns.shape[1]):
                column = columns[r, i]
                if column >= 0:
                    at = slab[r] * width + column if column < width else size + column - width
                    right[at, to] += weight[r] * jacobian[r, i]


PROBES = 32
"""Right sides by which a trace is told: a power of two. Of 300 numbers it is then right to 2 %."""
SPREAD = 2654435761
"""Knuth's multiplicative hash: successive numbers get signs as if by chance."""


@njit(cache=True)
def probe(
    right: Array,
    width: int,
    size: int,
    columns: Integers,
    slab: Integers,
    jacobian: Array,
    root: Array,
) -> None:
    """Right sides Jᵀ √w s for a trace; the signs s of as many successive rows as probes are orthogonal.

    Args:
        right: n × `PROBES`, changed.
        width: columns of a keyframe.
        size: of all of them.
        columns: what each of m readings depends on, m × c.
        slab: its keyframe, m.
        jacobian: derivatives, m × c.
        root: √w of each, m.
    """
    for r in range(len(columns)):
        turned = ((r // PROBES) * SPREAD >> 16) & 1
        for k in range(PROBES):
            both, odd = r & k & (PROBES - 1), turned
            while both:
                odd ^= both & 1
                both >>= 1
            sign = root[r] * (1.0 - 2.0 * odd)
            for i in range(columns.shape[1]):
                column = columns[r, i]
                if column >= 0:
                    at = slab[r] * width + column if column < width else size + column - width
                    right[at, k] += sign * jacobian[r, i]


@njit(cache=True)
def lag_one_correlation(link: Integers, residual: Array) -> float:
    """Correlation of successive residuals of links, 0 to 1.

    Args:
        link: of each, m, in order of epoch; −1: none.
        residual: m.
    """
    newest = np.full(max(link.max(), 0) + 1, np.nan)
    products, squares = 0.0, 0.0
    for r in range(len(link)):
        if link[r] < 0:
            continue
        before = newest[link[r]]
        if not np.isnan(before):
            products += before * residual[r]
            squares += 0.5 * (before * before + residual[r] * residual[r])
        newest[link[r]] = residual[r]
    return min(max(products / squares, 0.0), 1.0) if squares > 0.0 else 0.0
