"""Whose gyro is cheap is known after a straight leg; who walks round something is not surely elsewhere."""

import math

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker

SURE = 13.8
"""Squared Mahalanobis distance in the plane beyond which one place in a thousand is."""
HELD = 5.99
"""The same of one place in twenty."""


def reports(way_m: Array, bias_radps: float) -> list[AnyReading]:
    """A walk of a place each second, as a unit tells it whose frame turns by its gyro's bias."""
    readings: list[AnyReading] = [
        Node(
            t=0.0,
            node="ff1",
            role="responder",
            position_m=(0.0, 0.0, 0.0),
            sigma_m=0.1,
            heading_sigma_rad=0.01,
        )
    ]
    for second, (east, north) in enumerate(np.diff(way_m, axis=0).tolist(), start=1):
        turned = -bias_radps * (second - 0.5)
        seen = (
            math.cos(turned) * east - math.sin(turned) * north,
            math.sin(turned) * east + math.cos(turned) * north,
            0.0,
        )
        readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=seen))
    return readings


def shown(readings: list[AnyReading], true_m: Array) -> tuple[float, float]:
    """How far off the last picture is (m), and the squared Mahalanobis distance of the truth from it."""
    tracker = KirchhoffTracker()
    for reading in readings:
        tracker.fold([reading])
        tracker.estimates()
    (found,) = tracker.estimates()
    assert found.position_m is not None
    assert found.covariance_m2 is not None
    ee, en, _, nn, *_ = found.covariance_m2
    off = np.array(found.position_m[:2]) - true_m
    return float(np.hypot(*off)), float(off @ np.linalg.solve([[ee, en], [en, nn]], off))


@pytest.mark.parametrize("bias_degps", [-0.4, 0.3])
def test_a_gyro_that_turns_is_seen_through_on_a_straight_way(bias_degps: float) -> None:
    """Nothing else tells of it: no radio is heard, and nobody stands still."""
    way_m = np.array(
        [[second, 0.0] for second in range(31)]
        + [[30.0, second] for second in range(1, 31)]
        + [[30.0 - second, 30.0] for second in range(1, 31)]
    )
    bias = math.radians(bias_degps)
    readings = reports(way_m, bias)
    alone_m = np.zeros(2)
    for reading in readings[1:]:
        assert isinstance(reading, Displacement)
        alone_m += reading.delta_m[:2]
    off_m, distance2 = shown(readings, way_m[-1])
    assert off_m < 0.6 * float(np.hypot(*(alone_m - way_m[-1])))
    assert distance2 < SURE


@pytest.mark.parametrize("radius_m", [40.0, 100.0, 150.0, 250.0])
def test_who_walks_along_a_round_corridor_is_not_surely_elsewhere(radius_m: float) -> None:
    along_rad = np.arange(121) / radius_m
    way_m = radius_m * np.column_stack([np.sin(along_rad), 1.0 - np.cos(along_rad)])
    _, distance2 = shown(reports(way_m, 0.0), way_m[-1])
    assert distance2 < SURE


@pytest.mark.parametrize("radius_m", [100.0, 150.0, 250.0])
@pytest.mark.parametrize("way_m", [200, 400])
def test_his_ellipse_holds_who_goes_far_along_a_ring_that_turns_as_gyros_do(
    radius_m: float, way_m: int
) -> None:
    """Nothing tells a ring from a gyro: half of the turn is taken for either."""
    along_rad = np.arange(way_m + 1) / radius_m
    places_m = radius_m * np.column_stack([np.sin(along_rad), 1.0 - np.cos(along_rad)])
    _, distance2 = shown(reports(places_m, 0.0), places_m[-1])
    assert distance2 < HELD


def test_who_goes_to_and_fro_in_a_round_corridor_is_where_he_has_gone() -> None:
    radius_m = 80.0
    to, fro = np.arange(61) / radius_m, np.arange(59, -1, -1) / radius_m
    along_rad = np.concatenate([to, fro, to[1:], fro])
    way_m = radius_m * np.column_stack([np.sin(along_rad), 1.0 - np.cos(along_rad)])
    _, distance2 = shown(reports(way_m, 0.0), way_m[-1])
    assert distance2 < SURE
