"""A `node` reading that comes after its node has begun."""

import math
from typing import Literal

import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers import smoother
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, off_m, shown, step


def test_where_he_stands_is_believed_while_he_has_not_set_off() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([BASE, step(1.0, (0.0, 0.0, 0.0))])
    tracker.fold([Node(t=3.0, node="ff1", role="responder", position_m=(60.0, 0.0, 0.0), sigma_m=0.3)])
    for second in range(4, 14):
        tracker.fold([step(float(second), (1.0, 0.0, 0.0))])
    assert off_m(shown(tracker), (70.0, 0.0)) < 1.0


def test_what_he_faces_turns_his_way() -> None:
    entered = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3)
    north = Node(t=3.0, node="ff1", role="responder", heading_rad=math.pi / 2, heading_sigma_rad=0.05)
    tracker = KirchhoffTracker()
    tracker.fold([BASE, entered, step(1.0, (0.0, 0.0, 0.0))])
    tracker.fold([north])
    for second in range(4, 34):
        tracker.fold([step(float(second), (1.0, 0.0, 0.0))])
    assert off_m(shown(tracker), (0.0, 30.0)) < 2.0
    assert tracker.take_notices() == []


def test_too_late_what_he_faced_is_refused_and_said_so() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([BASE, *(step(float(second), (1.0, 0.0, 0.0)) for second in range(1, 20))])
    before = shown(tracker)
    tracker.fold([Node(t=19.5, node="ff1", role="responder", heading_rad=math.pi / 2)])
    assert before.position_m is not None
    assert off_m(shown(tracker), before.position_m) < 0.5
    assert [notice.code for notice in tracker.take_notices()] == ["conflict"]


def test_an_introduction_repeated_is_no_news() -> None:
    entered = Node(t=0.0, node="ff1", role="responder", position_m=(5.0, 0.0, 0.0), sigma_m=0.3)
    tracker = KirchhoffTracker()
    tracker.fold([BASE, entered, *(step(float(s), (1.0, 0.0, 0.0)) for s in range(1, 31))])
    again = Node(t=30.5, node="ff1", role="responder", position_m=(5.0, 0.0, 0.0), sigma_m=0.3)
    tracker.fold([again, step(31.0, (1.0, 0.0, 0.0))])
    assert off_m(shown(tracker), (36.0, 0.0)) < 1.0


@pytest.mark.parametrize("role", ["anchor", "breadcrumb"])
def test_a_radio_that_was_carried_elsewhere_lies_there(role: Literal["anchor", "breadcrumb"]) -> None:
    where = [
        Node(t=t, node="a1", role=role, position_m=(30.0, north, 0.0))
        for t, north in ((0.0, 0.0), (99.0, 20.0))
    ]
    tracker = KirchhoffTracker()
    tracker.fold([BASE, where[0]])
    tracker.fold([where[1]])
    assert off_m(shown(tracker, "a1"), (30.0, 20.0)) < 0.1
    assert [notice.code for notice in tracker.take_notices()] == ["node_moved"]


def test_gateways_that_round_an_introduction_repeat_it() -> None:
    tracker = KirchhoffTracker()
    told = ((1.234, 0.567, 0.0), (1.23, 0.57, 0.0))
    entered = [
        Node(t=0.0, node="ff1", role="responder", position_m=where, sigma_m=0.5, heading_rad=heading)
        for where, heading in zip(told, (1.5708, 1.57), strict=True)
    ]
    tracker.fold([BASE, entered[0]])
    for second in range(1, 100):
        walks = 20 < second <= 60
        faces = 0.0 if second < 10 else 1.3
        delta_m = (math.cos(1.3), math.sin(1.3), 0.0) if walks else (0.0, 0.0, 0.0)
        moved = Displacement(t=float(second), node="ff1", delta_m=delta_m, heading_rad=faces)
        again = entered[(second // 10) % 2]
        repeated = Node(
            t=second - 0.5,
            node="ff1",
            role="responder",
            position_m=again.position_m,
            sigma_m=0.5,
            heading_rad=again.heading_rad,
        )
        tracker.fold([moved, *([repeated] if second % 10 == 5 else [])])
    faced_rad = 1.3 + 1.5708
    where = (1.234 + 40.0 * math.cos(faced_rad), 0.567 + 40.0 * math.sin(faced_rad))
    assert off_m(shown(tracker), where) < 1.0
    assert tracker.take_notices() == []


def test_the_smoothed_view_follows_who_was_taken_for_a_breadcrumb_and_walks() -> None:
    places = {"a1": (0.0, 20.0), "a2": (20.0, 0.0), "a3": (25.0, 25.0)}
    readings: list[AnyReading] = [
        BASE,
        *(Node(t=0.0, node=n, role="anchor", position_m=(*p, 0.0)) for n, p in places.items()),
    ]
    for second in range(1, 60):
        t, east = float(second), 10.0 + 0.5 * max(second - 20, 0)
        readings += [
            Range(t=t, a=n, b="ff1", range_m=math.dist((east, 8.0), p), technology="uwb")
            for n, p in places.items()
        ]
        if second == 20:
            readings.append(Node(t=20.0, node="ff1", role="responder"))
        if second > 20:
            readings.append(step(t, (0.5, 0.0, 0.0)))
    track = smoother("kirchhoff", TrackerSettings()).smooth(readings)["ff1"]
    assert [point.t for point in track] == sorted({float(t) for t in range(math.ceil(track[0].t), 60)})
    at = {point.t: point.position_m for point in track}
    assert math.dist(at[10.0][:2], (10.0, 8.0)) < 0.5
    assert math.dist(at[59.0][:2], (29.5, 8.0)) < 0.5


def test_the_smoothed_view_moves_a_radio_when_its_gateway_says_so() -> None:
    walk = [step(float(second), (0.1, 0.0, 0.0)) for second in range(1, 200)]
    told = [
        Node(t=t, node="a1", role="anchor", position_m=(20.0, north, 0.0), sigma_m=0.1)
        for t, north in ((0.0, 0.0), (100.0, -20.0))
    ]
    track = smoother("kirchhoff", TrackerSettings()).smooth(
        [BASE, *told[:1], *walk[:99], told[1], *walk[99:]]
    )
    at = {point.t: point.position_m for point in track["a1"]}
    assert at[50.0][:2] == pytest.approx((20.0, 0.0), abs=0.1)
    assert at[100.0][:2] == pytest.approx((20.0, -20.0), abs=0.1)
