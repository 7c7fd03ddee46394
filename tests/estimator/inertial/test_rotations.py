"""Rotations against scipy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from estimator.inertial.rotations import level, turn_by, turned_about

angles = st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(np.array)
tiny = st.tuples(*[st.floats(-1e-7, 1e-7)] * 3).map(np.array)


@given(angles, st.one_of(angles, tiny))
def test_an_attitude_is_turned_as_rodrigues_says(before: np.ndarray, turn: np.ndarray) -> None:
    attitude, found = Rotation.from_rotvec(before).as_matrix(), np.empty((3, 3))
    by = Rotation.from_rotvec(turn).as_matrix()
    turn_by(turn, attitude, found)
    np.testing.assert_allclose(found, attitude @ by, atol=1e-12)
    np.testing.assert_allclose(turned_about(turn, attitude), by @ attitude, atol=1e-12)


@given(angles, st.floats(-3.0, 3.0))
def test_what_is_felt_at_rest_points_up_and_the_x_axis_faces_its_heading(
    mounted: np.ndarray, heading_rad: float
) -> None:
    up = Rotation.from_rotvec(mounted).apply([0.0, 0.0, 9.8])
    attitude = level(up, 0, heading_rad)
    np.testing.assert_allclose(attitude @ attitude.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(attitude) == pytest.approx(1.0)
    np.testing.assert_allclose(attitude @ up, [0.0, 0.0, 9.8], atol=1e-9)
    if np.hypot(*attitude[:2, 0]) > 0.01:
        faced = np.arctan2(attitude[1, 0], attitude[0, 0])
        assert np.cos(faced - heading_rad) == pytest.approx(1.0, abs=1e-9)


def test_an_x_axis_that_points_up_leaves_the_heading_to_the_y_axis() -> None:
    attitude = level(np.array([9.8, 0.0, 0.0]), 0, 0.3)
    assert np.arctan2(attitude[1, 1], attitude[0, 1]) == pytest.approx(0.3 + 0.5 * np.pi)


def test_a_y_axis_tells_the_same_a_quarter_turn_on() -> None:
    up = np.array([3.0, 0.0, 9.3])
    np.testing.assert_allclose(level(up, 1, 0.3 + 0.5 * np.pi), level(up, 0, 0.3), atol=1e-12)
    upright = np.array([0.0, 9.8, 0.0])
    np.testing.assert_allclose(level(upright, 1, 0.3 + 0.5 * np.pi), level(upright, 0, 0.3), atol=1e-12)
