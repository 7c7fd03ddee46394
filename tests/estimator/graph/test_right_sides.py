"""Right sides carried through a chain against the whole matrix at once."""

import numpy as np
import pytest

from estimator.graph.chain_kernels import eliminate, take_off
from estimator.graph.right_sides import carry, carry_back
from tests.estimator.graph.test_chain_kernels import BORDER, a_chain

RIGHT_SIDES = 5


@pytest.mark.parametrize("walks", [1, 2])
def test_right_sides_carried_forth_and_back_are_solved(walks: int) -> None:
    whole, _, (diagonal, link, wide) = a_chain(walks)
    length, width, _ = diagonal.shape
    size = length * width
    right = np.random.default_rng(3).normal(size=(size + BORDER, RIGHT_SIDES))
    corner, y, rest = whole[size:, size:].copy(), right[:size].reshape(length, width, -1), right[size:].copy()
    told = np.linalg.solve(whole, right)

    eliminate(0, length, diagonal, link, wide)
    take_off(0, length, wide, corner, np.zeros(BORDER))
    carry(diagonal, link, wide, y, rest)
    fixed = np.linalg.solve(corner, rest).astype(np.float64)
    carry_back(diagonal, link, wide, y, fixed)

    np.testing.assert_allclose(fixed, told[size:], rtol=1e-9)
    np.testing.assert_allclose(y.reshape(size, RIGHT_SIDES), told[:size], rtol=1e-9, atol=1e-12)
