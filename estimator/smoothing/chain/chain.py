"""Normal equations of a chain of keyframes with a border: block tridiagonal, and an arrow to what lasts.

    | D0  E0ᵀ          B0 |
    | E0  D1  E1ᵀ      B1 |        keyframes k, each n numbers: all moving nodes at that epoch
    |     E1  D2  …    B2 |        border, s numbers: static nodes, technologies
    | B0ᵀ B1ᵀ B2ᵀ …    C  |

Walks that no direct reading couples meet in the border only. Each group of them is eliminated by itself, as
narrow as it is (`Strand`); C is the sum of what the groups say of the border.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from estimator.graph.assembly import add_part
from estimator.graph.dense import Array, factorise, inverse, log_determinant, mended, solve
from estimator.graph.parallel import in_parallel
from estimator.smoothing.chain.groups import Group
from estimator.smoothing.chain.strand import Strand, strands_of
from estimator.smoothing.keyframes.walks import STATES

NOTHING = factorise(np.zeros((0, 0)))
LARGE = 500_000
"""From so many numbers on strands are worked on at once, if somebody waits: smaller ones are done before
threads have begun."""

T = TypeVar("T")


class Remainder(NamedTuple):
    """What the keyframes before one say of it and of the border: a Kirchhoff matrix and its vector.

    Attributes:
        matrix: (n + s) × (n + s), the keyframe first.
        vector: n + s.
    """

    matrix: Array
    vector: Array


class Explained(NamedTuple):
    """What the unknowns take up of new ones, whose right sides are R.

    Attributes:
        information: Rᵀ L⁻¹ R, c × c.
        score: Rᵀ L⁻¹ g, c, by what is left of the gradient g: nil where the solution is at rest.
    """

    information: Array
    score: Array


class Chain:
    """Normal matrix and gradient of a chain, to be filled and then solved once.

    Args:
        length: k.
        width: n.
        groups: of its walks; the last one has none and all of the border.
        waited: somebody waits for it: strands may be worked on at once. Windows of a live incident, which are
            solved every few seconds, stay on one core.

    Attributes:
        strands: the chain of each group; of the last one there is only the border.
        width: n.
        lasting: s.
        promised: after `solve`: half the product of the gradient and the step, what a parabola gains by it.
    """

    def __init__(self, length: int, width: int, groups: Sequence[Group], waited: bool = False) -> None:
        self.strands = strands_of(length, groups)
        self.width = width
        self.lasting = len(groups[-1].lasting)
        self.promised = 0.0
        self._length = length
        self._cholesky = NOTHING
        self._left: Array | None = None
        self._at_once = waited and sum(strand.wide.size for strand in self.strands) >= LARGE

    def each(self, work: Callable[..., T], *own: Iterable[object]) -> list[T]:
        """What some work on each of its strands gives, in their order; at once where it is worth it.

        Args:
            work: takes a strand, and of each of `own` what is the strand's; changes that strand only.
            own: as many of each as there are strands.
        """
        if self._at_once:
            return in_parallel(work, self.strands, *own)
        return [work(*row) for row in zip(self.strands, *own, strict=True)]

    def damp(self, damping: float) -> None:
        """Raise the diagonal by a share of itself (Marquardt): a shorter step, and more along the slope."""
        if damping > 0.0:
            self.each(lambda strand: strand.damp(damping))

    def slope(self) -> Array:
        """The gradient, flat: keyframes, then the border."""
        keyframes = np.zeros((self._length, self.width))
        for strand in self.strands:
            keyframes[:, strand.group.columns] = strand.gradient
        return np.concatenate([keyframes.ravel(), self._corner()[1]])

    def _corner(self) -> tuple[Array, Array]:
        """C, s × s, and the border's gradient, s."""
        *moving, rest = self.strands  # the last one has all of the border
        corner, gradient = rest.corner.copy(), rest.corner_gradient.copy()
        for strand in moving:
            add_part(strand.group.lasting, strand.corner, strand.corner_gradient, corner, gradient)
        return corner, gradient

    def remainder(self, keyframe: int) -> Remainder:
        """Eliminate what lies before a keyframe: what is left of it on that keyframe and the border.

        Args:
            keyframe: not before one asked for earlier.

        Raises:
            ValueError: the matrix is not finite, or far from positive definite; or the chain was reduced.
        """
        size = self.width + self.lasting
        matrix, vector = np.zeros((size, size)), np.zeros(size)
        for strand in self.strands:
            strand.eliminate(keyframe)
            own, rest = strand.group.columns, self.width + strand.group.lasting
            matrix[own[:, None], own] = strand.diagonal[keyframe]
            matrix[own[:, None], rest] = strand.border[keyframe]
            matrix[rest[:, None], own] = strand.border[keyframe].T
            vector[own] = strand.gradient[keyframe]
        matrix[self.width :, self.width :], vector[self.width :] = self._corner()
        return Remainder(0.5 * (matrix + matrix.T), vector)

    def reduce(self, mend: bool = True) -> Array:
        """Eliminate all keyframes and factorise what is left of the border: all that `covariances` needs.

        It is done once, however many ask for it.

        Args:
            mend: whether what is not positive definite is for rounding to answer for.

        Returns:
            What is left of the border's gradient, s.

        Raises:
            ValueError: the matrix is not finite, or far from positive definite.
        """
        if self._left is not None:
            return self._left
        self.each(lambda strand: strand.eliminate(self._length, mend))
        corner, gradient = self._corner()
        try:
            self._cholesky = factorise(corner)
        except ValueError:
            if not mend:
                raise
            self._cholesky = factorise(mended(corner))
        self._left = gradient
        return gradient

    @property
    def reduced(self) -> bool:
        """Whether all its keyframes have been eliminated: of none of them any remainder is left."""
        return self._left is not None

    def solve(self, mend: bool = True) -> tuple[Array, Array]:
        """The step of all keyframes, k × n, and of the border, s; the arrays are used up.

        Args:
            mend: whether what is not positive definite is for rounding to answer for.

        Raises:
            ValueError: the matrix is not finite, or far from positive definite.
        """
        gradient = self.reduce(mend)
        fixed = solve(self._cholesky, gradient)
        decrement = sum(strand.newton_decrement for strand in self.strands)
        self.promised = 0.5 * (float(gradient @ fixed) + decrement)
        steps = np.zeros((self._length, self.width))
        found = self.each(lambda strand: strand.substitute(fixed[strand.group.lasting]))
        for strand, own in zip(self.strands, found, strict=True):
            steps[:, strand.group.columns] = own
        return steps, fixed

    def response(self, right: Array, corner: Array) -> tuple[Array, Array]:
        """L⁻¹ of several right sides at once, after `reduce`: how everything moves where a current is put in.

        Args:
            right: of the keyframes, k × n × c.
            corner: of the border, s × c.
        """
        rest = corner.copy()

        def carry(strand: Strand) -> tuple[Array, Array]:
            y, own = right[:, strand.group.columns], np.zeros((len(strand.group.lasting), corner.shape[1]))
            strand.carry(y, own)
            return y, own

        carried = self.each(carry)
        for strand, (_, own) in zip(self.strands, carried, strict=True):
            rest[strand.group.lasting] += own
        fixed: Array = inverse(self._cholesky) @ rest
        found = np.zeros(right.shape)
        self.each(lambda strand, there: strand.carry_back(there[0], fixed[strand.group.lasting]), carried)
        for strand, (y, _) in zip(self.strands, carried, strict=True):
            found[:, strand.group.columns] = y
        return found, fixed

    def explained(self, right: Array, corner: Array) -> Explained:
        """What the unknowns take up of new ones, whose right sides are R, after `reduce`.

        Args:
            right: of the keyframes, k × n × c.
            corner: of the border, s × c.
        """
        rest, found = corner.copy(), np.zeros((corner.shape[1], corner.shape[1]))
        pulled, (_, gradient) = np.zeros(corner.shape[1]), self._corner()
        for strand in self.strands:
            y, own = right[:, strand.group.columns], np.zeros((len(strand.group.lasting), corner.shape[1]))
            strand.carry(y, own)
            rest[strand.group.lasting] += own
            flat = y.reshape(-1, corner.shape[1])
            found += flat.T @ flat
            pulled += flat.T @ strand.gradient.ravel()
        across = solve(self._cholesky, rest)
        return Explained(found + rest.T @ across, pulled + across.T @ gradient)

    def log_determinants(self) -> tuple[Array, float]:
        """After `reduce` or `solve`: what each walk adds to log |L|, and what the border does."""
        *moving, _ = self.strands  # of the last one there is only the border
        found = np.zeros(sum(len(strand.group.walks) for strand in moving))
        for strand in moving:
            found[strand.group.walks] = strand.log_determinants()
        return found, log_determinant(self._cholesky)

    def border_covariance(self) -> Array:
        """After `reduce` or `solve`: covariance of the border, s × s."""
        return inverse(self._cholesky)

    def covariances(self) -> tuple[Array, Array, Array]:
        """After `reduce` or `solve`: covariances of the walks and of the border.

        Returns:
            Of each walk at each keyframe, k × walks × b × b; of each with itself at the next keyframe,
            (k − 1) × walks × b × b; of the border, s × s.
        """
        border = self.border_covariance()
        walks = sum(len(strand.group.walks) for strand in self.strands)
        # Where nobody walks there are none, of the size that those who read them expect.
        size = self.width // walks if walks else STATES
        found = np.zeros((self._length, walks, size, size))
        ahead = np.zeros((max(self._length - 1, 0), walks, size, size))
        groups = [strand.group for strand in self.strands]
        corners = [border[group.lasting[:, None], group.lasting] for group in groups]
        own = self.each(Strand.covariances, corners)
        for group, (of_each, with_next) in zip(groups, own, strict=True):
            if len(group.walks):
                found[:, group.walks], ahead[:, group.walks] = of_each, with_next
        return found, ahead, border
