"""Has the inner loops compiled before the first incident needs them: numba takes seconds, once a machine."""

import numpy as np

from estimator.graph.kernels import (
    eliminate,
    scatter_rows,
    selected_inverse,
    strongest,
    substitute,
)


def warm_up() -> None:
    """Call each compiled function once on the smallest chain there is."""
    k, n, s = 2, 1, 1
    diagonal, link, border = np.ones((k, n, n)), np.zeros((k - 1, n, n)), np.zeros((k, n, s))
    corner, gradient, rest = np.ones((s, s)), np.zeros((k, n)), np.zeros(s)
    slab, columns = np.zeros(1, dtype=np.int64), np.zeros((1, 14), dtype=np.int64)
    one = np.ones(1)
    scatter_rows(slab, columns, np.zeros((1, 14)), one, one, diagonal, border, corner, gradient, rest)
    factors = np.zeros((k, n, n))
    eliminate(0, k, diagonal, link, border, gradient, factors)
    substitute(factors, link, border, gradient, rest, k, np.zeros((k, n)))
    selected_inverse(factors, link, border, corner, np.zeros((k, n, n)), np.zeros((k - 1, n, n)))
    strongest(one, one, one, 1.0, 1)


if __name__ == "__main__":
    warm_up()
