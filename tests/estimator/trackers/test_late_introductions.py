"""Who is introduced later than readings may be late: what he is counts, where he was then does not."""

import math
from collections.abc import Iterable, Sequence

import pytest
from msgspec.structs import replace

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node, Role
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, off_m, shown, squared_error, step

NOW = 400
ANCHORS = {"a1": (0.0, 20.0), "a2": (20.0, 0.0), "a3": (25.0, 25.0)}
PLACED = [Node(t=0.0, node=name, role="anchor", position_m=(*at, 0.0)) for name, at in ANCHORS.items()]


def told(t: float, role: Role, east: float | None = None, device: str | None = None) -> Node:
    where = None if east is None else (east, 5.0, 0.0)
    return Node(t=t, node="ff1", role=role, position_m=where, device=device)


def tracked(*batches: Iterable[AnyReading]) -> KirchhoffTracker:
    tracker = KirchhoffTracker()
    for batch in batches:
        tracker.fold(list(batch))
        tracker.estimates()
    return tracker


def quiet_until(t: float = NOW) -> list[AnyReading]:
    """Incident time goes on to an epoch (s)."""
    return [BASE, Displacement(t=t, node="other", delta_m=(0.0, 0.0, 0.0))]


def ranged(t: float, at: tuple[float, float]) -> list[AnyReading]:
    return [
        Range(t=t, a="ff1", b=name, range_m=math.dist(at, place), sigma_m=0.1, technology="uwb")
        for name, place in ANCHORS.items()
    ]


def said(tracker: KirchhoffTracker) -> list[str]:
    return [notice.text for notice in tracker.take_notices() if notice.code == "introduced_late"]


@pytest.mark.parametrize("role", ["anchor", "beacon", "breadcrumb", "base"])
def test_what_stands_is_where_it_was_told_to_be_however_late(role: Role) -> None:
    late, in_time = tracked(quiet_until(), [told(100.0, role, 5.0)]), tracked([told(100.0, role, 5.0)])
    assert shown(late) == shown(in_time)
    assert shown(late).position_m == (5.0, 5.0, 0.0)


def test_ranges_to_an_anchor_that_was_introduced_too_late_tell_where_somebody_is() -> None:
    tracker = KirchhoffTracker()
    for second in range(NOW - 30, NOW):
        tracker.fold(ranged(float(second), (10.0, 8.0)))
    assert shown(tracker).position_m is None
    tracker.fold([told(0.0, "responder"), *PLACED])
    tracker.fold([reading for s in range(NOW, NOW + 10) for reading in ranged(float(s), (10.0, 8.0))])
    assert off_m(shown(tracker), (10.0, 8.0)) < 0.3


def test_who_was_taken_for_a_breadcrumb_walks_once_it_is_told_who_he_is() -> None:
    tracker = tracked([BASE, *PLACED])

    def walk(since: int, until: int, reports: bool) -> None:
        for second in range(since, until):
            tracker.fold(ranged(float(second), (10.0 + 0.1 * second, 8.0)))
            if reports:
                tracker.fold([step(float(second), (0.1, 0.0, 0.0))])

    walk(0, 150, reports=False)
    assert shown(tracker).role == "breadcrumb"
    tracker.fold([told(0.0, "responder", 10.0)])
    walk(150, 200, reports=True)
    found, at = shown(tracker), (10.0 + 19.9, 8.0)
    assert found.role == "responder"
    assert off_m(found, at) < 0.5
    assert squared_error(found, at) < 9.0


def test_where_somebody_who_moves_was_and_what_he_faced_tells_nothing_of_him_now() -> None:
    late = Node(
        t=100.0,
        node="ff1",
        role="responder",
        position_m=(40.0, 5.0, 0.0),
        heading_rad=1.5,
        heading_sigma_rad=0.01,
    )
    walk = [step(float(second), (1.0, 0.0, 0.0)) for second in range(NOW - 5, NOW + 5)]
    introduced = tracked(quiet_until(), [late], walk)
    assert shown(introduced).position_m is None
    (text,) = said(introduced)
    assert text == (
        "ff1 was introduced too late, at t = 100: what counts is its role (responder),"
        " what does not is where it was then, what it faced then"
    )


