"""Images of the ground plane that leave ranges as they are."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.smoothing.images.symmetries import across, around

METRES = st.floats(-50.0, 50.0)
PLACES = st.tuples(METRES, METRES).map(np.array)


def apart_m(one: Array, other: Array) -> float:
    return float(np.hypot(*(one - other)))


@given(PLACES, PLACES, st.floats(-np.pi, np.pi))
def test_images_around_a_radio_are_as_far_from_it(radio_m: Array, place_m: Array, towards_rad: float) -> None:
    for image in around(radio_m, towards_rad):
        assert apart_m(image.of(place_m), radio_m) == pytest.approx(apart_m(place_m, radio_m), abs=1e-6)


@given(PLACES, PLACES, PLACES)
def test_the_image_across_the_line_of_two_radios_is_as_far_from_both(
    one: Array, other: Array, place_m: Array
) -> None:
    ((image, off_m),) = across([one, other], place_m[None])
    there_m = image.of(place_m)
    for radio_m in (one, other):
        assert apart_m(there_m, radio_m) == pytest.approx(apart_m(place_m, radio_m), abs=1e-6)
    assert apart_m(there_m, place_m) == pytest.approx(2.0 * abs(off_m[0]), abs=1e-6)


def test_one_radio_makes_no_line() -> None:
    assert across([np.zeros(2)], np.zeros((1, 2))) == []
