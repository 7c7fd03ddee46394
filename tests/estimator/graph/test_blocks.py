"""Blocks of 3 × 3 numbers against the same in numpy."""

import numpy as np
import pytest

from estimator.graph.blocks import add_across, add_block, add_both, multiply, multiply_across
from estimator.graph.dense import Array


@pytest.fixture
def blocks() -> tuple[Array, Array]:
    chance = np.random.default_rng(1)
    return chance.normal(size=(3, 3)), chance.normal(size=(3, 3))


def test_blocks_are_multiplied_as_matrices_are(blocks: tuple[Array, Array]) -> None:
    (a, b), found = blocks, np.empty((3, 3))
    multiply(a, b, found)
    np.testing.assert_allclose(found, a @ b, rtol=1e-12)
    multiply_across(a, b, found)
    np.testing.assert_allclose(found, a.T @ b, rtol=1e-12)


def test_a_block_is_added_where_it_belongs_and_nowhere_else(blocks: tuple[Array, Array]) -> None:
    block, found, expected = blocks[0], np.zeros((2, 8, 9)), np.zeros((2, 8, 9))
    add_block(found, 1, 2, 4, block, -1.0)
    add_across(found, 0, 5, 0, block, 1.0)
    expected[1, 2:5, 4:7], expected[0, 5:8, :3] = -block, block.T
    np.testing.assert_array_equal(found, expected)


def test_what_is_added_to_a_symmetric_matrix_leaves_it_symmetric(blocks: tuple[Array, Array]) -> None:
    found = np.zeros((1, 8, 8))
    add_both(found, 0, 0, 4, blocks[0], 2.0)
    np.testing.assert_array_equal(found[0, :3, 4:7], 2.0 * blocks[0])
    np.testing.assert_array_equal(found[0], found[0].T)
