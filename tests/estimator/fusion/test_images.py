"""Where somebody may be whom readings tell only up to a turn or a reflection."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.images import Alternative, Image, doubt_between_m2, doubt_m2, mirrored, turned_about
from estimator.graph.dense import Array

metres = st.floats(-50.0, 50.0)
places = st.tuples(metres, metres).map(np.array)
angles = st.floats(-math.pi, math.pi)
images = st.one_of(st.builds(turned_about, places, angles), st.builds(mirrored, places, angles))


@given(images, places, places)
def test_an_image_keeps_all_distances(image: Image, one: Array, other: Array) -> None:
    assert np.hypot(*(image.of(one) - image.of(other))) == pytest.approx(np.hypot(*(one - other)), abs=1e-9)


@given(images, places)
def test_the_image_back_leads_back(image: Image, place: Array) -> None:
    assert image.back().of(image.of(place)) == pytest.approx(place, abs=1e-9)


@given(images, images, places)
def test_the_image_of_an_image_is_one(first: Image, second: Image, place: Array) -> None:
    assert second.after(first).of(place) == pytest.approx(second.of(first.of(place)), abs=1e-9)


@given(images, places, places)
def test_an_image_can_be_moved_to_where_somebody_would_be(image: Image, here: Array, there: Array) -> None:
    assert image.through(here, there).of(here) == pytest.approx(there, abs=1e-9)


@given(places, angles, places)
def test_a_turn_about_a_radio_leaves_its_range(radio: Array, by_rad: float, place: Array) -> None:
    there = turned_about(radio, by_rad).of(place)
    assert np.hypot(*(there - radio)) == pytest.approx(np.hypot(*(place - radio)), abs=1e-9)


@given(places, angles, metres, places)
def test_a_reflection_leaves_ranges_to_all_that_lies_in_its_line(
    on: Array, towards_rad: float, along_m: float, place: Array
) -> None:
    radio = on + along_m * np.array([math.cos(towards_rad), math.sin(towards_rad)])
    there = mirrored(on, towards_rad).of(place)
    assert np.hypot(*(there - radio)) == pytest.approx(np.hypot(*(place - radio)), abs=1e-9)


@given(images, st.integers(0, 1000))
def test_who_is_moved_there_goes_on_as_his_image_would(image: Image, seed: int) -> None:
    states = np.random.default_rng(seed).normal(0.0, 3.0, (4, 6))
    there, later = states.copy(), states[:, :2] + 0.5 * states[:, 3:5]
    image.move(there)
    assert there[:, :2] + 0.5 * there[:, 3:5] == pytest.approx(image.of(later), abs=1e-9)
    assert (there[:, [2, 5]] == states[:, [2, 5]]).all()


@given(st.lists(st.tuples(st.floats(0.01, 0.3), images), max_size=3), places)
def test_doubt_is_the_second_moment_of_where_he_may_be_about_where_he_is_shown(
    told: list[tuple[float, Image]], place: Array
) -> None:
    others = [Alternative(0, share, image, 0.0, image) for share, image in told]
    drawn = [(share, image.of(place) - place) for share, image in told]
    east, north = (sum(share * off[axis] ** 2 for share, off in drawn) for axis in (0, 1))
    both = sum(share * off[0] * off[1] for share, off in drawn)
    expected = np.array([[east, both, 0.0], [both, north, 0.0], [0.0, 0.0, 0.0]])
    assert doubt_m2(others, place) == pytest.approx(expected, abs=1e-9)


@given(st.floats(0.01, 0.5), images, places, places)
def test_who_would_be_elsewhere_together_is_no_less_surely_beside_each_other(
    share: float, way: Image, place: Array, other: Array
) -> None:
    off = way.of(place) - place
    together = [(Alternative(1, share, Image().through(at, at + off), 5.0, way),) for at in (place, other)]
    assert doubt_between_m2(together[0], place, together[1], other) == pytest.approx(0.0, abs=1e-9)


@given(st.floats(0.01, 0.5), images, places, places)
def test_who_would_be_elsewhere_alone_is_so_to_everybody(
    share: float, way: Image, place: Array, other: Array
) -> None:
    alone = (Alternative(1, share, way, 5.0, way),)
    expected = doubt_m2(alone, place)
    assert doubt_between_m2(alone, place, (), other) == pytest.approx(expected, abs=1e-9)
    assert doubt_between_m2((), other, alone, place) == pytest.approx(expected, abs=1e-9)
