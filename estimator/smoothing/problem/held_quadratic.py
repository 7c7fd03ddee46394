"""Readings of walks that are held, as a quadratic cost of the border about an estimate."""

from typing import NamedTuple

import numpy as np

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.graph.robust import Weighted
from estimator.graph.scatter import scatter_rows
from estimator.graph.shared_errors import SharedErrors, eliminate_shared
from estimator.smoothing.chain.chain import Chain


class HeldQuadratic(NamedTuple):
    """A Kirchhoff matrix of the border, where all that moves is held where it is.

    Attributes:
        matrix: s × s.
        vector: in deviations from `reference`, s.
        reference: the border's numbers where the readings were linearised, s.
    """

    matrix: Array
    vector: Array
    reference: Array

    def cost(self, border: Array) -> float:
        """Negative log likelihood of the border's numbers, s, up to a constant."""
        off = border - self.reference
        return float(0.5 * off @ (self.matrix @ off) - self.vector @ off)

    def add(self, chain: Chain, border: Array) -> None:
        """Add it to normal equations at the border's numbers, s."""
        rest = chain.strands[-1]  # it has all of the border
        rest.corner += self.matrix
        rest.corner_gradient += self.vector - self.matrix @ (border - self.reference)


def hold_quadratic(
    chosen: Integers,
    shared: SharedErrors,
    columns: Integers,
    jacobian: Array,
    weighted: Weighted,
    border: Array,
) -> HeldQuadratic:
    """What some of m readings say of the border.

    Args:
        chosen: which.
        shared: which of these share errors.
        columns: where each depends on the border, m × c; −1: on something else, or on nothing.
        jacobian: their derivatives, m × c.
        weighted: how they are weighed.
        border: its numbers where they were linearised, s.
    """
    size = len(border)
    nothing, slab = np.zeros((1, 0, 0)), np.zeros(len(columns), dtype=np.int64)
    matrix, vector = np.zeros((size, size)), np.zeros(size)
    rows = slab, columns, jacobian, weighted.information, weighted.residual
    blocks = nothing, np.zeros((1, 0, size + 1)), matrix, vector
    scatter_rows(chosen, *rows, *blocks)
    if len(shared.own):
        eliminate_shared(shared, *rows, *blocks)
    return HeldQuadratic(matrix, vector, border)
