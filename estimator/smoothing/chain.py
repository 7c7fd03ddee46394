"""Normal equations of a chain of keyframes with a border: block tridiagonal, and an arrow to what lasts.

    | D0  E0ᵀ          B0 |
    | E0  D1  E1ᵀ      B1 |        keyframes k, each n numbers: all moving nodes at that epoch
    |     E1  D2  …    B2 |        border, s numbers: static nodes, technologies
    | B0ᵀ B1ᵀ B2ᵀ …    C  |

Elimination along the chain is operation 3 of paper A (eq. 17), keyframe after keyframe; what stays at its
end is the Kirchhoff matrix of the border. Cost grows with the length of the chain, not with its cube.
"""

from typing import NamedTuple

import numpy as np

from estimator.graph.dense import Array, factorise, inverse, mended, solve
from estimator.graph.kernels import eliminate, selected_inverse, substitute


class Remainder(NamedTuple):
    """What the keyframes before one say of it and of the border: a Kirchhoff matrix and its vector.

    Attributes:
        matrix: (n + s) × (n + s), the keyframe first.
        vector: n + s.
    """

    matrix: Array
    vector: Array


class Chain:
    """Normal matrix and gradient of a chain, to be filled and then solved once.

    Attributes:
        diagonal: D, k × n × n.
        link: E, keyframe j + 1 by keyframe j, (k − 1) × blocks × b × b: a node's next step depends on no
            other's, so there are only blocks along its diagonal.
        wide: B and the gradient of the keyframes beside it, k × n × (s + 1).
        corner: C, s × s.
        corner_gradient: of the border, s.
        steps: of the keyframes, k × n, after `solve`.
        fixed: of the border, s, after `solve`.
    """

    def __init__(self, length: int, width: int, border: int, blocks: int) -> None:
        size = width // max(blocks, 1)
        self.diagonal: Array = np.zeros((length, width, width))
        self.link: Array = np.zeros((max(length - 1, 0), blocks, size, size))
        self.wide: Array = np.zeros((length, width, border + 1))
        self.corner: Array = np.zeros((border, border))
        self.corner_gradient: Array = np.zeros(border)
        self._covariance: Array = np.zeros((border, border))
        self._done = 0

    @property
    def border(self) -> Array:
        """B, k × n × s."""
        return self.wide[:, :, :-1]

    @property
    def gradient(self) -> Array:
        """Of the keyframes, k × n."""
        return self.wide[:, :, -1]

    def damp(self, damping: float) -> None:
        """Raise the diagonal by a share of itself (Marquardt): a shorter step, and more along the slope."""
        if damping > 0.0:
            numbers, rest = range(self.diagonal.shape[1]), range(len(self.corner))
            self.diagonal[:, numbers, numbers] *= 1.0 + damping
            self.corner[rest, rest] *= 1.0 + damping

    def remainder(self, keyframe: int) -> Remainder:
        """Eliminate what lies before a keyframe: what is left of it on that keyframe and the border.

        Args:
            keyframe: not before one asked for earlier.

        Raises:
            ValueError: the matrix is not finite, or far from positive definite.
        """
        self._eliminate(keyframe)
        width = self.diagonal.shape[1]
        size = width + len(self.corner)
        matrix = np.zeros((size, size))
        matrix[:width, :width] = self.diagonal[keyframe]
        matrix[:width, width:] = self.border[keyframe]
        matrix[width:, :width] = self.border[keyframe].T
        matrix[width:, width:] = self.corner
        return Remainder(
            0.5 * (matrix + matrix.T), np.concatenate([self.gradient[keyframe], self.corner_gradient])
        )

    def _eliminate(self, until: int, mend: bool = True) -> None:
        if until <= self._done:
            return
        if not np.isfinite(self.diagonal).all():
            raise ValueError("the normal equations of the incident are not finite")
        at, mended_at = self._done, -1
        while at < until:
            at = eliminate(at, until, self.diagonal, self.link, self.wide)
            if at < until:
                if not mend or at == mended_at or not np.isfinite(self.diagonal[at]).all():
                    raise ValueError("the normal equations of the incident are not positive definite")
                self.diagonal[at] = mended(self.diagonal[at])
                mended_at = at
        wide = self.wide[self._done : until].reshape(-1, self.wide.shape[2])
        taken = wide.T @ wide
        self.corner -= taken[:-1, :-1]
        self.corner_gradient -= taken[:-1, -1]
        self._done = until

    def solve(self, mend: bool = True) -> tuple[Array, Array]:
        """The step of all keyframes, k × n, and of the border, s; the arrays are used up.

        Args:
            mend: whether what is not positive definite is for rounding to answer for.

        Raises:
            ValueError: the matrix is not finite, or far from positive definite.
        """
        length, width, _ = self.diagonal.shape
        self._eliminate(length, mend)
        try:
            cholesky = factorise(self.corner)
        except ValueError:
            if not mend:
                raise
            cholesky = factorise(mended(self.corner))
        self._covariance = inverse(cholesky)
        self.fixed = solve(cholesky, self.corner_gradient)
        self.steps: Array = np.zeros((length, width))
        substitute(self.diagonal, self.link, self.wide, self.fixed, self.steps)
        return self.steps, self.fixed

    def response(self, right: Array, corner: Array) -> tuple[Array, Array]:
        """L⁻¹ of several right sides at once, after `solve`: how everything moves where a current is put in.

        Args:
            right: of the keyframes, k × n × c.
            corner: of the border, s × c.
        """
        length, width, count = right.shape
        blocks, size = self.link.shape[1:3]
        y, rest = right.copy(), corner.copy()
        for j in range(length):
            y[j] = self.diagonal[j] @ y[j]
            rest -= self.border[j].T @ y[j]
            if j < length - 1:
                back = (self.diagonal[j].T @ y[j]).reshape(blocks, size, count)
                y[j + 1] -= (self.link[j] @ back).reshape(width, count)
        fixed: Array = self._covariance @ rest
        for j in range(length - 1, -1, -1):
            ahead = y[j] - self.border[j] @ fixed
            if j < length - 1:
                after = self.link[j].transpose(0, 2, 1) @ y[j + 1].reshape(blocks, size, count)
                ahead -= self.diagonal[j] @ after.reshape(width, count)
            y[j] = self.diagonal[j].T @ ahead
        return y, fixed

    def covariances(self) -> tuple[Array, Array, Array]:
        """After `solve`: covariance of each keyframe, k × n × n, with the next one, and of the border, s × s.

        The selected inverse, from the chain's end back to its start: only what the next keyframe and the
        border need is ever formed.
        """
        length, width, _ = self.diagonal.shape
        found, ahead = np.zeros((length, width, width)), np.zeros((max(length - 1, 0), width, width))
        selected_inverse(self.diagonal, self.link, self.wide, self._covariance, found, ahead)
        return found, ahead, self._covariance
