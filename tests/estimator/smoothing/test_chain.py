"""The bordered chain against the same system solved whole."""

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.smoothing.chain import Chain


def random_chain(length: int, width: int, border: int, seed: int) -> tuple[Chain, Array, Array]:
    """A chain with random positive definite contents, and the same as one matrix and gradient."""
    chance = np.random.default_rng(seed)
    size = length * width + border
    whole = np.zeros((size, size))
    for j in range(length):
        used = np.r_[j * width : min(j + 2, length) * width, length * width : size]
        rows = chance.normal(0.0, 1.0, (2 * len(used), len(used)))
        whole[np.ix_(used, used)] += rows.T @ rows
    gradient = chance.normal(0.0, 1.0, size)
    chain = Chain(length, width, border, 1)
    for j in range(length):
        own = slice(j * width, (j + 1) * width)
        chain.diagonal[j] = whole[own, own]
        chain.border[j] = whole[own, length * width :]
        chain.gradient[j] = gradient[own]
        if j + 1 < length:
            chain.link[j] = whole[(j + 1) * width : (j + 2) * width, own]
    chain.corner[:] = whole[length * width :, length * width :]
    chain.corner_gradient[:] = gradient[length * width :]
    return chain, whole, gradient


@pytest.mark.parametrize(("length", "width", "border"), [(1, 3, 2), (5, 4, 3), (130, 2, 5), (4, 3, 0)])
def test_steps_and_marginal_covariances_equal_those_of_the_whole_matrix(
    length: int, width: int, border: int
) -> None:
    chain, whole, gradient = random_chain(length, width, border, length)
    expected, inverse = np.linalg.solve(whole, gradient), np.linalg.inv(whole)
    steps, fixed = chain.solve()
    assert np.abs(np.concatenate([steps.ravel(), fixed]) - expected).max() < 1e-9
    keyframes, _, lasting = chain.covariances()
    for j in range(length):
        own = slice(j * width, (j + 1) * width)
        assert np.abs(keyframes[j] - inverse[own, own]).max() < 1e-9
    assert np.abs(lasting - inverse[length * width :, length * width :]).max(initial=0.0) < 1e-9
