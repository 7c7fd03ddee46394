"""Errors that rows share, against the same chain with each of them as an unknown."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.graph.scatter import scatter_rows
from estimator.graph.shared_errors import eliminate_shared, sharing

LENGTH, WIDTH, BORDER, ROWS, SETS, COLUMNS = 2, 6, 4, 12, 3, 5
SIZE = LENGTH * WIDTH + BORDER


def system(seed: int) -> tuple[Array, Array, Array, Array]:
    """With the errors eliminated where the rows stand, and as unknowns that are eliminated afterwards."""
    rng = np.random.default_rng(seed)
    of = rng.integers(-1, SETS, ROWS)
    slab = np.append(np.where(of >= 0, of % LENGTH, rng.integers(0, LENGTH, ROWS)), np.arange(SETS) % LENGTH)
    columns = np.full((ROWS + SETS, COLUMNS), -1)
    for row in range(ROWS):
        some = int(rng.integers(1, COLUMNS + 1))
        columns[row, :some] = rng.choice(WIDTH + BORDER, some, replace=False)
    jacobian = np.where(columns >= 0, rng.normal(size=columns.shape), 0.0)
    information, residual = rng.uniform(0.5, 2.0, ROWS + SETS), rng.normal(size=ROWS + SETS)
    diagonal, wide = np.zeros((LENGTH, WIDTH, WIDTH)), np.zeros((LENGTH, WIDTH, BORDER + 1))
    corner, gradient = np.zeros((BORDER, BORDER)), np.zeros(BORDER)
    rows = slab, columns, jacobian, information, residual, diagonal, wide, corner, gradient
    scatter_rows(np.arange(ROWS), *rows)
    eliminate_shared(sharing(of, np.arange(ROWS), ROWS), *rows)
    matrix, vector = np.zeros((SIZE, SIZE)), np.zeros(SIZE)
    for k in range(LENGTH):
        own, rest = slice(k * WIDTH, (k + 1) * WIDTH), slice(LENGTH * WIDTH, SIZE)
        matrix[own, own], matrix[own, rest], matrix[rest, own] = (
            diagonal[k],
            wide[k, :, :-1],
            wide[k, :, :-1].T,
        )
        vector[own] = wide[k, :, -1]
    matrix[rest, rest], vector[rest] = corner, gradient
    explicit = np.zeros((ROWS + SETS, SIZE + SETS))
    for row in range(ROWS):
        for c in range(COLUMNS):
            if columns[row, c] >= 0:
                at = columns[row, c] + (
                    slab[row] * WIDTH if columns[row, c] < WIDTH else (LENGTH - 1) * WIDTH
                )
                explicit[row, at] = jacobian[row, c]
        if of[row] >= 0:
            explicit[row, SIZE + of[row]] = 1.0
    explicit[ROWS + np.arange(SETS), SIZE + np.arange(SETS)] = 1.0
    whole, pull = explicit.T * information @ explicit, explicit.T @ (information * residual)
    cross = whole[:SIZE, SIZE:] @ np.linalg.inv(whole[SIZE:, SIZE:])
    return (
        matrix,
        vector,
        whole[:SIZE, :SIZE] - cross @ whole[SIZE:, :SIZE],
        pull[:SIZE] - cross @ pull[SIZE:],
    )


@given(st.integers(0, 10_000))
def test_a_shared_error_is_eliminated_as_any_unknown_is(seed: int) -> None:
    matrix, vector, expected, pull = system(seed)
    assert matrix == pytest.approx(expected, abs=1e-9)
    assert vector == pytest.approx(pull, abs=1e-9)


def test_rows_are_found_set_by_set_in_their_own_order() -> None:
    of = np.array([2, -1, 0, 2, 0, 5, 2])
    found = sharing(of, np.array([0, 1, 2, 3, 4, 6]), 7)
    assert found.rows.tolist() == [2, 4, 0, 3, 6]
    assert found.ends.tolist() == [0, 2, 5]
    assert found.own.tolist() == [7, 9]
