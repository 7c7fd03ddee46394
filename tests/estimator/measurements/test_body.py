"""How far ahead of its bearer another radio lies."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.measurements.body import NEAR_M, ahead_of

angles_rad = st.floats(-math.pi, math.pi)


@given(angles_rad, angles_rad, st.floats(20.0, 200.0))
def test_far_away_it_is_the_cosine_of_the_angle_between_where_he_faces_and_where_it_lies(
    faced_rad: float, way_rad: float, far_m: float
) -> None:
    way_m = far_m * math.cos(way_rad), far_m * math.sin(way_rad)
    found = ahead_of(math.cos(faced_rad), math.sin(faced_rad), *way_m)
    assert found == pytest.approx(math.cos(faced_rad - way_rad), abs=0.5 * (NEAR_M / far_m) ** 2)


@given(angles_rad)
def test_what_lies_where_he_stands_is_neither_ahead_nor_behind(faced_rad: float) -> None:
    assert ahead_of(math.cos(faced_rad), math.sin(faced_rad), 0.0, 0.0) == 0.0
