"""Covariances of four numbers as upper triangles, and after a reading."""

import numpy as np
import pytest

from estimator.graph.symmetric import full, kalman_update, upper_of


def test_an_upper_triangle_tells_the_whole_matrix() -> None:
    half = np.random.default_rng(0).normal(size=(4, 4))
    matrix = half @ half.T
    assert np.array_equal(full(upper_of(matrix)), np.triu(matrix) + np.triu(matrix, 1).T)


def test_a_reading_tells_what_it_does_in_information_form() -> None:
    chance = np.random.default_rng(1)
    half, slope, x, variance, value = chance.normal(size=(4, 4)), chance.normal(size=4), np.zeros(4), 0.3, 1.7
    before = half @ half.T
    covariance, across = before.copy(), before @ slope
    kalman_update(x, covariance, across, float(slope @ across + variance), value)
    information = np.linalg.inv(before) + np.outer(slope, slope) / variance
    assert covariance == pytest.approx(np.linalg.inv(information))
    assert np.array_equal(covariance, covariance.T)
    assert x == pytest.approx(np.linalg.solve(information, slope * value / variance))
