"""The compiled loops of the Kirchhoff state against numpy's own."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.filter_kernels import carry, invert, loosen, scatter
from estimator.graph.triangular import STRIP


def test_measurements_are_added_where_their_columns_point() -> None:
    chance = np.random.default_rng(2)
    columns = np.array([[0, 4, 0], [2, 3, 5]])
    jacobian = chance.normal(0.0, 1.0, (2, 3))
    jacobian[0, 2] = 0.0
    information, residual = np.array([2.0, 0.5]), np.array([1.0, -3.0])
    matrix, vector = np.zeros((6, 6)), np.zeros(6)
    scatter(matrix, vector, columns, jacobian, information, residual)
    whole = np.zeros((2, 6))
    np.add.at(whole, (np.arange(2)[:, None], columns), jacobian)
    assert matrix == pytest.approx(whole.T @ np.diag(information) @ whole)
    assert vector == pytest.approx(whole.T @ (information * residual))


@given(st.integers(0, 10_000), st.integers(1, 4) | st.just(STRIP // 6 + 1))
def test_moving_groups_is_moving_the_covariance_and_the_mean(seed: int, groups: int) -> None:
    """Σ' = F Σ Fᵀ + Q, in storage with spare rows that stay as they are."""
    chance = np.random.default_rng(seed)
    n, spare = 6 * groups + 5, 3
    rows = chance.permutation(n)[: 6 * groups].reshape(groups, 6)
    matrix, vector = np.full((n + spare, n + spare), 7.0), np.full(n + spare, 7.0)
    half = chance.normal(0.0, 1.0, (n, 2 * n))
    matrix[:n, :n], vector[:n] = half @ half.T, chance.normal(0.0, 1.0, n)
    transition = np.eye(6) + chance.normal(0.0, 0.1, (groups, 6, 6))
    noise = np.eye(6) * chance.uniform(0.01, 1.0, (groups, 1, 6))
    whole, added = np.eye(n), np.zeros((n, n))
    for i, own in enumerate(rows):
        whole[np.ix_(own, own)], added[np.ix_(own, own)] = transition[i], noise[i]
    mean, covariance = np.linalg.solve(matrix[:n, :n], vector[:n]), np.linalg.inv(matrix[:n, :n])
    kernel = carry(matrix, vector, n, rows, transition, noise)
    assert loosen(matrix, vector, n, rows.ravel(), kernel)
    assert np.linalg.inv(matrix[:n, :n]) == pytest.approx(whole @ covariance @ whole.T + added)
    assert np.linalg.solve(matrix[:n, :n], vector[:n]) == pytest.approx(whole @ mean)
    assert (matrix[:n, :n] == matrix[:n, :n].T).all()
    assert (matrix[n:] == 7.0).all()
    assert (vector[n:] == 7.0).all()


@given(st.integers(0, 10_000), st.integers(1, 8))
def test_a_small_matrix_is_inverted_wherever_its_zeros_are(seed: int, n: int) -> None:
    chance = np.random.default_rng(seed)
    matrix = (np.eye(n) + chance.normal(0.0, 0.1, (n, n)))[chance.permutation(n)]
    matrix[np.abs(matrix) < 0.1] = 0.0
    found = np.empty((n, n))
    invert(matrix, found)
    assert found == pytest.approx(np.linalg.inv(matrix))


def test_a_kernel_that_is_not_positive_definite_changes_nothing() -> None:
    matrix, vector = np.eye(4), np.ones(4)
    assert not loosen(matrix, vector, 4, np.arange(2), -np.eye(2))
    assert (matrix == np.eye(4)).all()
    assert (vector == 1.0).all()
