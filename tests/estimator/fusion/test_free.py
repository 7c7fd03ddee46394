"""Nodes without a PDR unit, heard of now and then."""

import numpy as np
import pytest

from estimator.fusion.free import free_motion
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker


def test_two_steps_one_after_the_other_are_one_step_of_their_time() -> None:
    first, first_noise = free_motion("responder", 4.0)
    second, second_noise = free_motion("responder", 7.0)
    whole, whole_noise = free_motion("responder", 11.0)
    np.testing.assert_allclose(second @ first, whole, atol=1e-12)
    np.testing.assert_allclose(
        second @ first_noise @ second.T + second_noise, whole_noise, rtol=1e-5, atol=1e-4
    )


@pytest.mark.parametrize("silence_s", [30.0, 300.0, 3_000.0])
def test_a_node_that_was_silent_for_long_is_found_where_it_is_heard_again(silence_s: float) -> None:
    tracker = KirchhoffTracker(TrackerSettings())
    tracker.fold([Node(t=0.0, node="uav", role="uav", position_m=(0.0, 0.0, 10.0))])
    near, far = (5.0, 0.0, 10.0), (80.0, -40.0, 12.0)
    tracker.fold([Position(t=1.0, node="uav", position_m=near, sigma_m=(1.0, 1.0, 2.0))])
    tracker.estimates()
    heard_again = Position(t=1.0 + silence_s, node="uav", position_m=far, sigma_m=(1.0, 1.0, 2.0))
    tracker.fold([heard_again])
    found = tracker.estimates()[0]
    assert found.position_m == pytest.approx(far, abs=6.0)
    assert found.covariance_m2 is not None
    assert 0.1 < found.covariance_m2[0] < 2.0
