"""Rows of readings added to a chain, against the same sums of whole matrices."""

import numpy as np
import pytest

from estimator.graph.scatter import ROW, scatter_rows

LENGTH, WIDTH, BORDER = 3, 12, 9
FIRST, SECOND = list(range(6)), list(range(6, 12))
NOBODY, NOTHING = [-1] * 6, [-1] * 3
STANDS, RADIO = [*range(12, 15), *NOTHING], [18, 19, 20]
LOSS, NO_LOSS = [17], [-1]


@pytest.mark.parametrize(
    "columns",
    [
        FIRST + STANDS + RADIO,
        STANDS + SECOND + RADIO,
        FIRST + NOBODY + RADIO,
        SECOND + STANDS + NOTHING,
        FIRST + NOBODY + NOTHING,
        FIRST + SECOND + RADIO,
        STANDS + NOBODY + RADIO,
        FIRST + NOBODY + [18, 16, -1],
        FIRST + NOBODY + [18, -1, -1],
        FIRST + STANDS + RADIO + NO_LOSS,
        FIRST + STANDS + RADIO + LOSS,
        FIRST + SECOND + RADIO + LOSS,
        [7],
    ],
)
@pytest.mark.parametrize("turned", [True, False])
def test_rows_are_added_where_their_columns_say(columns: list[int], turned: bool) -> None:
    rng, rows = np.random.default_rng(len(columns) + turned), 5
    at = np.tile(np.array(columns), (rows, 1))
    slab, chosen = rng.integers(0, LENGTH, rows), np.array([0, 2, 3])
    jacobian = np.where(at >= 0, rng.normal(size=at.shape), 0.0)
    if len(columns) >= ROW and not turned:
        jacobian[:, 3:6] = jacobian[:, 9:12] = 0.0
    information, residual = rng.uniform(0.5, 2.0, rows), rng.normal(size=rows)
    diagonal, wide = np.zeros((LENGTH, WIDTH, WIDTH)), np.zeros((LENGTH, WIDTH, BORDER + 1))
    corner, gradient = np.zeros((BORDER, BORDER)), np.zeros(BORDER)
    scatter_rows(chosen, slab, at, jacobian, information, residual, diagonal, wide, corner, gradient)
    for keyframe in range(LENGTH):
        dense = np.zeros((rows, WIDTH + BORDER))
        for r in chosen[slab[chosen] == keyframe]:
            used = at[r] >= 0
            dense[r, at[r, used]] = jacobian[r, used]
        matrix, vector = dense.T * information @ dense, dense.T @ (information * residual)
        assert np.allclose(diagonal[keyframe], matrix[:WIDTH, :WIDTH])
        assert np.allclose(wide[keyframe, :, :-1], matrix[:WIDTH, WIDTH:])
        assert np.allclose(wide[keyframe, :, -1], vector[:WIDTH])
        corner -= matrix[WIDTH:, WIDTH:]
        gradient -= vector[WIDTH:]
    assert np.allclose(corner, 0.0)
    assert np.allclose(gradient, 0.0)
