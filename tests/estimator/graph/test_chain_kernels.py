"""Elimination along a chain against the whole matrix at once."""

import numpy as np
import pytest

from estimator.graph.chain_kernels import eliminate, take_off
from estimator.graph.dense import Array

BORDER = 4


@pytest.mark.parametrize("walks", [1, 2])
def test_border_is_left_with_the_schur_complement(walks: int) -> None:
    whole, gradient, (diagonal, link, wide) = a_chain(walks)
    length, size = len(diagonal), len(diagonal) * diagonal.shape[1]
    corner, rest = whole[size:, size:].copy(), gradient[size:].copy()

    assert eliminate(0, length, diagonal, link, wide) == length
    eased = take_off(0, 1, wide, corner, rest) + take_off(1, length, wide, corner, rest)

    told = np.linalg.solve(whole[:size, :size], np.column_stack([whole[:size, size:], gradient[:size]]))
    np.testing.assert_allclose(corner, whole[size:, size:] - whole[size:, :size] @ told[:, :-1], rtol=1e-9)
    np.testing.assert_allclose(rest, gradient[size:] - whole[size:, :size] @ told[:, -1], rtol=1e-9)
    assert eased == pytest.approx(gradient[:size] @ told[:, -1])


def a_chain(walks: int) -> tuple[Array, Array, tuple[Array, Array, Array]]:
    """Equations of three keyframes and a border: whole, their right side, and in the blocks of a chain."""
    rng, length, width = np.random.default_rng(walks), 3, 6 * walks
    size = length * width
    root = rng.normal(size=(size + BORDER, 2 * size))
    whole, gradient = root @ root.T, rng.normal(size=size + BORDER)
    for k in range(length):
        for j in range(length):
            rows, columns = slice(width * k, width * (k + 1)), slice(width * j, width * (j + 1))
            if abs(k - j) > 1:
                whole[rows, columns] = 0.0
            elif k != j:
                whole[rows, columns] *= 0.1 * np.kron(np.eye(walks), np.ones((6, 6)))
    own = [slice(width * k, width * (k + 1)) for k in range(length)]
    diagonal = np.array([whole[at, at] for at in own])
    link = np.array([[whole[own[k + 1], own[k]][at, at] for at in own_blocks(walks)] for k in range(2)])
    wide = np.array([np.column_stack([whole[at, size:], gradient[at]]) for at in own])
    return whole, gradient, (diagonal, link, wide)


def own_blocks(walks: int) -> list[slice]:
    """Of the numbers of a keyframe those of each walk."""
    return [slice(6 * walk, 6 * (walk + 1)) for walk in range(walks)]


def test_says_which_keyframe_cannot_be_eliminated() -> None:
    diagonal, link, wide = np.zeros((2, 6, 6)) + np.eye(6), np.zeros((1, 1, 6, 6)), np.zeros((2, 6, 2))
    diagonal[1, 3, 3] = -1.0

    assert eliminate(0, 2, diagonal, link, wide) == 1
