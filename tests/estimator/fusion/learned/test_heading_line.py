"""A line through headings that ought to stay."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.learned.heading_line import HeadingLine


def line_through(headings_rad: list[float], period_s: float = 1.0) -> HeadingLine:
    line = HeadingLine(50.0, 50.0, headings_rad[0])
    for i, heading in enumerate(headings_rad[1:], start=1):
        line = line.extended(50.0 + period_s * i, heading)
    return line


@given(headings=st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=40), start=st.floats(-10.0, 10.0))
def test_the_bias_is_the_slope_of_the_regression_line_with_its_sign_turned(
    headings: list[float], start: float
) -> None:
    reported = [math.remainder(start + heading, 2.0 * math.pi) for heading in headings]
    bias = line_through(reported, period_s=2.0).bias(0.01, 0.0)
    slope = np.polyfit(2.0 * np.arange(len(headings)), headings, 1)[0]
    assert bias.value == pytest.approx(-slope, abs=1e-9)


def test_a_heading_is_off_the_mean_of_those_before_it_even_across_south() -> None:
    line = line_through([3.1, 3.0, -math.pi])
    mean = (3.1 + 3.0 + math.pi) / 3.0
    assert line.off_rad(-3.0) == pytest.approx(2.0 * math.pi - 3.0 - mean)
    assert line.step_rad(-3.0) == pytest.approx(math.pi - 3.0)


def test_a_frame_whose_angle_walks_tells_its_bias_less_surely() -> None:
    line = line_through([0.0, 0.01, 0.0, 0.01, 0.0, 0.01])
    still, walking = line.bias(0.01, 0.0), line.bias(0.01, 4e-4)
    assert walking.value == still.value
    assert walking.sigma**2 - still.sigma**2 == pytest.approx(1.2 * 4e-4 / line.lasted_s)
