"""Who puts on another unit on his way: its frame has nothing to do with the one before."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.estimate import NodeEstimate
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, outside
from tests.estimator.inertial.gait import Stride, walked
from tests.estimator.trackers.entry import off_m, shown

CHANGED_T = 30.2
ENTERED = Node(
    t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3, heading_rad=0.0, device="A"
)


def turned(t: float, frame_rad: float, faces_rad: float = 0.0, speed_mps: float = 1.0) -> Displacement:
    """A second of walking, as a unit tells it whose frame is turned by an angle."""
    in_frame_rad = faces_rad - frame_rad
    delta_m = speed_mps * math.cos(in_frame_rad), speed_mps * math.sin(in_frame_rad), 0.0
    return Displacement(t=t, node="ff1", from_t=t - 1.0, delta_m=delta_m, heading_rad=in_frame_rad)


def way(frame_rad: float, more: Sequence[AnyReading], faces_rad: float = 0.0) -> list[AnyReading]:
    """Thirty seconds to the east with one unit, thirty with another one."""
    before = [turned(float(second), 0.0) for second in range(1, 31)]
    after = [turned(float(second), frame_rad, faces_rad) for second in range(31, 61)]
    return [ENTERED, *before, *more, *after]


def found(readings: Sequence[AnyReading]) -> NodeEstimate:
    tracker = KirchhoffTracker()
    for reading in readings:
        tracker.fold([reading])
        tracker.estimates()
    return shown(tracker)


def another(heading_rad: float | None = None, device: str = "B") -> Node:
    return Node(t=CHANGED_T, node="ff1", role="responder", heading_rad=heading_rad, device=device)


@pytest.mark.parametrize("frame_rad", [-2.5, -1.5, -0.7, 0.7, 1.5, 2.5])
@pytest.mark.parametrize("faces_rad", [0.0, 1.2])
def test_he_is_not_shown_as_sure_where_another_unit_leads_him(frame_rad: float, faces_rad: float) -> None:
    there = 30.0 + 30.0 * math.cos(faces_rad), 30.0 * math.sin(faces_rad), 0.0
    estimate = found(way(frame_rad, [another()], faces_rad))
    assert outside(estimate.position_m, estimate.covariance_m2, there) < INSIDE
    assert estimate.heading_sigma_rad is not None
    assert estimate.heading_sigma_rad > 1.0


def test_who_goes_on_as_he_went_is_shown_there() -> None:
    assert off_m(found(way(1.5, [another()])), (60.0, 0.0)) < 2.0


@pytest.mark.parametrize("faces_rad", [-1.5, 0.7, 2.5])
def test_what_he_faces_as_it_is_switched_on_is_believed_as_it_is_told(faces_rad: float) -> None:
    estimate = found(way(faces_rad, [another(faces_rad)], faces_rad))
    there = 30.0 + 30.0 * math.cos(faces_rad), 30.0 * math.sin(faces_rad), 0.0
    assert off_m(estimate, there) < 4.0
    assert outside(estimate.position_m, estimate.covariance_m2, there) < INSIDE
    assert estimate.heading_sigma_rad is not None
    assert estimate.heading_sigma_rad < 0.4


@pytest.mark.parametrize("frame_rad", [-1.5, 2.5])
def test_what_is_told_but_may_mean_anything_makes_nobody_sure(frame_rad: float) -> None:
    estimate = found(way(frame_rad, [another(heading_rad=1.2)], 1.2))
    there = 30.0 + 30.0 * math.cos(1.2), 30.0 * math.sin(1.2), 0.0
    assert outside(estimate.position_m, estimate.covariance_m2, there) < INSIDE


@pytest.mark.parametrize("more", [[another(device="A")], [ENTERED], [another(device="A")] * 3])
def test_an_introduction_that_names_the_same_device_changes_nothing(more: list[AnyReading]) -> None:
    assert found(way(0.0, more)).covariance_m2 == found(way(0.0, [])).covariance_m2


def test_another_unit_is_said_to_be_worn_once() -> None:
    tracker = KirchhoffTracker()
    tracker.fold(way(1.5, [another(), another()]))
    assert [notice.code for notice in tracker.take_notices()] == ["unit_changed"]


def test_a_tracker_restored_between_two_units_goes_on_to_the_last_bit() -> None:
    readings = way(1.5, [another()])
    whole = KirchhoffTracker()
    whole.fold(readings[:32])
    restored = KirchhoffTracker.restore(whole.snapshot())
    for tracker in (whole, restored):
        tracker.fold(readings[32:])
    assert restored.estimates() == whole.estimates()


def test_the_smoothed_view_doubts_it_as_well() -> None:
    track = BatchSmoother(TrackerSettings()).smooth(way(1.5, [another()], 1.2))["ff1"]
    there = 30.0 + 30.0 * math.cos(1.2), 30.0 * math.sin(1.2), 0.0
    assert outside(track[-1].position_m, track[-1].covariance_m2, there) < INSIDE


@pytest.mark.parametrize("told", [True, False])
def test_a_boot_with_raw_samples_begins_anew_as_well(told: bool) -> None:
    first = walked([Stride()] * 12)
    second = walked([Stride()] * 12, first.t[-1] + 2.0, heading_rad=1.2)
    changed = Node(
        t=float(first.t[-1]) + 1.0,
        node="ff1",
        role="responder",
        heading_rad=1.2 if told else None,
        device="B",
    )
    estimate = found([ENTERED, *first.readings(), changed, *second.readings()])
    there = first.place_m[-1] + second.place_m[-1]
    assert outside(estimate.position_m, estimate.covariance_m2, there.tolist()) < INSIDE
    assert not told or np.hypot(*(np.array(estimate.position_m) - there)[:2]) < 2.0


def test_the_new_unit_is_not_better_than_usual_because_the_old_one_was() -> None:
    state, steps = FusionState(), [turned(float(second), 0.0) for second in range(1, 4)]
    fold_tick(state, 2.0, [ENTERED, *steps[:2]])
    state.nodes["ff1"] = replace(state.nodes["ff1"], walk_factors=(0.1, 5.0))
    fold_tick(state, 3.0, [replace(ENTERED, t=2.5, device="B"), steps[2]])
    assert state.nodes["ff1"].walk_factors == (1.0, 5.0)
