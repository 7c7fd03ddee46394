"""Who has left comes back under the same name, and who is silent stays where he was heard last."""

import math

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.status import Status
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from estimator.trackers.paper_a import PaperATracker
from tests.estimator.trackers.entry import BASE, off_m, shown, squared_error, step

OUT_S = 30.0
ENTERS = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3)
AGAIN = Node(t=90.0, node="ff1", role="responder", position_m=(0.0, 8.0, 0.0), sigma_m=0.3)
ANCHORS = {"a1": (25.0, -5.0), "a2": (0.0, 30.0)}


def spread_m(found: NodeEstimate) -> float:
    assert found.covariance_m2 is not None
    return math.sqrt(found.covariance_m2[0] + found.covariance_m2[3])


def out_and_in(again: Node = AGAIN) -> list[AnyReading]:
    """He walks east for half a minute and leaves; a minute later he enters by the next door."""
    anchored = [
        Node(t=0.0, node=name, role="anchor", position_m=(*at, 0.0), sigma_m=0.1)
        for name, at in ANCHORS.items()
    ]
    chance = np.random.default_rng(1)
    readings: list[AnyReading] = [BASE, ENTERS, *anchored, Retire(t=OUT_S, node="ff1"), again]
    for since, north in ((0.0, 0.0), (again.t, 8.0)):
        for second in range(1, int(OUT_S)):
            readings.append(step(since + second, (1.0, 0.0, 0.0)))
            readings += [
                Range(t=since + second, a="ff1", b=name, range_m=math.dist(at, (second, north)), sigma_m=0.3)
                for name, at in ANCHORS.items()
                if chance.random() < 0.5
            ]
    return sorted(readings, key=lambda r: r.t)


def test_who_is_introduced_again_and_reported_of_is_followed_from_where_he_enters() -> None:
    tracker = KirchhoffTracker()
    tracker.fold(out_and_in())
    found = shown(tracker)
    assert not found.retired
    assert off_m(found, (29.0, 8.0)) < 0.5
    assert squared_error(found, (29.0, 8.0)) < 9.0
    assert [notice.code for notice in tracker.take_notices()] == ["came_back"]


def test_a_list_that_a_gateway_repeats_brings_nobody_back() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([r for r in out_and_in() if r.t <= OUT_S])
    left = shown(tracker)
    tracker.fold([Node(t=t, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0)) for t in (31.0, 60.0)])
    assert shown(tracker) == left
    assert left.retired
    assert tracker.take_notices() == []


def test_a_radio_beside_the_engine_that_reports_its_battery_brings_nobody_back() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([*(r for r in out_and_in() if r.t <= OUT_S), AGAIN, Status(t=91.0, node="ff1", battery=0.5)])
    assert shown(tracker).retired


def test_a_name_may_come_back_as_something_else() -> None:
    entered = Node(t=100.0, node="b1", role="responder", position_m=(5.0, 5.0, 0.0), sigma_m=0.3)
    fix = Position(t=101.0, node="b1", position_m=(5.0, 5.0, 0.0), sigma_m=(1.0, 1.0, 1.0))
    tracker = KirchhoffTracker()
    tracker.fold([*out_and_in(), Drop(t=5.0, node="b1", by="ff1"), Retire(t=20.0, node="b1"), entered, fix])
    assert shown(tracker, "b1").role == "responder"
    assert off_m(shown(tracker, "b1"), (5.0, 5.0)) < 1.0


def test_who_was_reported_of_before_he_was_introduced_again_has_not_come_back() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([*(r for r in out_and_in() if r.t <= OUT_S), step(89.0), AGAIN])
    assert shown(tracker).retired


@pytest.mark.parametrize("wait_s", [0.1, 0.4, 5.0, 400.0])
def test_however_soon_he_comes_back_he_is_followed(wait_s: float) -> None:
    tracker = KirchhoffTracker()
    again = Node(t=OUT_S + wait_s, node="ff1", role="responder", position_m=(0.0, 8.0, 0.0), sigma_m=0.3)
    for reading in out_and_in(again):
        tracker.fold([reading])
    assert off_m(shown(tracker), (29.0, 8.0)) < 0.5


