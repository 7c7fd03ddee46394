"""A gateway that is always far behind: rows, and what is told while nothing comes."""

import math

import pytest

from backend.live.record import RecordNode
from backend.tracking.fold import IncidentFold
from estimator.measurements import Alarm, AnyReading, Displacement, Node, Range, Retire, Rssi
from estimator.measurements.node import Role
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import a_gateway_behind, entry, fold_all

SETTINGS = TrackerSettings()


def test_what_is_told_while_nothing_comes_is_in_no_row_of_a_second_that_is_over() -> None:
    batches, quiet, settled = a_gateway_behind(60), [], []
    undisturbed, interrupted = (IncidentFold("kirchhoff", SETTINGS) for _ in range(2))
    changed = 0
    for seq, readings in enumerate(batches, start=1):
        quiet += [row for row in undisturbed.fold(entry(seq), readings) if row is not None]
        settled += [row for row in interrupted.fold(entry(seq), readings) if row is not None]
        if seq % 20 == 0 and interrupted.settle():
            changed += 1
            assert not interrupted.settle()
            interrupted.last_row()
    assert settled == quiet
    assert changed >= 2


def test_while_nothing_comes_late_readings_are_told_as_if_they_had_come_in_time() -> None:
    batches = a_gateway_behind(60)
    late, in_time = (IncidentFold("kirchhoff", SETTINGS) for _ in range(2))
    fold_all(late, batches)
    fold_all(in_time, sorted(batches, key=lambda batch: batch[0].t))
    assert late.settle()
    assert late.picture() == in_time.picture()
    assert late.relative("ff1", "ff2") == in_time.relative("ff1", "ff2")


def test_a_call_that_comes_late_is_shown_at_once() -> None:
    fold = IncidentFold("kirchhoff", SETTINGS, live=True)
    fold_all(fold, a_gateway_behind(60))
    called = Alarm(t=1021.0, node="ff2", alarm="mayday", state="raised")
    fold_all(fold, [[called]], first=1000)
    assert [alarm.node for alarm in fold.picture().alarms] == ["ff2"]


def told_too_late(role: Role, *then: AnyReading) -> RecordNode:
    """How one is shown whose introduction came five minutes late, and of whom readings tell then."""
    base = Node(t=1000.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))
    late = Node(t=700.0, node="x", role=role, callsign="X", crew="L3")
    fold = IncidentFold("kirchhoff", SETTINGS)
    fold_all(fold, [[base], [late], list(then)])
    (shown,) = [node for node in fold.picture().nodes if node.node == "x"]
    return shown


@pytest.mark.parametrize(
    ("role", "then"),
    [
        ("breadcrumb", []),
        ("breadcrumb", [Rssi(t=1001.0, a="x", b="base", dbm=-60.0)]),
        ("breadcrumb", [Retire(t=1001.0, node="x", reason="burned")]),
        ("responder", [Range(t=1001.0, a="x", b="base", range_m=7.0)]),
        ("responder", [Displacement(t=1001.0, node="x", delta_m=(1.0, 0.0, 0.0))]),
        ("uav", [Alarm(t=1001.0, node="x", alarm="help", state="raised")]),
    ],
    ids=["silent", "heard", "burned", "ranged", "walking", "calling"],
)
def test_who_was_introduced_too_late_is_shown_as_what_he_is(role: Role, then: list[AnyReading]) -> None:
    shown = told_too_late(role, *then)
    assert (shown.role, shown.callsign, shown.crew) == (role, "X", "L3")


def test_who_is_found_by_ranges_is_found_as_what_was_told_of_him_too_late() -> None:
    places = {"b1": (10.0, 0.0, 0.0), "b2": (0.0, 10.0, 0.0), "b3": (-10.0, -10.0, 0.0)}
    anchors = [Node(t=1000.0, node=name, role="anchor", position_m=at) for name, at in places.items()]
    ranges = [
        Range(t=1001.0 + s, a="x", b=name, range_m=math.dist(at, (3.0, 4.0, 0.0)), technology="uwb")
        for s in range(10)
        for name, at in places.items()
    ]
    roles: tuple[Role, Role] = ("breadcrumb", "responder")
    for role in roles:
        shown = told_too_late(role, *anchors, *ranges)
        assert shown.role == role
        assert shown.position_m == pytest.approx((3.0, 4.0, 0.0), abs=0.1)
    assert told_too_late("responder", *anchors, *ranges).speed_mps is not None


def test_who_is_introduced_again_in_time_is_what_the_tracker_was_told() -> None:
    again = Node(t=1002.0, node="x", role="responder", position_m=(1.0, 2.0, 0.0))
    shown = told_too_late("breadcrumb", again)
    assert (shown.role, shown.position_m is None) == ("responder", False)
    late = Node(t=700.0, node="x", role="breadcrumb")
    assert told_too_late("breadcrumb", again, late).role == "responder"
