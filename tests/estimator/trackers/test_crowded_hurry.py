"""Where there are many people, less that comes late makes a hurry, and nobody waits for the sure chain."""

import pytest

from estimator.fusion.holding import names_of
from estimator.fusion.memory.state import FusionState
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.smoothing.images.flip_ambiguity import HURRIED, LIVE, Effort
from estimator.smoothing.window_solution import refresh
from estimator.trackers.base import TrackerSettings
from estimator.trackers.catch_up import (
    BACKLOG_TICKS,
    BACKLOG_WORK,
    FOLLOWED_PER_TICK,
    PROMPT_TICKS,
    WAITED_TICKS,
    CatchUp,
)
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.walks import two_responders

LAST_S, LATE_S = 60, 25
CROWD: list[AnyReading] = [
    Node(t=0.0, node=f"ff{k}", role="responder", position_m=(-3.0 * k, 5.0, 0.0), sigma_m=0.3)
    for k in range(3, 9)
]
WALK = [*CROWD, *two_responders(LAST_S + WAITED_TICKS + 20)]


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
    for second in range(LAST_S + 1, LAST_S + WAITED_TICKS + 6):
        for one in (tracker, other):
            one.fold([r for r in WALK if second - 1 < r.t <= second])
        before = tracker._lag._sure.folded
        told = tracker.estimates()
        assert tracker._lag._sure.folded == before
        other.take_notices()
        follows = second > LAST_S + WAITED_TICKS
        assert (other._lag._sure.folded > before) == follows
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
    for second in range(LAST_S + 21, 2 * LAST_S + WAITED_TICKS):
        for one in (late, in_time):
            one.fold([Node(t=float(second), node="ff1", role="responder")])
    assert late.settled() is None
    assert late.estimates() == in_time.estimates()


AWAY = (1000, 1200)
"""Ticks between which nothing is heard of ff0."""


def back_again(people: int = 8) -> CatchUp:
    """All are heard of each tick, but ff0 only before and after he was away."""
    hurry = CatchUp()
    for k in range(people):
        hurry.meet(Node(t=0.0, node=f"ff{k}", role="responder"))
    for tick in range(AWAY[0] - 10, AWAY[1] + 1):
        hurry.advance(tick, tick)
        for k in range(people):
            if k or not AWAY[0] < tick < AWAY[1]:
                hurry.hear(f"ff{k}", tick)
    return hurry


def test_where_what_was_held_back_begins_to_come_there_is_a_hurry_before_it_is_in_time() -> None:
    hurry = back_again()
    assert not hurry.hurrying
    assert hurry.foresee("ff0", AWAY[0] + 1, AWAY[1])
    assert hurry.front == hurry.since == hurry.until == AWAY[1] - PROMPT_TICKS
    assert hurry.note_reading(AWAY[1] - 59, AWAY[1])
    assert hurry.front == AWAY[1] - 60


@pytest.mark.parametrize("heard_again", [True, False])
def test_whether_he_has_been_heard_again_does_not_matter(*, heard_again: bool) -> None:
    hurry = back_again()
    if not heard_again:
        hurry.silences.clear()
        hurry.heard["ff0"] = AWAY[0]
    assert hurry.foresee("ff0", AWAY[1] - BACKLOG_TICKS - 1, AWAY[1])


@pytest.mark.parametrize(
    ("node", "tick", "people"),
    [
        ("ff1", AWAY[0] + 1, 8),
        ("ff0", AWAY[0] - 50, 8),
        ("ff0", AWAY[0], 8),
        ("b1", AWAY[0] + 1, 8),
        ("ff0", AWAY[0] + 1, 1),
    ],
    ids=["was heard all the time", "a clock that is behind", "told already", "nobody", "alone"],
)
def test_what_comes_too_late_otherwise_makes_no_hurry(node: str, tick: int, people: int) -> None:
    hurry = back_again(people)
    assert not hurry.foresee(node, tick, AWAY[1])
    assert not hurry.hurrying


def test_a_silence_makes_one_hurry_and_no_more() -> None:
    hurry = back_again()
    assert hurry.foresee("ff0", AWAY[0] + 1, AWAY[1])
    for tick in range(AWAY[1] + 1, AWAY[1] + 200):
        hurry.advance(tick, tick)
        assert not hurry.foresee("ff0", AWAY[0] + 2, tick)
    assert not hurry.hurrying


def test_where_a_hurry_begins_the_sure_chain_waits_before_it_follows() -> None:
    hurry = back_again()
    hurry.note_reading(AWAY[1] - 60, AWAY[1])
    begun = hurry.front
    assert begun is not None
    for passed in (1, WAITED_TICKS - 1):
        hurry.advance((hurry.now or 0) + passed, AWAY[1] + 200)
        assert hurry.front == begun
    hurry.advance((hurry.now or 0) + 3, AWAY[1] + 200)
    assert hurry.front == begun + 3 * FOLLOWED_PER_TICK


def test_before_what_was_held_back_is_in_time_images_are_asked_about_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    efforts: set[Effort] = set()

    def noted(state: FusionState, solved_t: float, bent: bool = False, effort: Effort = LIVE) -> bool:
        efforts.add(effort)
        return refresh(state, solved_t, bent, effort)

    tracker, away_s, back_s = KirchhoffTracker(TrackerSettings(lag_s=20.0)), 10, 80
    walk = [*CROWD, *two_responders(back_s + 30)]
    held = [r for r in walk if away_s < r.t <= back_s and "ff2" in names_of(r)]
    in_time = [r for r in walk if r not in held]
    tracker.fold([r for r in in_time if r.t <= back_s])
    tracker.take_notices()
    monkeypatch.setattr("estimator.smoothing.window.refresh", noted)
    tracker.fold([r for r in held if r.t < back_s - 30.0])
    for second in range(back_s + 1, back_s + 15):
        tracker.fold([r for r in in_time if second - 1 < r.t <= second])
        tracker.estimates()
    assert efforts == {HURRIED}
    assert tracker.settled() is not None
    assert efforts == {HURRIED, LIVE}
