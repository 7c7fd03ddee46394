"""What a heading that is hardly known does to places: it swings them along an arc, not along a line.

A covariance is linear: it lets a place move aside, however far, and keeps its distance from where the heading
was taken up. Turned by a radian, who is shown at the end of a long way would be far off and shown as certain.
So the second moments of the arc take the place of those of its tangent (as a second-order filter does,
Bar-Shalom et al. 2001, 10.3, but in closed form and for any angle).

What is known of a height may go by the heading too, as of who is ranged from above. A sine follows its
angle less than a line does, so this coupling shrinks with the plane: else a height would be known to go with
a place farther than the place can be, which is no covariance.
"""

import numpy as np
from numba import njit

from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.rows.range_curvature import arc_error
from estimator.graph.dense import Array

LEAST_M2 = 1e-6
"""A place is moved by a millimetre at least: no noise at all is no Kirchhoff matrix."""
LOOSE_RAD = 0.1
"""What a heading that is better known does beyond the first order is less than a hundredth of the way."""


def loose_headings(state: FusionState, covariance: Array) -> list[int]:
    """Rows of the headings that are hardly known.

    Args:
        state: the fusion.
        covariance: Σ of its graph, n × n.
    """
    units = (state.graph.starts[node.unit] for node in state.nodes.values() if node.mode == "unit")
    return [row for row in units if covariance[row, row] > LOOSE_RAD**2]


def swung_m2(across: Array, variance: Array) -> Array:
    """What is to be added to covariances of places for headings, m × d × d (m²).

    Of several headings only that counts which moves a place most: they may be known to each other, and a
    tangent that was taken off twice would leave less than nothing.

    Args:
        across: covariance of the places with each heading, m × d × h (m rad): of east and north, and of what
            else is told with them, as their height.
        variance: of the headings, h (rad²).
    """
    if not len(variance):
        return np.zeros((len(across), across.shape[1], across.shape[1]))
    return swung_most_m2(np.ascontiguousarray(across), np.ascontiguousarray(variance))


@njit(cache=True, error_model="numpy")
def swung_most_m2(across: Array, variance: Array) -> Array:
    """`swung_m2` for one heading at least."""
    m, numbers = across.shape[0], across.shape[1]
    own, known = np.empty((m, numbers)), np.empty(m)
    for i in range(m):
        most, farthest = 0, -1.0
        for h in range(len(variance)):
            moved = (across[i, 0, h] ** 2 + across[i, 1, h] ** 2) / variance[h]
            if moved > farthest:
                most, farthest = h, moved
        known[i] = variance[most]
        for r in range(numbers):
            own[i, r] = across[i, r, most]
    return arcs_m2(own, known)


def unbend(state: FusionState, node: NodeState) -> None:
    """Widen a place's covariance in L by what the arc of its heading differs from the tangent.

    Args:
        state: the fusion: its graph is changed.
        node: a node with a unit.
    """
    graph = state.graph
    covariance, row, at = graph.covariance(), graph.starts[node.unit], graph.starts[node.position]
    variance = covariance[row : row + 1, row]
    lever_m = float(np.hypot(*covariance[at : at + 2, row])) / float(variance[0])
    beside_m2 = lever_m**2 * float(arc_error(variance)[0]) + LEAST_M2
    rows, noise = at + np.arange(2)[None, :], np.eye(2)[None] * beside_m2
    graph.advance(rows, graph.reference[rows], np.eye(2)[None], noise)


@njit(cache=True, error_model="numpy")
def arcs_m2(across: Array, variance: Array) -> Array:
    """What arcs' second moments are beyond those of their tangents, m × d × d (m²).

    With ψ ~ N(0, v) a place at the end of a lever l is off by l sin ψ aside and l (cos ψ − 1) along it:
    E sin² = (1 − exp(−2v)) / 2, and E (1 − cos)² is `range_curvature.arc_error`. The lever is what the
    place's covariance with the heading tells: Σ_pψ / v, a quarter turn on.

    A height u is Gaussian with ψ, and cov(u, sin ψ) = exp(−v/2) Σ_uψ (Stein's lemma); with the cosine, which
    is even, it has none. So exp(−v/2) is left of what the tangent gives, Σ_pψ Σ_ψu / v.

    Args:
        across: covariance of each place with a heading, m × d (m rad): of east and north, and of what else is
            told with them.
        variance: v of the heading, m (rad²).
    """
    m, numbers = across.shape
    found, cosine = np.zeros((m, numbers, numbers)), arc_error(variance)
    for i in range(m):
        sine, known = 0.5 * -np.expm1(-2.0 * variance[i]) - variance[i], max(variance[i], 1e-12)
        aside_e, aside_n = across[i, 0] / known, across[i, 1] / known
        found[i, 0, 0] = sine * aside_e * aside_e + cosine[i] * aside_n * aside_n
        found[i, 0, 1] = sine * aside_e * aside_n - cosine[i] * aside_n * aside_e
        found[i, 1, 0] = sine * aside_n * aside_e - cosine[i] * aside_e * aside_n
        found[i, 1, 1] = sine * aside_n * aside_n + cosine[i] * aside_e * aside_e
        lost = np.expm1(-0.5 * variance[i])
        for r in range(2, numbers):
            found[i, 0, r] = found[i, r, 0] = lost * aside_e * across[i, r]
            found[i, 1, r] = found[i, r, 1] = lost * aside_n * across[i, r]
    return found


def arcs_ahead_m2(across: Array, variance: Array, ahead: Array) -> Array:
    """The same of places with the next ones, each turned by its own heading, (k − 1) × 3 × 3 (m²).

    An arc is a place that is moved aside by Σ_pψ / v times sin ψ − ψ, which is known to go with Gaussian
    numbers by exp(−v/2) − 1 times as much as ψ does, and back by as much times cos ψ − 1. Of two angles whose
    covariance is c, E sin sin = exp(−v̄) sinh c and E cos cos = exp(−v̄) cosh c, v̄ the mean of their variances.
    As both places are told of one distribution, so is all that lies between them.

    Args:
        across: covariance of each place with its heading, k × 2 (m rad).
        variance: v of the heading, k (rad²); 0 where a place is to stay on its tangent.
        ahead: covariance of place and heading with the next ones, (k − 1) × 4 × 4.
    """
    aside = np.zeros_like(across)
    np.divide(across, variance[:, None], out=aside, where=variance[:, None] > 0.0)
    back = np.column_stack([aside[:, 1], -aside[:, 0]])
    lost, mean = np.expm1(-0.5 * variance), 0.5 * (variance[:-1] + variance[1:])
    both = np.where((variance[:-1] > 0.0) & (variance[1:] > 0.0), ahead[:, 3, 3], 0.0)
    alike, unlike = 0.5 * np.exp(both - mean), 0.5 * np.exp(-both - mean)
    left = 1.0 + lost[:-1] + lost[1:]
    found = np.zeros((len(ahead), 3, 3))
    found[:, :2, :] += np.einsum("k,ki,kj->kij", lost[:-1], aside[:-1], ahead[:, 3, :3])
    found[:, :, :2] += np.einsum("k,ki,kj->kij", lost[1:], ahead[:, :3, 3], aside[1:])
    found[:, :2, :2] += np.einsum("k,ki,kj->kij", alike - unlike - left * both, aside[:-1], aside[1:])
    found[:, :2, :2] += np.einsum("k,ki,kj->kij", alike + unlike - left, back[:-1], back[1:])
    return found
