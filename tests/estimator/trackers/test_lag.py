"""What the tracker keeps to roll back to: what late readings need, however long the incident lasts."""

import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker

STEPS = 400


def walk(steps: int) -> list[AnyReading]:
    first = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1)
    steps_of = [
        Displacement(t=float(k), from_t=k - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0))
        for k in range(1, steps + 1)
    ]
    return [first, *steps_of]


def test_a_late_reading_goes_back_to_a_state_soon_before_it() -> None:
    tracker = KirchhoffTracker()
    for reading in walk(STEPS):
        tracker.fold([reading])
        tracker.estimates()
    ticks = [tick for tick, _ in tracker._lag._sure.checkpoints]
    for late_s in (1, 3, 10, 30, 55):
        before = max(tick for tick in ticks if tick <= STEPS - late_s)
        assert STEPS - late_s - before <= 16


def test_what_is_kept_does_not_grow_with_the_incident() -> None:
    sizes = []
    for steps in (800, 1600):
        tracker = KirchhoffTracker()
        for reading in walk(steps):
            tracker.fold([reading])
            tracker.estimates()
        sizes.append(len(tracker.snapshot()))
        assert len(tracker._lag._sure.checkpoints) < 20
    assert sizes[1] < 1.1 * sizes[0]


def test_an_epoch_that_is_still_to_come_makes_nothing_late_and_is_held_once_its_time_is_there() -> None:
    ahead = Position(t=90.0, node="ff2", position_m=(5.0, 5.0, 0.0), sigma_m=(1.0, 1.0, 1.0))
    tracker = KirchhoffTracker(TrackerSettings(lag_s=30.0))
    tracker.fold([*walk(1), ahead], 1.0)
    for t in range(2, 41):
        tracker.fold(
            [Displacement(t=float(t), from_t=t - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0))], float(t)
        )
    shown = {e.node: e.position_m for e in tracker.estimates()}
    assert shown["ff1"] == pytest.approx((40.0, 0.0, 0.0), abs=1.0)
    assert shown["ff2"] == pytest.approx((5.0, 5.0, 0.0), abs=1.0)
    assert tracker.counts()["too_late"] == 0
    assert KirchhoffTracker.restore(tracker.snapshot()).estimates() == tracker.estimates()


def test_what_came_too_late_is_counted_over_all_calls_and_restarts() -> None:
    tracker = KirchhoffTracker()
    tracker.fold(walk(STEPS))
    tracker.take_notices()
    told = []
    for t in (10.0, 11.0, 12.0):
        tracker.fold([Displacement(t=t, node="ff1", delta_m=(1.0, 0.0, 0.0))])
        told += [notice.text for notice in tracker.take_notices()]
        tracker = KirchhoffTracker.restore(tracker.snapshot())
    assert told == [
        "1 reading so far came more than 60 s late and is not fused",
        "2 readings so far came more than 60 s late and are not fused",
        "3 readings so far came more than 60 s late and are not fused",
    ]


def step_to(t: float) -> Displacement:
    return Displacement(t=t, node="ff1", delta_m=(1.0, 0.0, 0.0))


def test_whose_clock_made_everybody_elses_readings_late_is_said() -> None:
    astray = Position(t=4e9, node="uav", position_m=(0.0, 0.0, 9.0))
    tracker = KirchhoffTracker()
    tracker.fold([*walk(10), astray])
    tracker = KirchhoffTracker.restore(tracker.snapshot())
    tracker.fold([step_to(11.0)])
    (text,) = [notice.text for notice in tracker.take_notices() if notice.code == "too_late"]
    late, _, why = text.partition(": ")
    assert late == "1 reading so far came more than 60 s late and is not fused"
    assert why == "a reading of uav put time forward by 3999999990 s to t = 4000000000"


def test_a_first_reading_astray_is_named_too() -> None:
    tracker = KirchhoffTracker()
    for reading in (Position(t=4e9, node="uav", position_m=(0.0, 0.0, 9.0)), step_to(1.0)):
        tracker.fold([reading])
    assert [notice.text.partition(": ")[2] for notice in tracker.take_notices()] == [
        "a reading of uav put time forward to t = 4000000000"
    ]


def test_who_is_right_by_the_clock_of_who_received_it_is_not_blamed_for_what_is_late() -> None:
    tracker = KirchhoffTracker()
    right = Position(t=3600.0, node="uav", position_m=(0.0, 0.0, 9.0))
    tracker.fold([right], 3600.5)
    tracker.fold([step_to(1.0), step_to(2.0)], 3601.0)
    (notice,) = [notice for notice in tracker.take_notices() if notice.code == "too_late"]
    assert notice.text.endswith("came more than 60 s late and are not fused")


def test_what_is_late_without_anybodys_leap_blames_nobody() -> None:
    astray = Position(t=4e9, node="uav", position_m=(0.0, 0.0, 9.0))
    tracker = KirchhoffTracker()
    tracker.fold([*walk(STEPS), astray])
    tracker.fold([step_to(STEPS - 100.0)])
    assert [notice.text for notice in tracker.take_notices() if notice.code == "too_late"] == [
        "1 reading so far came more than 60 s late and is not fused"
    ]


def test_an_introduction_that_comes_too_late_is_taken_and_what_comes_with_it_is_not() -> None:
    tracker = KirchhoffTracker()
    tracker.fold(walk(STEPS))
    tracker.take_notices()
    anchor = Node(t=5.0, node="a1", role="anchor", position_m=(9.0, 9.0, 0.0))
    tracker.fold([anchor, step_to(6.0), Position(t=7.0, node="a1", position_m=(0.0, 0.0, 0.0))])
    tracker = KirchhoffTracker.restore(tracker.snapshot())
    assert {e.node: e.position_m for e in tracker.estimates()}["a1"] == (9.0, 9.0, 0.0)
    assert tracker.counts()["too_late"] == 2
    assert sorted((notice.code, notice.node) for notice in tracker.take_notices()) == [
        ("introduced_late", "a1"),
        ("too_late", "a1"),
        ("too_late", "ff1"),
    ]