def test_who_has_been_inside_for_long_begins_where_ranges_allow_and_not_at_the_base() -> None:
    tracker = tracked([*PLACED, *quiet_until()], [told(100.0, "responder", 5.0)])
    for second in range(NOW, NOW + 30):
        tracker.fold([step(float(second), (0.0, 0.1, 0.0))])
    assert shown(tracker).position_m is None
    for second in range(NOW + 30, NOW + 60):
        at = (18.0, 5.0 + 0.1 * (second - NOW))
        tracker.fold([*ranged(float(second), at), step(float(second), (0.0, 0.1, 0.0))])
    found = shown(tracker)
    assert off_m(found, (18.0, 10.9)) < 0.3
    assert squared_error(found, (18.0, 10.9)) < 9.0


def test_a_fix_tells_where_somebody_is_who_has_been_inside_for_long() -> None:
    fix = Position(t=NOW + 1.0, node="ff1", position_m=(30.0, 7.0, 0.0), sigma_m=(0.5, 0.5, 0.5))
    walk = [step(NOW + second, (0.1, 0.0, 0.0)) for second in range(1, 11)]
    tracker = tracked(quiet_until(), [told(100.0, "responder", 5.0)], [fix, *walk])
    assert off_m(shown(tracker), (30.9, 7.0)) < 1.0


def test_a_base_that_was_ranged_before_anybody_told_where_it_stands_is_there() -> None:
    tracker = tracked(PLACED, [Node(t=0.0, node="other", role="responder", position_m=(0.0, 0.0, 0.0))])
    for second in range(1, 200):
        moved = Displacement(t=float(second), node="other", delta_m=(0.1, 0.0, 0.0))
        tracker.fold([*ranged(float(second), (5.0, 5.0)), moved])
    assert shown(tracker).role == "breadcrumb"
    tracker.fold([told(0.0, "base", 5.0)])
    tracker.fold([reading for s in range(200, 230) for reading in ranged(float(s), (5.0, 5.0))])
    assert (shown(tracker).position_m, shown(tracker).covariance_m2) == ((5.0, 5.0, 0.0), (0.0,) * 6)
    assert [notice.code for notice in tracker.take_notices()] == ["introduced_late"]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_of_what_was_told_the_newer_place_counts_in_whatever_order_it_comes(order: Sequence[int]) -> None:
    places = [told(100.0, "anchor", 30.0), told(200.0, "anchor", 9.0)]
    came = [places[which] for which in order]
    together, one_by_one = tracked(quiet_until(), came), tracked(quiet_until(), *([one] for one in came))
    later = tracked(quiet_until(), came[:1], quiet_until(NOW + 50.0), came[1:])
    for tracker in (together, one_by_one, later):
        assert off_m(shown(tracker), (9.0, 5.0)) < 0.1


def test_a_place_that_was_told_in_time_is_older_than_one_told_too_late_of_a_later_epoch() -> None:
    in_time = told(150.0, "anchor", 9.0)
    older, newer = (
        tracked([BASE], [in_time], quiet_until(), [told(t, "anchor", 30.0)]) for t in (100.0, 200.0)
    )
    assert off_m(shown(older), (9.0, 5.0)) < 0.1
    assert off_m(shown(newer), (30.0, 5.0)) < 0.1
    assert [notice.code for notice in newer.take_notices()] == ["node_moved", "introduced_late"]


def test_a_name_that_was_put_right_tells_of_no_place() -> None:
    tracker = tracked([BASE], [told(150.0, "anchor")], quiet_until(), [told(100.0, "anchor", 9.0)])
    assert off_m(shown(tracker), (9.0, 5.0)) < 0.1


def test_a_breadcrumb_that_was_dropped_since_lies_where_it_was_dropped() -> None:
    walk = [step(float(second), (0.1, 0.0, 0.0)) for second in range(1, NOW)]
    dropped = Drop(t=200.0, node="b1", by="ff1")
    late = Node(t=100.0, node="b1", role="breadcrumb", position_m=(90.0, 0.0, 0.0), sigma_m=0.1)
    tracker = tracked([BASE, *walk, dropped], [late])
    assert off_m(shown(tracker, "b1"), (20.0, 0.0)) < 2.0
    (text,) = said(tracker)
    assert text.endswith("what counts is its role (breadcrumb), what does not is where it was then")


