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

JITTERS = (0.0, 1e-12, 1e-10, 1e-8)


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
        link: E, keyframe j + 1 by keyframe j, (k − 1) × n × n.
        border: B, k × n × s.
        corner: C, s × s.
        gradient: of the keyframes, k × n.
        corner_gradient: of the border, s.
        steps: of the keyframes, k × n, after `solve`.
        fixed: of the border, s, after `solve`.
    """

    def __init__(self, length: int, width: int, border: int) -> None:
        self.diagonal: Array = np.zeros((length, width, width))
        self.link: Array = np.zeros((max(length - 1, 0), width, width))
        self.border: Array = np.zeros((length, width, border))
        self.corner: Array = np.zeros((border, border))
        self.gradient: Array = np.zeros((length, width))
        self.corner_gradient: Array = np.zeros(border)
        self._factors: Array = np.zeros((length, width, width))
        self._covariance: Array = np.zeros((border, border))
        self._done = 0

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

    def _eliminate(self, until: int) -> None:
        if until <= self._done:
            return
        if not np.isfinite(self.diagonal).all():
            raise ValueError("the normal equations of the incident are not finite")
        width = range(self.diagonal.shape[1])
        kept = [a.copy() for a in (self.diagonal, self.link, self.border, self.gradient)]
        for jitter in JITTERS:
            self.diagonal[:, width, width] *= 1.0 + jitter
            try:
                eliminate(
                    self._done,
                    until,
                    self.diagonal,
                    self.link,
                    self.border,
                    self.gradient,
                    self._factors,
                )
            except np.linalg.LinAlgError:
                self.diagonal, self.link, self.border, self.gradient = (a.copy() for a in kept)
                continue
            count = (until - self._done) * self.diagonal.shape[1]
            wide = self.border[self._done : until].reshape(count, len(self.corner))
            self.corner -= wide.T @ wide
            self.corner_gradient -= wide.T @ self.gradient[self._done : until].ravel()
            self._done = until
            return
        raise ValueError("the normal equations of the incident are not positive definite")

    def solve(self) -> tuple[Array, Array]:
        """The step of all keyframes, k × n, and of the border, s; the arrays are used up.

        Raises:
            ValueError: the matrix is not finite, or far from positive definite.
        """
        length, width, _ = self.diagonal.shape
        self._eliminate(length)
        try:
            cholesky = factorise(self.corner)
        except ValueError:
            cholesky = factorise(mended(self.corner))
        self._covariance = inverse(cholesky)
        self.fixed = solve(cholesky, self.corner_gradient)
        self.steps: Array = np.zeros((length, width))
        substitute(self._factors, self.link, self.border, self.gradient, self.fixed, length, self.steps)
        return self.steps, self.fixed

    def response(self, right: Array, corner: Array) -> tuple[Array, Array]:
        """L⁻¹ of several right sides at once, after `solve`: how everything moves where a current is put in.

        Args:
            right: of the keyframes, k × n × c.
            corner: of the border, s × c.
        """
        y, rest = right.copy(), corner.copy()
        for j in range(len(y)):
            y[j] = self._factors[j] @ y[j]
            rest -= self.border[j].T @ y[j]
            if j < len(y) - 1:
                y[j + 1] -= self.link[j] @ y[j]
        fixed: Array = self._covariance @ rest
        for j in range(len(y) - 1, -1, -1):
            back = y[j] - self.border[j] @ fixed
            if j < len(y) - 1:
                back -= self.link[j].T @ y[j + 1]
            y[j] = self._factors[j].T @ back
        return y, fixed

    def covariances(self) -> tuple[Array, Array, Array]:
        """After `solve`: covariance of each keyframe, k × n × n, with the next one, and of the border, s × s.

        The selected inverse, from the chain's end back to its start: only what the next keyframe and the
        border need is ever formed.
        """
        found, ahead = np.zeros_like(self.diagonal), np.zeros_like(self.link)
        selected_inverse(self._factors, self.link, self.border, self._covariance, found, ahead)
        return found, ahead, self._covariance
