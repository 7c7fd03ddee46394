"""Normal equations of a chain of keyframes with a border: block tridiagonal, and an arrow to what lasts.

    | D0  E0ᵀ          B0 |
    | E0  D1  E1ᵀ      B1 |        keyframes k, each n numbers: all moving nodes at that second
    |     E1  D2  …    B2 |        border, s numbers: static nodes, technologies
    | B0ᵀ B1ᵀ B2ᵀ …    C  |

Elimination along the chain is operation 3 of paper A (eq. 17), keyframe after keyframe; what stays at its
end is the Kirchhoff matrix of the border. Cost grows with the length of the chain, not with its cube.
"""

import numpy as np
from scipy.linalg import solve_triangular
from scipy.linalg.lapack import dpotrf

from estimator.graph.dense import Array, factorise, inverse, mended, solve

CHUNK = 64


class Chain:
    """Normal matrix and gradient of a chain, to be filled and then solved once.

    Attributes:
        diagonal: D, k × n × n.
        link: E, keyframe j + 1 by keyframe j, (k − 1) × n × n.
        border: B, k × n × s.
        corner: C, s × s.
        gradient: of the keyframes, k × n.
        corner_gradient: of the border, s.
    """

    def __init__(self, length: int, width: int, border: int) -> None:
        self.diagonal: Array = np.zeros((length, width, width))
        self.link: Array = np.zeros((max(length - 1, 0), width, width))
        self.border: Array = np.zeros((length, width, border))
        self.corner: Array = np.zeros((border, border))
        self.gradient: Array = np.zeros((length, width))
        self.corner_gradient: Array = np.zeros(border)
        self._factors: Array = np.zeros((length, width, width))
        self._border_covariance: Array = np.zeros((border, border))

    def solve(self) -> tuple[Array, Array]:
        """The step of all keyframes, k × n, and of the border, s; the arrays are used up.

        Raises:
            ValueError: the matrix is not finite.
        """
        length, width, _ = self.diagonal.shape
        for start in range(0, length, CHUNK):
            end = min(start + CHUNK, length)
            for j in range(start, end):
                self._eliminate(j)
            wide = self.border[start:end].reshape((end - start) * width, len(self.corner))
            self.corner -= wide.T @ wide
            self.corner_gradient -= wide.T @ self.gradient[start:end].ravel()
        try:
            cholesky = factorise(self.corner)
        except ValueError:
            cholesky = factorise(mended(self.corner))
        self._border_covariance = inverse(cholesky)
        fixed = solve(cholesky, self.corner_gradient)
        steps = np.zeros((length, width))
        for j in range(length - 1, -1, -1):
            right = self.gradient[j] - self.border[j] @ fixed
            if j < length - 1:
                right -= self.link[j].T @ steps[j + 1]
            steps[j] = solve_triangular(self._factors[j], right, trans=1, lower=True, check_finite=False)
        return steps, fixed

    def _eliminate(self, j: int) -> None:
        """Factorise D, leave W = C⁻¹ [Eᵀ B g] in the place of E, B and g, and carry it on."""
        if j > 0:
            before = self.link[j - 1]
            self.diagonal[j] -= before @ before.T
            self.border[j] -= before @ self.border[j - 1]
            self.gradient[j] -= before @ self.gradient[j - 1]
        factor, failed = dpotrf(self.diagonal[j], lower=1, clean=1)
        if failed != 0:
            if not np.isfinite(self.diagonal[j]).all():
                raise ValueError("the normal equations of the incident are not finite")
            factor = np.linalg.cholesky(mended(self.diagonal[j]))
        self._factors[j] = factor
        last = j == len(self.diagonal) - 1
        parts = [self.border[j], self.gradient[j][:, None]]
        if not last:
            parts.append(self.link[j].T)
        half = solve_triangular(factor, np.concatenate(parts, axis=1), lower=True, check_finite=False)
        s = self.border.shape[2]
        self.border[j], self.gradient[j] = half[:, :s], half[:, s]
        if not last:
            self.link[j] = half[:, s + 1 :].T

    def covariances(self) -> tuple[Array, Array]:
        """Marginal covariance of each keyframe, k × n × n, and of the border, s × s; after `solve`.

        The selected inverse, from the chain's end back to its start: only what the next keyframe and the
        border need is ever formed.
        """
        length, width, _ = self.diagonal.shape
        found = np.zeros((length, width, width))
        border = self._border_covariance
        ahead, ahead_border = np.zeros((width, width)), np.zeros((width, border.shape[0]))
        for j in range(length - 1, -1, -1):
            parts = [self.border[j]] if j == length - 1 else [self.border[j], self.link[j].T]
            gain = solve_triangular(
                self._factors[j], np.concatenate(parts, axis=1), trans=1, lower=True, check_finite=False
            )
            to_border, to_next = gain[:, : border.shape[0]], gain[:, border.shape[0] :]
            with_border = -to_border @ border
            own = solve_triangular(self._factors[j], np.eye(width), lower=True, check_finite=False)
            covariance = own.T @ own - with_border @ to_border.T
            if j < length - 1:
                with_border -= to_next @ ahead_border
                crossed = to_border @ ahead_border.T @ to_next.T
                covariance += to_next @ ahead @ to_next.T + crossed + crossed.T
            found[j] = 0.5 * (covariance + covariance.T)
            ahead, ahead_border = found[j], with_border
        return found, border