def test_a_tracker_that_is_restored_while_somebody_is_back_goes_on_alike() -> None:
    readings = out_and_in()
    whole, cut = KirchhoffTracker(), KirchhoffTracker()
    whole.fold(readings)
    for first, second in ((0.0, 90.0), (90.0, 90.5), (90.5, 100.0), (100.0, 200.0)):
        cut.fold([r for r in readings if first < r.t <= second or r.t == first == 0.0])
        cut = KirchhoffTracker.restore(cut.snapshot())
    assert cut.estimates() == whole.estimates()


def test_his_smoothed_track_has_a_gap_while_he_was_out() -> None:
    points = BatchSmoother().smooth(out_and_in())["ff1"]
    assert [p.t for p in points] == [*range(31), *range(90, 120)]
    off = [
        math.dist(p.position_m[:2], (p.t % 90.0, 8.0 * (p.t >= 90.0))) for p in points if p.t % 90.0 < 30.0
    ]
    assert max(off) < 0.7


def test_evidence_tells_of_the_way_he_is_on() -> None:
    found = BatchSmoother().evidence(out_and_in(), "ff1")
    assert found is not None
    assert found.t == pytest.approx(119.0)
    assert math.dist(found.position_m[:2], (29.0, 8.0)) < 0.5


def test_a_breadcrumb_that_was_picked_up_may_be_dropped_again() -> None:
    tracker = KirchhoffTracker()
    picked_up: list[AnyReading] = [
        Drop(t=5.0, node="b1", by="ff1"),
        Retire(t=20.0, node="b1"),
        Drop(t=110.0, node="b1", by="ff1"),
    ]
    readings = [*out_and_in(), *picked_up]
    tracker.fold(readings)
    assert off_m(shown(tracker, "b1"), (20.0, 8.0)) < 0.7
    points = {p.t: p.position_m for p in BatchSmoother().smooth(readings)["b1"]}
    assert math.dist(points[10.0][:2], (5.0, 0.0)) < 0.7
    assert math.dist(points[110.0][:2], (20.0, 8.0)) < 0.7
    assert not {float(t) for t in range(21, 110)} & points.keys()


@pytest.mark.parametrize("told", [True, False])
def test_a_breadcrumb_that_has_burned_comes_back_only_where_somebody_says_that_it_lies(told: bool) -> None:
    place = (10.0, 5.0, 0.0) if told else None
    again = Node(t=100.0, node="b1", role="breadcrumb", position_m=place, sigma_m=0.3)
    heard = Range(t=101.0, a="ff1", b="b1", range_m=5.0)
    tracker = KirchhoffTracker()
    tracker.fold([*out_and_in(), Drop(t=5.0, node="b1", by="ff1"), Retire(t=20.0, node="b1"), again, heard])
    assert shown(tracker, "b1").retired != told


def test_paper_a_follows_who_comes_back_as_well() -> None:
    tracker = PaperATracker()
    tracker.fold(out_and_in())
    found = next(e for e in tracker.estimates() if e.node == "ff1")
    assert not found.retired
    assert off_m(found, (29.0, 8.0)) < 3.0


@pytest.mark.parametrize("unit", [True, False])
def test_who_is_silent_stays_as_sure_as_when_he_was_heard_last(unit: bool) -> None:
    """The window leaves the seconds behind in which he was: what it is shown with ages him since then."""
    chance = np.random.default_rng(2)
    tracker = KirchhoffTracker()
    tracker.fold([BASE, ENTERS, Node(t=0.0, node="ff2", role="responder", position_m=(0.0, 0.0, 0.0))])

    def walked(name: str, t: float) -> list[AnyReading]:
        east, north = 10.0 * math.sin(t / 10.0), 10.0 - 10.0 * math.cos(t / 10.0)
        e, n = math.cos((t - 0.5) / 10.0), math.sin((t - 0.5) / 10.0)
        at = (east + chance.normal(0.0, 0.5), north + chance.normal(0.0, 0.5), 0.0)
        fix = Position(t=t, node=name, position_m=at, sigma_m=(0.5, 0.5, 0.5))
        both: list[AnyReading] = [Displacement(t=t, from_t=t - 1.0, node=name, delta_m=(e, n, 0.0)), fix]
        return both if unit else both[1:]

    for second in range(1, 61):
        tracker.fold([*walked("ff1", float(second)), *walked("ff2", float(second))])
    heard_m = spread_m(shown(tracker))
    for second in range(61, 800):
        tracker.fold(walked("ff2", float(second)))
        if second % 20 == 0:
            found = shown(tracker)
            assert found.t == 60.0
            assert spread_m(found) < 1.5 * heard_m
