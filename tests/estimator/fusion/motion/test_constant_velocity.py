"""Nodes without a PDR unit, heard of now and then."""

import numpy as np
import pytest

from estimator.fusion.motion.constant_velocity import free_motion
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
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
    # What this fix errs by, what all are off by (1 m² each), and how late it may be while he flies.
    assert 0.1 < found.covariance_m2[0] < 3.0


@pytest.mark.parametrize("switched_on_s", [60, 400])
def test_who_switches_his_unit_on_later_is_followed_on(switched_on_s: int) -> None:
    """While he walked without it he did not stand still, and his velocity was no gyro bias.

    The first is for the window to know, the second for what has left it.
    """
    chance = np.random.default_rng(3)
    corners = {"a1": (0.0, 0.0), "a2": (30.0, 0.0), "a3": (0.0, 30.0), "a4": (30.0, 30.0)}
    tracker = KirchhoffTracker(TrackerSettings())
    tracker.fold([Node(t=0.0, node=n, role="anchor", position_m=(*m, 0.0)) for n, m in corners.items()])
    tracker.fold([Node(t=0.0, node="ff1", role="responder", position_m=(15.0, 5.0, 0.0), sigma_m=0.5)])
    for second in range(1, switched_on_s + 61):
        was_m, now_m = (
            np.array([15.0 + 10.0 * np.sin(t / 20.0), 15.0 - 10.0 * np.cos(t / 20.0)])
            for t in (second - 1, second)
        )
        seen: list[AnyReading] = []
        for name, place_m in corners.items():
            range_m = float(np.hypot(*(now_m - place_m)) + chance.normal(0.0, 0.1))
            seen.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
        if second > switched_on_s:
            e, n = (now_m - was_m + chance.normal(0.0, 0.02, 2)).tolist()
            seen.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(e, n, 0.0)))
        tracker.fold(seen)
        found = {e.node: e.position_m for e in tracker.estimates()}["ff1"]
        assert found is not None
        assert second < 5 or np.hypot(*(np.array(found[:2]) - now_m)) < 0.7
