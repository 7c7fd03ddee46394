"""Triangular factors against numpy's own."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solve_triangular

from estimator.graph.dense import Array
from estimator.graph.triangular import (
    BLOCK,
    STRIP,
    factorised,
    forward_all,
    halved,
    inverted,
    solved,
)


def positive(chance: np.random.Generator, n: int) -> Array:
    """A positive definite matrix whose rows differ in size as metres and rad/s do."""
    half, scale = chance.normal(0.0, 1.0, (n, 2 * n)), 10.0 ** chance.uniform(-3.0, 3.0, n)
    matrix: Array = half @ half.T * scale[:, None] * scale
    return matrix


@given(st.integers(0, 10_000), st.integers(1, BLOCK + 2 * STRIP))
def test_factor_and_solution_are_those_of_numpy(seed: int, n: int) -> None:
    chance = np.random.default_rng(seed)
    matrix, right = positive(chance, n), chance.normal(0.0, 1.0, n)
    factor, unscale = np.zeros((n, n)), np.empty(n)
    assert factorised(matrix, factor, unscale)
    upper = np.triu(factor) / unscale
    scale = np.sqrt(np.diagonal(matrix))
    assert upper.T @ upper / scale / scale[:, None] == pytest.approx(
        matrix / scale / scale[:, None], abs=1e-12
    )
    answer = solved(factor, unscale, right)
    assert answer * scale == pytest.approx(np.linalg.solve(matrix / scale / scale[:, None], right / scale))


@given(st.integers(0, 10_000), st.integers(0, 2 * BLOCK), st.integers(0, 3))
def test_the_inverse_is_that_of_numpy_and_symmetric(seed: int, n: int, spare: int) -> None:
    matrix = np.full((n + spare, n + spare), 7.0)
    matrix[:n, :n] = positive(np.random.default_rng(seed), n)
    found, scale = np.empty((n, n)), np.sqrt(np.diagonal(matrix)[:n])
    assert inverted(matrix, found)
    usual = np.linalg.inv(matrix[:n, :n] / scale / scale[:, None])
    assert found * scale * scale[:, None] == pytest.approx(usual)
    assert (found == found.T).all()
    assert not inverted(-np.eye(3), np.empty((3, 3)))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0, 0.0])
def test_what_is_not_finite_or_not_positive_definite_is_refused(bad: float) -> None:
    for place in (0, BLOCK + 3):
        matrix = np.eye(BLOCK + 4)
        matrix[place, place] = bad
        assert not factorised(matrix, np.zeros(matrix.shape), np.empty(len(matrix)))
    matrix = np.ones((3, 3))
    matrix[0, 2] = matrix[2, 0] = bad or 2.0
    assert not factorised(matrix, np.zeros((3, 3)), np.empty(3))


def test_what_only_rounding_has_made_indefinite_is_raised_by_as_little_as_lets_it_pass() -> None:
    matrix = np.ones((4, 4)) - 1e-12 * np.eye(4)
    factor, unscale = np.zeros((4, 4)), np.empty(4)
    assert factorised(matrix, factor, unscale)
    upper = np.triu(factor)
    assert np.abs(upper.T @ upper - matrix).max() < 1e-10


@given(st.integers(0, 10_000), st.integers(1, 3 * BLOCK), st.integers(0, 9))
def test_many_right_sides_at_once_are_each_of_them(seed: int, n: int, m: int) -> None:
    chance = np.random.default_rng(seed)
    factor, unscale = np.zeros((n, n)), np.empty(n)
    assert factorised(positive(chance, n), factor, unscale)
    first = np.sort(chance.integers(0, n + 1, m))
    rights = np.where(np.arange(n)[:, None] < first, 0.0, chance.normal(0.0, 1.0, (n, m)))
    each = solve_triangular(factor, rights, trans="T") if m else rights.copy()
    forward_all(factor, rights, first)
    assert rights == pytest.approx(each, rel=1e-9, abs=1e-9 * np.abs(each).max(initial=1.0))


def test_rows_in_another_order_leave_half_way_what_marginalising_leaves() -> None:
    """Longer than a block, and halved within one."""
    n, first = 2 * BLOCK + 5, BLOCK + 7
    half = np.random.default_rng(2).normal(0.0, 1.0, (n, n))
    matrix, order = half @ half.T + np.eye(n), np.random.default_rng(3).permutation(n)
    factor, unscale, left = np.empty((n, n)), np.empty(n), np.empty((n - first, n - first))
    assert halved(matrix, order, first, factor, unscale, left)
    gone, kept = order[:first], order[first:]
    assert left == pytest.approx(np.linalg.inv(np.linalg.inv(matrix)[np.ix_(kept, kept)]))
    upper = np.triu(factor) / unscale
    assert upper.T @ upper == pytest.approx(matrix[np.ix_(order, order)])
    matrix[gone[3], gone[3]] = 0.0
    assert not halved(matrix, order, first, factor, unscale, left)