def test_what_was_told_in_time_of_what_a_node_is_stays() -> None:
    tracker = tracked([BASE], [told(150.0, "responder", 9.0)], quiet_until(), [told(200.0, "anchor", 30.0)])
    assert (shown(tracker).role, shown(tracker).position_m) == ("responder", (9.0, 5.0, 0.0))
    assert [notice.code for notice in tracker.take_notices()] == ["conflict"]
    later = tracked(quiet_until(), [told(200.0, "anchor")], [told(NOW + 1.0, "responder", 9.0)])
    assert shown(later).role == "responder"
    assert off_m(shown(later), (9.0, 5.0)) < 0.1


def test_who_has_left_comes_back_only_if_he_was_introduced_after_that() -> None:
    def after(introduced_t: float) -> KirchhoffTracker:
        left: list[AnyReading] = [told(0.0, "responder", 0.0), step(1.0), Retire(t=150.0, node="ff1")]
        reported = [step(NOW + 1.0, (0.0, 0.0, 0.0))]
        return tracked([BASE, *left], quiet_until(), [told(introduced_t, "responder", 0.0)], reported)

    before, since = after(100.0), after(200.0)
    assert shown(before).retired
    assert not shown(since).retired
    assert [notice.code for notice in since.take_notices()] == ["introduced_late", "came_back"]


def test_what_burned_was_what_is_told_of_it_afterwards() -> None:
    tracker = tracked(quiet_until(), [Retire(t=NOW - 1.0, node="ff1")], quiet_until(NOW + 100.0))
    assert (shown(tracker).role, shown(tracker).retired) == ("responder", True)
    tracker.fold([told(100.0, "breadcrumb")])
    assert (shown(tracker).role, shown(tracker).retired) == ("breadcrumb", True)


def test_another_unit_that_is_told_of_too_late_is_doubted_from_then_on() -> None:
    walk = [step(float(second), (0.1, 0.0, 0.0)) for second in range(1, NOW)]
    first = told(0.0, "responder", 0.0, device="u1")
    changed = tracked([BASE, first, *walk], [told(200.0, "responder", device="u2")])
    assert "unit_changed" in [notice.code for notice in changed.take_notices()]
    again = tracked([BASE, first, *walk], [told(200.0, "responder", device="u1")])
    assert again.take_notices() == []
    older = tracked([BASE, told(0.5, "responder", 0.0, device="u2"), *walk], [first])
    assert "unit_changed" not in [notice.code for notice in older.take_notices()]


def test_who_is_introduced_too_late_is_counted_once_and_told_of_once() -> None:
    tracker = tracked(quiet_until(), *([told(100.0 + s, "responder", 5.0)] for s in range(3)))
    counts = dict(tracker.counts())
    assert (counts["received"], counts["fused"], counts["too_late"]) == (5, 5, 0)
    (text,) = said(tracker)
    assert text.endswith("what counts is its role (responder), what does not is where it was then")


def test_a_gateway_that_repeats_an_introduction_too_late_tells_nothing_new() -> None:
    introduced = [told(0.0, "responder", 5.0, device="u1"), *PLACED]
    tracker = tracked([BASE, *introduced], quiet_until())
    before = shown(tracker)
    tracker.fold([replace(reading, t=100.0) for reading in introduced])
    assert shown(tracker) == before
    assert tracker.take_notices() == []


def test_a_snapshot_goes_on_with_who_was_introduced_too_late() -> None:
    batches: list[list[AnyReading]] = [
        quiet_until(),
        [told(100.0, "responder", 5.0, device="u1"), *PLACED],
        *([*ranged(float(s), (10.0, 8.0)), step(float(s), (0.0, 0.0, 0.0))] for s in range(NOW, NOW + 90)),
        [told(50.0, "responder", 5.0, device="u2")],
    ]
    straight, restarted = tracked(*batches), KirchhoffTracker()
    for batch in batches:
        restarted.fold(batch)
        restarted = KirchhoffTracker.restore(restarted.snapshot())
    asked_once = KirchhoffTracker()
    for batch in batches:
        asked_once.fold(batch)
    assert restarted.estimates() == straight.estimates() == asked_once.estimates()
    assert restarted.counts() == straight.counts() == asked_once.counts()
