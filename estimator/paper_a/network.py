"""Paper A's extended relative measurement graph, as a generalized electrical network (sections IV-B to IV-E).

A vertex is a position: of a static node, or of a moving one at a timestamp. An edge is a measurement, and its
covariance P the resistance. Kept are the Kirchhoff matrix L and b, in deviations from the newest estimate x̂:
what the paper's b is (eq. 9), less L x̂.
"""

from collections.abc import Sequence
from typing import Self

import numpy as np

from estimator.graph.dense import Array, Indices, solve
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable

AXES = np.arange(3)
EPSILON_M = 1e-3
"""ε of eq. 19: two nodes on one spot have no direction between them."""


class Network:
    """L x̂ = b (eq. 4), changed by the paper's operations; x̂ is up to date after each of them.

    Attributes:
        graph: L, b and x̂.
    """

    def __init__(self, graph: Kirchhoff | None = None) -> None:
        self.graph = graph or Kirchhoff()

    def place(self, vertex: Variable) -> Array:
        """x̂ of a vertex, 3 (m).

        Raises:
            KeyError: there is no such vertex.
        """
        return self.graph.value(vertex).copy()

    def covariance(self) -> Array:
        """Σ = L⁻¹ (eq. 5), n × n (m²).

        Solved for, column by column: LAPACK's own inverse waits for threads even where the matrix is this
        small, and where those are busy with other work that takes a hundred times as long.
        """
        inverse = solve(self.graph.factorise(), np.eye(self.graph.size))
        return 0.5 * (inverse + inverse.T)

    def add_node(
        self, vertex: Variable, neighbour: Variable | Array, offset_m: Array, sigma_m: Sequence[float]
    ) -> None:
        """AddNode+ (eq. 13), with the measurement that connects it: its position less its neighbour's.

        Args:
            vertex: the new vertex.
            neighbour: a vertex, or the position of an anchor, 3 (m).
            offset_m: ζ, 3 (m).
            sigma_m: √P per axis (m).

        Raises:
            KeyError: the neighbour is not there.
            ValueError: the vertex is there already.
        """
        from_m = self.place(neighbour) if isinstance(neighbour, Variable) else neighbour
        self.graph.add_node(vertex, from_m + offset_m, (np.inf,) * 3)
        self.add_position(vertex, neighbour, offset_m, sigma_m)

    def add_position(
        self, vertex: Variable, neighbour: Variable | Array, offset_m: Array, sigma_m: Sequence[float]
    ) -> None:
        """AddMeasurement of a relative position ζ = x_i − x_j + ω (eq. 11; to an anchor eq. 12).

        Args:
            vertex: i.
            neighbour: j, a vertex or the position of an anchor, 3 (m).
            offset_m: ζ, 3 (m).
            sigma_m: √P per axis (m).
        """
        own = self.graph.rows(vertex).start + AXES
        if isinstance(neighbour, Variable):
            columns = np.column_stack([own, self.graph.rows(neighbour).start + AXES])
            jacobian = np.tile([1.0, -1.0], (3, 1))
            residual = offset_m - (self.place(vertex) - self.place(neighbour))
        else:
            columns, jacobian = own[:, None], np.ones((3, 1))
            residual = offset_m - (self.place(vertex) - neighbour)
        self._add(columns, jacobian, np.array(sigma_m) ** -2, residual)

    def add_range(
        self, vertex: Variable, neighbour: Variable | Array, range_m: float, sigma_m: float
    ) -> None:
        """AddMeasurement+ of a relative range r = ‖x_i − x_j‖ + γ (eq. 18 to 21), linearised at x̂ once.

        Args:
            vertex: i.
            neighbour: j, a vertex or the position of an anchor, 3 (m).
            range_m: r (m).
            sigma_m: √P (m).
        """
        to_m = self.place(neighbour) if isinstance(neighbour, Variable) else neighbour
        h, jacobian = predict_range(self.place(vertex) - to_m)
        columns = self.graph.rows(vertex).start + AXES
        if isinstance(neighbour, Variable):
            columns = np.concatenate([columns, self.graph.rows(neighbour).start + AXES])
            jacobian = np.concatenate([jacobian, -jacobian])  # H = [h_ij, −h_ij], eq. 19
        self._add(columns[None, :], jacobian[None, :], np.array([sigma_m**-2]), np.array([range_m - h]))

    def _add(self, columns: Indices, jacobian: Array, information: Array, residual: Array) -> None:
        self.graph.add_measurements(columns, jacobian, information, residual)
        if residual.any():
            self.graph.rebase(self.graph.solve())

    def move(self, old: Variable, new: Variable, offset_m: Array, sigma_m: Sequence[float]) -> None:
        """A mobile node's next timestamp (section IV-E): add the new state, its edge, delete the old one.

        Args:
            old: the state at the last timestamp.
            new: the state at this one.
            offset_m: ζ that its PDR unit measured between them, 3 (m).
            sigma_m: √P per axis (m).
        """
        self.add_node(new, old, offset_m, sigma_m)
        self.delete_node(old)

    def delete_node(self, vertex: Variable) -> None:
        """DeleteNode (eq. 17): marginalised, so that what it held of its neighbours stays.

        Raises:
            KeyError: there is no such vertex.
        """
        self.graph.delete_nodes([vertex])

    @classmethod
    def of(cls, vertices: Sequence[Variable], storage: tuple[Array, Array, Array]) -> Self:
        """A network of given vertices and storage, as `Kirchhoff.storage` gives it."""
        return cls(Kirchhoff.of(vertices, *storage))


def predict_range(difference_m: Array) -> tuple[float, Array]:
    """H = ‖x_i − x_j‖ and h_ij = (x_i − x_j)ᵀ / (‖x_i − x_j‖ + ε) (eq. 19).

    Args:
        difference_m: x_i − x_j, 3 (m).

    Returns:
        h (m) and its derivative by x_i, 3.
    """
    distance = float(np.sqrt(difference_m @ difference_m))
    return distance, difference_m / (distance + EPSILON_M)
