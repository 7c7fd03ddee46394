"""Where there are many people, less that comes late makes a hurry, and nobody waits for the sure chain."""

import pytest

from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.trackers.catch_up import BACKLOG_TICKS, BACKLOG_WORK, CatchUp
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.walks import two_responders

LAST_S, LATE_S = 60, 25
CROWD: list[AnyReading] = [
    Node(t=0.0, node=f"ff{k}", role="responder", position_m=(-3.0 * k, 5.0, 0.0), sigma_m=0.3)
    for k in range(3, 9)
]
WALK = [*CROWD, *two_responders(LAST_S + 20)]


def is_late(reading: AnyReading) -> bool:
    """It is of ff2, and was held back until the gateway came back."""
    return "ff2" in (getattr(reading, "node", ""), getattr(reading, "a", "")) and reading.t > LAST_S - LATE_S


def come_back() -> KirchhoffTracker:
    """A tracker that was asked until a gateway came back, and has taken its readings."""
    tracker = KirchhoffTracker()
    until = [r for r in WALK if r.t <= LAST_S]
    tracker.fold([r for r in until if not is_late(r)])
    tracker.take_notices()
    tracker.fold([r for r in until if is_late(r)])
    return tracker


@pytest.mark.parametrize("people", [1, 2, 4, 8, 20])
def test_the_more_there_are_the_less_may_be_folded_anew_before_there_is_a_hurry(people: int) -> None:
    most = min(BACKLOG_TICKS, BACKLOG_WORK // people)
    for late, hurries in ((most, False), (most + 1, True)):
        hurry = CatchUp()
        for k in range(people):
            for _ in range(2):
                hurry.meet(Node(t=0.0, node=f"ff{k}", role="responder"))
        hurry.meet(Node(t=0.0, node="b1", role="breadcrumb"))
        hurry.advance(1000, 1000)
        assert hurry.note_reading(1000 - late, 1000) == hurry.hurrying == hurries


def test_the_picture_is_told_before_the_sure_chain_follows_and_is_the_same_after() -> None:
    tracker, other = come_back(), come_back()
    for one in (tracker, other):
        one.estimates()
    for second in range(LAST_S + 1, LAST_S + 6):
        for one in (tracker, other):
            one.fold([r for r in WALK if second - 1 < r.t <= second])
        before = tracker._lag._sure.folded
        told = tracker.estimates()
        assert tracker._lag._sure.folded == before
        other.take_notices()
        assert other._lag._sure.folded > before
        assert other.estimates() == tracker.estimates() == told
    assert tracker.take_notices() == other.take_notices()
    assert tracker.snapshot() == other.snapshot()


def test_who_was_introduced_is_known_after_a_restart() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([r for r in WALK if r.t <= LAST_S and not is_late(r)])
    restored = KirchhoffTracker.restore(tracker.snapshot())
    for one in (tracker, restored):
        one.fold([r for r in WALK if r.t <= LAST_S and is_late(r)])
        assert one.settled() is not None
    assert tracker.estimates() == restored.estimates()


def test_once_all_is_caught_up_it_is_as_if_nothing_had_been_late() -> None:
    late, in_time = come_back(), KirchhoffTracker()
    in_time.fold([r for r in WALK if r.t <= LAST_S])
    settled = late.settled()
    assert settled is not None
    assert settled.estimates() == in_time.estimates()
    for second in range(LAST_S + 1, LAST_S + 21):
        for one in (late, in_time):
            one.fold([r for r in WALK if second - 1 < r.t <= second])
    for second in range(LAST_S + 21, 2 * LAST_S):
        for one in (late, in_time):
            one.fold([Node(t=float(second), node="ff1", role="responder")])
    assert late.settled() is None
    assert late.estimates() == in_time.estimates()
