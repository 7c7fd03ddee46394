"""A walk by itself against the whole matrix at once, and against the same walk among others."""

import numpy as np
import pytest

from estimator.graph.chain_kernels import eliminate, selected_inverse
from estimator.graph.dense import Array

LENGTH, SIZE = 4, 6


@pytest.mark.parametrize("border", [0, 1, 2, 7, 13])
def test_a_walk_by_itself_is_as_unsure_as_the_whole_matrix_tells(border: int) -> None:
    diagonal, link, wide, rest = a_walk(border)
    whole = inverse(the_whole(diagonal, link, wide, rest))

    found, ahead = unsure(diagonal, link, wide, whole[LENGTH * SIZE :, LENGTH * SIZE :])

    own = [slice(SIZE * k, SIZE * (k + 1)) for k in range(LENGTH)]
    np.testing.assert_allclose(found[:, 0], [whole[at, at] for at in own], rtol=1e-9, atol=1e-12)
    with_next = [whole[own[k], own[k + 1]] for k in range(LENGTH - 1)]
    np.testing.assert_allclose(ahead[:, 0], with_next, rtol=1e-9, atol=1e-12)
    assert np.array_equal(found, found.swapaxes(2, 3))


@pytest.mark.parametrize("border", [2, 7, 13])
def test_a_walk_is_as_unsure_by_itself_as_beside_one_that_tells_nothing_of_it(border: int) -> None:
    diagonal, link, wide, rest = a_walk(border)
    covariance = inverse(rest)

    alone, alone_ahead = unsure(diagonal, link, wide, covariance)

    twice = np.kron(np.eye(2), np.ones((SIZE, SIZE)))
    both = unsure(
        np.tile(diagonal, (1, 2, 2)) * twice,
        np.repeat(link, 2, axis=1),
        np.concatenate([wide, np.zeros_like(wide)], axis=1),
        covariance,
    )
    np.testing.assert_allclose(alone[:, 0], both[0][:, 0], rtol=1e-13)
    np.testing.assert_allclose(alone_ahead[:, 0], both[1][:, 0], rtol=1e-13)


def inverse(matrix: Array) -> Array:
    """A⁻¹ by LAPACK."""
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


def a_walk(border: int) -> tuple[Array, Array, Array, Array]:
    """Equations of four keyframes: D, E, B with its gradient; and of the border, C."""
    rng = np.random.default_rng(border)
    root = rng.normal(size=(LENGTH, SIZE, 2 * SIZE))
    diagonal = root @ root.swapaxes(1, 2) + 4.0 * np.eye(SIZE)
    link = 0.3 * rng.normal(size=(LENGTH - 1, 1, SIZE, SIZE))
    wide = 0.3 * rng.normal(size=(LENGTH, SIZE, border + 1))
    return diagonal, link, wide, 20.0 * np.eye(border)


def the_whole(diagonal: Array, link: Array, wide: Array, rest: Array) -> Array:
    """The same equations as one matrix."""
    found = np.zeros((LENGTH * SIZE + len(rest), LENGTH * SIZE + len(rest)))
    for k in range(LENGTH):
        own, after = slice(SIZE * k, SIZE * (k + 1)), slice(SIZE * (k + 1), SIZE * (k + 2))
        found[own, own], found[own, LENGTH * SIZE :] = diagonal[k], wide[k, :, :-1]
        found[LENGTH * SIZE :, own] = wide[k, :, :-1].T
        if k < LENGTH - 1:
            found[after, own], found[own, after] = link[k, 0], link[k, 0].T
    found[LENGTH * SIZE :, LENGTH * SIZE :] = rest
    return found


def unsure(diagonal: Array, link: Array, wide: Array, border_covariance: Array) -> tuple[Array, Array]:
    """Covariances of each walk at each keyframe, and with itself at the next one."""
    blocks = link.shape[1]
    taken = diagonal.copy(), link.copy(), wide.copy()
    assert eliminate(0, LENGTH, *taken) == LENGTH
    found, ahead = np.zeros((LENGTH, blocks, SIZE, SIZE)), np.zeros((LENGTH - 1, blocks, SIZE, SIZE))
    selected_inverse(*taken, np.ascontiguousarray(border_covariance), found, ahead)
    return found, ahead
