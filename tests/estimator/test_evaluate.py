"""Errors and honesty of tracks with known answers."""

import numpy as np
import pytest

from estimator.evaluate import errors, full_covariance, rigid_fit

CHANCE = np.random.default_rng(7)


def test_a_track_that_is_only_turned_and_shifted_has_no_aligned_error() -> None:
    truth = CHANCE.normal(0.0, 10.0, (50, 3))
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    found = errors(truth @ turn.T + np.array([3.0, 1.0, 0.0]), truth, None, 100.0)
    assert found.aligned_rmse_m == pytest.approx(0.0, abs=1e-9)
    assert found.rmse_m > 1.0
    assert np.isnan(found.coverage)


def test_a_mirrored_track_is_not_aligned_away() -> None:
    points = CHANCE.normal(0.0, 10.0, (50, 2))
    rotation, _ = rigid_fit(points * [1.0, -1.0], points)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


def test_honest_covariances_cover_95_percent_and_have_a_nees_of_one() -> None:
    truth = np.zeros((20_000, 3))
    upper = np.array([4.0, 1.0, 0.0, 1.0, 0.0, 1.0])
    matrix = full_covariance(upper[None])[0]
    drawn = CHANCE.multivariate_normal(np.zeros(3), matrix, 20_000)
    found = errors(drawn, truth, np.broadcast_to(matrix, (20_000, 3, 3)), 100.0)
    assert found.coverage == pytest.approx(0.95, abs=0.01)
    assert found.nees == pytest.approx(1.0, abs=0.05)


def test_who_is_metres_off_and_sure_of_it_is_shown_elsewhere() -> None:
    off_m = np.array([[1.9, 0.0, 0.0], [2.1, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 8.0, 0.0]])
    sigma_m = np.array([0.1, 0.5, 2.0, 2.0])
    covariance = np.eye(3) * sigma_m[:, None, None] ** 2
    found = errors(off_m, np.zeros((4, 3)), covariance, 100.0)
    assert found.misleading == 0.5  # 1.9 m is near enough, and 6 m within three of two metres


def test_tracks_of_different_length_are_refused() -> None:
    with pytest.raises(ValueError, match="cannot compare"):
        errors(np.zeros((2, 3)), np.zeros((3, 3)), None, 1.0)
