"""Air pressure to height, and WGS84 to local metres, against known values."""

import pytest

from estimator.measurements.altitude import height_above
from estimator.measurements.position import east_north_up


def test_a_hectopascal_is_about_eight_and_a_half_metres_at_sea_level() -> None:
    assert height_above(101_325.0, 101_225.0) == pytest.approx(8.33, abs=0.1)
    assert height_above(101_325.0, 101_325.0) == 0.0
    assert height_above(101_325.0, 101_425.0) < 0.0


def test_a_second_of_arc_north_is_about_31_metres_and_east_less_by_the_cosine() -> None:
    origin = (47.0, 8.0, 400.0)
    east, north, up = east_north_up((47.0 + 1 / 3600, 8.0, 400.0), origin)
    assert east == pytest.approx(0.0, abs=1e-6)
    assert north == pytest.approx(30.88, abs=0.02)
    assert up == pytest.approx(0.0, abs=1e-3)
    east, north, _ = east_north_up((47.0, 8.0 + 1 / 3600, 400.0), origin)
    assert east == pytest.approx(21.13, abs=0.02)
    assert north == pytest.approx(0.0, abs=1e-3)
    assert east_north_up((47.0, 8.0, 403.5), origin) == pytest.approx((0.0, 0.0, 3.5), abs=1e-6)
