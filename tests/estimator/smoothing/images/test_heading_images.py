"""Whose unit may face anything, beside one radio: its ranges do not tell to which side of it he goes."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import outside

RADIO_M = (18.0, 0.0, 1.0)
UNKNOWN_RAD = 3.0
SURE = 20.0
"""Who is farther off, squared, is shown elsewhere, and sure of it: one in 20,000 is by chance."""


def gone(headings_rad: list[float], paces: list[int]) -> Array:
    """A way of some seconds in each direction, at a metre a second; places, k × 2 (m)."""
    each = np.repeat(headings_rad, paces)
    paces_m = np.stack([np.cos(each), np.sin(each)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(paces_m, axis=0)])


def rests(way_m: Array, seconds: int) -> Array:
    """The same way, begun after a rest."""
    return np.concatenate([np.repeat(way_m[:1], seconds, axis=0), way_m])


def outsides(
    way_m: Array,
    seed: int,
    told_rad: float,
    sigma_rad: float = UNKNOWN_RAD,
    heard_m: Array | None = None,
) -> list[float]:
    """Squared distances from where he is shown to where he is, by what is said of them, second by second.

    Args:
        way_m: where he is each second, k × 2 (m).
        seed: of all noise.
        told_rad: the heading of his unit's frame as it is told.
        sigma_rad: how far off that may be.
        heard_m: where his ranges tell of instead of where he is, k × 2 (m).
    """
    heard_m = way_m if heard_m is None else heard_m
    chance = np.random.default_rng(seed)
    tracker, found = KirchhoffTracker(), list[float]()
    begins = Node(
        t=0.0,
        node="ff1",
        role="responder",
        position_m=(0.0, 0.0, 0.0),
        sigma_m=0.2,
        heading_rad=told_rad,
        heading_sigma_rad=sigma_rad,
    )
    tracker.fold([Node(t=0.0, node="a1", role="anchor", position_m=RADIO_M, sigma_m=0.05), begins])
    for second in range(1, len(way_m)):
        t, heard = float(second), list[AnyReading]()
        for half in (0.5, 0.0):
            at = heard_m[second] - half * (heard_m[second] - heard_m[second - 1])
            range_m = math.hypot(*(at - RADIO_M[:2]), RADIO_M[2]) + float(chance.normal(0.0, 0.1))
            heard.append(Range(t=t - half, a="ff1", b="a1", range_m=range_m, technology="uwb", sigma_m=0.1))
        e, n = (way_m[second] - way_m[second - 1] + chance.normal(0.0, 0.02, 2)).tolist()
        tracker.fold([Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(e, n, 0.0)), *heard])
        shown = next(one for one in tracker.estimates() if one.node == "ff1")
        found.append(outside(shown.position_m, shown.covariance_m2, np.array([*way_m[second], 0.0])))
    return found


SEEDS = range(2)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("told_rad", [0.0, 2.0])
def test_who_rests_before_he_goes_may_go_to_either_side(side: float, told_rad: float) -> None:
    """A metre from where he stood both sides are beside each other; after twenty they are not."""
    way_m = rests(gone([1.1 * side], [20]), 5)
    assert max(max(outsides(way_m, seed, told_rad)) for seed in SEEDS) < SURE


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("off_rad", [0.12, 0.17])
def test_two_headings_near_each_other_are_two_once_they_have_led_apart(side: float, off_rad: float) -> None:
    way_m = gone([off_rad * side, (off_rad + 0.6 - math.pi) * side], [25, 8])
    assert max(max(outsides(way_m, seed, told_rad=1.0)) for seed in SEEDS) < SURE


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("off_rad", [0.05, 0.15])
def test_who_goes_to_a_radio_may_pass_it_on_either_side(side: float, off_rad: float) -> None:
    way_m = gone([off_rad * side, 0.3 * side], [13, 25])
    assert max(max(outsides(way_m, seed, told_rad=1.0)) for seed in SEEDS) < SURE


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_heading_that_is_hardly_told_leaves_either_side_open(side: float) -> None:
    """It is told as 0.6 rad off, give or take 0.5 rad; to the other side of the radio would fit it better."""
    way_m = gone([0.5 * side], [25])
    assert max(max(outsides(way_m, seed, -0.6 * side, 0.5)) for seed in SEEDS) < SURE


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_who_was_found_on_the_wrong_side_by_chance_is_found_again(side: float) -> None:
    """What a bend has told was noise: soon ranges miss the side that it spoke for by metres."""
    way_m = gone([1.1 * side, 1.4 * side, -0.9 * side, 2.4 * side], [12, 6, 14, 14])
    misled_m = gone([1.1 * side, 0.8 * side], [12, 6])
    heard_m = np.concatenate([misled_m, way_m[len(misled_m) :]])
    for seed in SEEDS:
        found = outsides(way_m, seed, told_rad=1.0, heard_m=heard_m)
        assert max(found[len(misled_m) :]) > SURE, "nothing has misled anybody"
        assert max(found[-8:]) < SURE


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_a_companion_who_knows_his_way_tells_what_a_unit_faces_where_no_radio_does(seed: int) -> None:
    """On the way it is never sure of a wrong place; where both have turned twice it is known."""
    chance = np.random.default_rng(seed)
    faces_rad = float(chance.uniform(-math.pi, math.pi))
    ways_m = {"ff1": gone([0.3, -1.2, 0.3], [12, 12, 12]), "ff2": gone([-0.4, 1.1, -0.4], [12, 12, 12])}
    ways_m["ff2"] += np.array([0.0, 3.0])
    tracker = KirchhoffTracker()
    for node, sigma_rad in (("ff1", UNKNOWN_RAD), ("ff2", 0.02)):
        e, n = ways_m[node][0].tolist()
        begins = Node(t=0.0, node=node, role="responder", position_m=(e, n, 0.0), sigma_m=0.2)
        tracker.fold([replace(begins, heading_sigma_rad=sigma_rad)])
    for second in range(1, 37):
        t, apart_m = float(second), math.dist(*(way_m[second].tolist() for way_m in ways_m.values()))
        tracker.fold([Range(t=t, a="ff1", b="ff2", range_m=apart_m, technology="uwb", sigma_m=0.1)])
        for node, turned_rad in (("ff1", faces_rad), ("ff2", 0.0)):
            east, north = (np.diff(ways_m[node], axis=0)[second - 1] + chance.normal(0.0, 0.02, 2)).tolist()
            cosine, sine = math.cos(turned_rad), math.sin(turned_rad)
            reported_m = (cosine * east + sine * north, cosine * north - sine * east, 0.0)
            tracker.fold([Displacement(t=t, from_t=t - 1.0, node=node, delta_m=reported_m)])
        shown = next(one for one in tracker.estimates() if one.node == "ff1")
        there_m = np.array([*ways_m["ff1"][second], 0.0])
        assert outside(shown.position_m, shown.covariance_m2, there_m) < SURE
    assert shown.position_m is not None
    assert math.dist(shown.position_m[:2], there_m[:2]) < 1.0
