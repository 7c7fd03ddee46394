"""The Kirchhoff state of paper A: information matrix L, vector b, and its three operations.

Numbers of hundreds of metres and of 10⁻⁵ rad/s live in one system, so `b` is kept in deviations from
the reference `x`, the point of linearisation: L (x̂ − x) = b instead of the paper's L x̂ = b (eq. 4).
Moving the reference (`rebase`) changes neither estimate nor covariance.
"""

from collections.abc import Iterable, Sequence
from typing import Self

import numpy as np

from estimator.graph.dense import Array, Cholesky, Indices, factorise, inverse, mended, solve
from estimator.graph.filter_kernels import advance, loosen, scatter
from estimator.graph.gauge import Turning
from estimator.graph.triangular import inverted
from estimator.graph.variable import DIMENSION, Variable, VariableKind

SMALL = 64
"""Up to so many rows plain loops invert L sooner than LAPACK has been called for each part of it."""
LINE = 8
"""Numbers in a line of a processor's cache."""


def roomy(size: int) -> int:
    """A capacity for so many rows and an eighth more, of an odd number of cache lines.

    Columns of a matrix whose rows are a power of two long would fall into a few sets of the cache, and drive
    each other out.
    """
    lines = -(-9 * size // (8 * LINE))
    return LINE * (lines | 1)


class Kirchhoff:
    """Dense L, b and reference x over keyed blocks; storage grows by a share, see `roomy`.

    Attributes:
        starts: first row of each block, in the order of the rows; copies share it, so it is never changed
            but replaced.
        size: rows in use.
    """

    def __init__(self, capacity: int = 32) -> None:
        self.starts: dict[Variable, int] = {}
        self.size = 0
        self._firsts: dict[VariableKind, Indices] = {}
        self._numbers: dict[VariableKind, dict[Variable, int]] = {}
        self._turning: dict[frozenset[str], Turning] = {}
        self._matrix: Array = np.zeros((capacity, capacity))
        self._vector: Array = np.zeros(capacity)
        self._reference: Array = np.zeros(capacity)

    @classmethod
    def of(cls, variables: Iterable[Variable], matrix: Array, vector: Array, reference: Array) -> Self:
        """A graph of given blocks, in order; it owns the arrays, which are as large as its capacity."""
        graph = cls(0)
        for variable in variables:
            graph.starts[variable] = graph.size
            graph.size += DIMENSION[variable.kind]
        graph._matrix = np.ascontiguousarray(matrix)
        graph._vector, graph._reference = vector, reference
        return graph

    def storage(self) -> tuple[Array, Array, Array]:
        """L, b and x with their spare rows, as `of` takes them."""
        return self._matrix, self._vector, self._reference

    @property
    def information(self) -> Array:
        """L, n × n: a view, to be read."""
        return self._matrix[: self.size, : self.size]

    @property
    def vector(self) -> Array:
        """b, n, in deviations from the reference: a view, to be read."""
        return self._vector[: self.size]

    @property
    def reference(self) -> Array:
        """x, n, the point of linearisation: a view, to be read."""
        return self._reference[: self.size]

    @property
    def capacity(self) -> int:
        """Rows that fit without growing."""
        return len(self._vector)

    def __contains__(self, variable: Variable) -> bool:
        return variable in self.starts

    def rows(self, variable: Variable) -> slice:
        """The rows of a block.

        Raises:
            KeyError: there is no such variable.
        """
        start = self.starts[variable]
        return slice(start, start + DIMENSION[variable.kind])

    def value(self, variable: Variable) -> Array:
        """The reference of one block: its estimate, once `solve` and `rebase` have been called."""
        return self._reference[self.rows(variable)]

    def moved(self, row: int, by: float) -> Self:
        """The same with one number counted from elsewhere: it is more than it was by so much."""
        twin = self.copy()
        twin.reference[row] += by
        return twin

    def firsts(self, kind: VariableKind) -> Indices:
        """First row of each block of a kind, in the order of the rows; not to be changed."""
        found = self._firsts.get(kind)
        if found is None:
            rows = [row for variable, row in self.starts.items() if variable.kind == kind]
            found = self._firsts[kind] = np.array(rows, dtype=np.intp)
        return found

    def numbers(self, kind: VariableKind) -> dict[Variable, int]:
        """Which of `firsts` each block of a kind is; not to be changed."""
        found = self._numbers.get(kind)
        if found is None:
            blocks = [variable for variable in self.starts if variable.kind == kind]
            found = self._numbers[kind] = {variable: number for number, variable in enumerate(blocks)}
        return found

    def turning(self, still: frozenset[str] = frozenset()) -> Turning:
        """Which numbers change as the map is turned, places of owners that stand still left out."""
        if still not in self._turning:
            turned = [variable for variable in self.starts if variable.owner not in still]
            rows = ([self.starts[v] for v in turned if v.kind == kind] for kind in ("position", "velocity"))
            places, speeds = (np.array(own, dtype=np.intp)[:, None] + np.arange(2) for own in rows)
            self._turning[still] = Turning(places, speeds, self.firsts("unit"))
        return self._turning[still]

    def copy(self) -> Self:
        """An independent copy."""
        twin = object.__new__(type(self))
        twin.starts, twin.size = self.starts, self.size
        twin._firsts, twin._numbers, twin._turning = self._firsts, self._numbers, self._turning
        twin._matrix, twin._vector = self._matrix.copy(), self._vector.copy()
        twin._reference = self._reference.copy()
        return twin

    def add_node(
        self, variable: Variable, reference: Sequence[float] | Array, sigma: Iterable[float]
    ) -> None:
        """Operation 2 (eq. 13), with a prior of its own on each number.

        Args:
            variable: the new block.
            reference: where it is linearised, and the mean of its prior.
            sigma: standard deviation of each number of the prior; infinite: no prior, edges must follow.

        Raises:
            ValueError: the variable is there already.
        """
        if variable in self.starts:
            raise ValueError(f"{variable} is in the graph already")
        start, end = self.size, self.size + DIMENSION[variable.kind]
        if end > self.capacity:
            self._grow(roomy(end))
        self._matrix[start:end, :end] = 0.0
        self._matrix[:start, start:end] = 0.0
        self._vector[start:end] = 0.0
        self._reference[start:end] = reference
        self._matrix[range(start, end), range(start, end)] = [s**-2 for s in sigma]
        self.starts = {**self.starts, variable: start}
        self.size = end
        self._firsts, self._numbers, self._turning = {}, {}, {}

    def _grow(self, capacity: int) -> None:
        n = self.size
        matrix, vector, reference = np.zeros((capacity, capacity)), np.zeros(capacity), np.zeros(capacity)
        matrix[:n, :n], vector[:n], reference[:n] = self.information, self.vector, self.reference
        self._matrix, self._vector, self._reference = matrix, vector, reference

    def add_measurements(
        self, columns: Indices, jacobian: Array, information: Array, residual: Array
    ) -> None:
        """Operation 1 (eq. 11, 12, 18 to 21) for m scalar measurements at once.

        L += Hᵀ P⁻¹ H and b += Hᵀ P⁻¹ (z − h(x)), which is eq. 18 in deviations from x. An edge to an anchor
        (eq. 12) has no column for the anchor.

        Args:
            columns: which numbers each measurement depends on, m × k; unused ones may be 0.
            jacobian: derivatives of h by them at the reference, m × k; 0 for unused ones.
            information: P⁻¹ of each, m.
            residual: z − h(x) of each, m.
        """
        scatter(self._matrix, self._vector, columns, jacobian, information, residual)

    def delete_nodes(self, variables: Sequence[Variable]) -> None:
        """Operation 3 (eq. 17): marginalise blocks; what they held of their neighbours stays as edges.

        Raises:
            KeyError: a variable is not there.
        """
        if not variables:
            return
        gone = np.concatenate([np.arange(*self.rows(v).indices(self.size)) for v in variables])
        kept = np.setdiff1d(np.arange(self.size), gone)
        left, rest = marginalised(self.information, self.vector, gone, kept)
        reference = self.reference[kept]
        self.size = n = len(kept)
        self._matrix[:n, :n] = left
        self._vector[:n], self._reference[:n] = rest, reference
        gone_set = set(variables)
        start = 0
        remaining = [v for v in self.starts if v not in gone_set]
        self.starts = {}
        self._firsts, self._numbers, self._turning = {}, {}, {}
        for v in remaining:
            self.starts[v] = start
            start += DIMENSION[v.kind]

    def advance(self, rows: Indices, moved: Array, transition: Array, noise: Array) -> None:
        """Mobile nodes (section IV-E): add the new state, its edge, delete the old one, in closed form.

        For an edge x' = f(x) + w with an invertible Jacobian F, operations 2, 1 and 3 together give
        L' = A − A E (Q⁻¹ + Eᵀ A E)⁻¹ Eᵀ A with A = F⁻ᵀ L F⁻¹ and E the rows that move. It needs no extra
        rows, and rounds less than the three one by one, because a small Q only makes a small correction.

        Args:
            rows: the rows of g moving groups of d numbers, g × d.
            moved: f(x) of each, g × d: the new reference.
            transition: F of each, g × d × d.
            noise: covariance Q of w of each, g × d × d, positive definite.
        """
        done, kernel = advance(self._matrix, self._vector, self.size, rows, transition, noise)
        flat = rows.ravel()
        if not done:
            self.loosen(flat, kernel)
        self._reference[flat] = moved.ravel()

    def loosen(self, rows: Indices, kernel: Array) -> None:
        """The second half of `advance` where rounding has left Q⁻¹ + Eᵀ A E indefinite.

        Args:
            rows: those that move, k.
            kernel: what is indefinite, k × k.
        """
        loosen(self._matrix, self._vector, self.size, rows, mended(kernel))

    def mend(self) -> None:
        """Make L positive definite where rounding has left it indefinite."""
        self._matrix[: self.size, : self.size] = mended(self.information)

    def factorise(self) -> Cholesky:
        """The Cholesky factor of L, or of L mended where rounding has left it indefinite."""
        try:
            return factorise(self.information)
        except ValueError:
            return factorise(mended(self.information))

    def rebase(self, reference: Array) -> None:
        """Move the point of linearisation: b changes so that the estimate stays.

        Args:
            reference: the new x, n.
        """
        self._vector[: self.size] -= self.information @ (reference - self.reference)
        self._reference[: self.size] = reference

    def solve(self) -> Array:
        """The estimate x̂ (eq. 4), n."""
        return self.reference + solve(self.factorise(), self.vector)

    def covariance(self) -> Array:
        """Σ = L⁻¹ (eq. 5), n × n; the block of a node is its effective resistance to the base."""
        if self.size <= SMALL:
            found = np.empty((self.size, self.size))
            if inverted(self._matrix, found):
                return found
        return inverse(self.factorise())


def marginalised(matrix: Array, vector: Array, gone: Indices, kept: Indices) -> tuple[Array, Array]:
    """Eq. 17: what a system says of the rows `kept` when those `gone` are summed out, exactly symmetric.

    Args:
        matrix: L, n × n.
        vector: b, n.
        gone: rows to be left out.
        kept: rows to be kept, in the order in which they are wanted.
    """
    if len(gone) == 0:
        left = matrix[kept[:, None], kept]
        return 0.5 * (left + left.T), vector[kept]
    coupling = matrix[gone[:, None], kept]
    block = matrix[gone[:, None], gone]
    try:
        cholesky = factorise(block)
    except ValueError:
        cholesky = factorise(mended(block))
    through = solve(cholesky, np.column_stack([coupling, vector[gone]]))
    left = matrix[kept[:, None], kept] - coupling.T @ through[:, :-1]
    return 0.5 * (left + left.T), vector[kept] - coupling.T @ through[:, -1]
