"""What a heading that is hardly known does to places: it swings them along an arc, not along a line.

A covariance is linear: it lets a place move aside, however far, and keeps its distance from where the heading
was taken up. Turned by a radian, who is shown at the end of a long way would be far off and shown as certain.
So the second moments of the arc take the place of those of its tangent (as a second-order filter does,
Bar-Shalom et al. 2001, 10.3, but in closed form and for any angle).
"""

import numpy as np
from numba import njit

from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.rows.arcs import fallen_back
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
    """What is to be added to covariances of places for headings, m × 2 × 2 (m²).

    Of several headings only that counts which moves a place most: they may be known to each other, and a
    tangent that was taken off twice would leave less than nothing.

    Args:
        across: covariance of the places with each heading, m × 2 × h (m rad).
        variance: of the headings, h (rad²).
    """
    if not len(variance):
        return np.zeros((len(across), 2, 2))
    return swung_most_m2(np.ascontiguousarray(across), np.ascontiguousarray(variance))


@njit(cache=True, error_model="numpy")
def swung_most_m2(across: Array, variance: Array) -> Array:
    """`swung_m2` for one heading at least."""
    m = len(across)
    own, known = np.empty((m, 2)), np.empty(m)
    for i in range(m):
        most, farthest = 0, -1.0
        for h in range(len(variance)):
            moved = (across[i, 0, h] ** 2 + across[i, 1, h] ** 2) / variance[h]
            if moved > farthest:
                most, farthest = h, moved
        own[i, 0], own[i, 1], known[i] = across[i, 0, most], across[i, 1, most], variance[most]
    return arcs_m2(own, own, known)


def unbend(state: FusionState, node: NodeState) -> None:
    """Let a place be anywhere about the tangent along which its heading moves it, as far off as its arc is.

    Args:
        state: the fusion: its graph is changed.
        node: a node with a unit.
    """
    graph = state.graph
    covariance, row, at = graph.covariance(), graph.starts[node.unit], graph.starts[node.position]
    variance = covariance[row : row + 1, row]
    lever_m = float(np.hypot(*covariance[at : at + 2, row])) / float(variance[0])
    beside_m2 = lever_m**2 * float(fallen_back(variance)[0]) + LEAST_M2
    rows, noise = at + np.arange(2)[None, :], np.eye(2)[None] * beside_m2
    graph.advance(rows, graph.reference[rows], np.eye(2)[None], noise)


def arc_m2(one: Array, other: Array, variance: Array) -> Array:
    """What an arc's second moments are beyond those of its tangent, … × 2 × 2 (m²).

    With ψ ~ N(0, v) a place at the end of a lever l is off by l sin ψ aside and l (cos ψ − 1) along it:
    E sin² = (1 − exp(−2v)) / 2, and E (1 − cos)² is `arcs.fallen_back`. The lever is what the place's
    covariance with the heading tells: Σ_pψ / v, a quarter turn on.

    Args:
        one: covariance of a place with the heading, … × 2 (m rad).
        other: of another place, or of the same, … × 2.
        variance: v of the heading, … (rad²).
    """
    flat = (np.ascontiguousarray(one).reshape(-1, 2), np.ascontiguousarray(other).reshape(-1, 2))
    return arcs_m2(*flat, np.ascontiguousarray(variance).ravel()).reshape(*variance.shape, 2, 2)


@njit(cache=True, error_model="numpy")
def arcs_m2(one: Array, other: Array, variance: Array) -> Array:
    """`arc_m2` of m places, m × 2 × 2."""
    found, cosine = np.empty((len(variance), 2, 2)), fallen_back(variance)
    for i in range(len(variance)):
        sine, known = 0.5 * -np.expm1(-2.0 * variance[i]) - variance[i], max(variance[i], 1e-12)
        aside_e, aside_n = one[i, 0] / known, one[i, 1] / known
        other_e, other_n = other[i, 0] / known, other[i, 1] / known
        found[i, 0, 0] = sine * aside_e * other_e + cosine[i] * aside_n * other_n
        found[i, 0, 1] = sine * aside_e * other_n - cosine[i] * aside_n * other_e
        found[i, 1, 0] = sine * aside_n * other_e - cosine[i] * aside_e * other_n
        found[i, 1, 1] = sine * aside_n * other_n + cosine[i] * aside_e * other_e
    return found
