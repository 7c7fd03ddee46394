"""What is believed of somebody's beginning gives way to what is told of it afterwards."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.bearing import Bearing
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, PACE_M, off_m, shown, squared_error, step

SURE_AND_WRONG = 20.0
FIX_SIGMA_M = (1.0, 1.0, 2.0)

More = Callable[[float, Array], Sequence[AnyReading]]


def seconds_wrong(began: Sequence[AnyReading], start_m: float, more: More, seconds: int = 40) -> list[int]:
    """The seconds in which somebody who sets out east of the base is shown elsewhere, sure of it."""
    tracker, wrong = KirchhoffTracker(), []
    tracker.fold(began)
    at = np.array([start_m, 0.0])
    for second in range(1, seconds + 1):
        at = at + PACE_M
        tracker.fold([step(float(second)), *more(float(second), at)])
        found = shown(tracker)
        if found.position_m is not None and squared_error(found, at) > SURE_AND_WRONG:
            wrong.append(second)
    assert off_m(shown(tracker), at) < 3.0
    return wrong


def fixes(since_t: float, first_off_m: float = 0.0) -> More:
    """A fix each second from `since_t` on, the first of them off to the west."""
    rng = np.random.default_rng(2)

    def told(t: float, at: Array) -> list[AnyReading]:
        if t < since_t:
            return []
        east, north, up = (np.append(at, 0.0) + rng.normal(0.0, FIX_SIGMA_M)).tolist()
        east -= first_off_m if t == since_t else 0.0
        return [Position(t=t, node="ff1", position_m=(east, north, up), sigma_m=FIX_SIGMA_M)]

    return told


def test_whose_first_fix_comes_with_his_first_step_was_never_at_the_base() -> None:
    assert seconds_wrong([BASE], 60.0, fixes(since_t=1.0)) == []


def test_who_was_taken_to_be_at_the_base_is_where_his_first_fix_is() -> None:
    assert seconds_wrong([BASE], 60.0, fixes(since_t=3.0)) == [1, 2]


def test_a_first_fix_that_all_others_contradict_is_given_up() -> None:
    assert len(seconds_wrong([BASE], 60.0, fixes(since_t=1.0, first_off_m=200.0))) <= 3


def test_one_wild_fix_takes_nobody_away() -> None:
    rng = np.random.default_rng(3)

    def told(t: float, at: Array) -> list[AnyReading]:
        east, north = (at + rng.normal(0.0, 1.0, 2)).tolist()
        wild = 80.0 if t in (20.0, 21.0) else 0.0
        return [Position(t=t, node="ff1", position_m=(east + wild, north, 0.0), sigma_m=FIX_SIGMA_M)]

    assert seconds_wrong([BASE], 0.0, told) == []


def test_who_was_taken_to_be_at_the_base_is_where_ranges_from_four_anchors_meet() -> None:
    places = {"a1": (0.0, 0.0), "a2": (60.0, -20.0), "a3": (60.0, 20.0), "a4": (120.0, 0.0)}
    rng = np.random.default_rng(4)

    def ranged(t: float, at: Array) -> list[AnyReading]:
        return [
            Range(
                t=t,
                a="ff1",
                b=name,
                range_m=math.dist(at, place) + abs(rng.normal(0.0, 0.1)),
                technology="uwb",
            )
            for name, place in places.items()
        ]

    anchors = [Node(t=0.0, node=n, role="anchor", position_m=(*p, 0.0)) for n, p in places.items()]
    assert len(seconds_wrong([BASE, *anchors], 60.0, ranged)) <= 1


def test_a_drop_does_not_put_him_at_the_origin_who_waits_for_ranges() -> None:
    places = {"a1": (100.0, 50.0), "a2": (60.0, 90.0), "a3": (50.0, 40.0)}
    tracker, at = KirchhoffTracker(), np.array([70.0, 60.0])
    tracker.fold([Node(t=0.0, node=n, role="anchor", position_m=(*p, 0.0)) for n, p in places.items()])
    for second in range(1, 20):
        t, at = float(second), at + PACE_M
        dropped = [Drop(t=t, node="b1", by="ff1")] if second == 2 else []
        ranges = [
            Range(t=t, a="ff1", b=name, range_m=math.dist(at, place), technology="uwb")
            for name, place in places.items()
        ]
        tracker.fold([step(t), *ranges, *dropped])
    assert off_m(shown(tracker), at) < 1.0


@pytest.mark.parametrize("copies", [1, 3])
def test_no_gateways_copies_of_one_bad_fix_take_anybody_from_where_he_was_told_to_enter(copies: int) -> None:
    entered = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.5)

    def told(t: float, at: Array) -> list[AnyReading]:
        east, north = at.tolist()
        bad = Position(t=t, node="ff1", position_m=(east, north + 60.0, 0.0), sigma_m=FIX_SIGMA_M)
        return [bad] * copies if t == 30.0 else []

    assert seconds_wrong([BASE, entered], 0.0, told) == []


def test_echoes_on_one_link_unsettle_nobody_who_was_taken_to_be_at_the_base() -> None:
    def ranged(t: float, at: Array) -> list[AnyReading]:
        echoes = (9.0, 9.1, 9.2) if t == 35.0 else ()
        lengths = [float(np.hypot(*at)) + more for more in (0.0, *echoes)[bool(echoes) :]]
        return [
            Range(t=t - 0.1 * i, a="ff1", b="base", range_m=length, technology="uwb")
            for i, length in enumerate(lengths)
        ]

    tracker, at, widths = KirchhoffTracker(), np.zeros(2), []
    tracker.fold([BASE])
    for second in range(1, 60):
        at = at + PACE_M
        tracker.fold([step(float(second)), *ranged(float(second), at)])
        covariance = shown(tracker).covariance_m2
        assert covariance is not None
        widths.append(math.sqrt(covariance[0] + covariance[3]))
    assert max(widths) < 10.0


def test_a_radio_that_ranges_have_placed_becomes_the_responder_that_it_is_said_to_be() -> None:
    places = {"a1": (0.0, 0.0), "a2": (40.0, 0.0), "a3": (0.0, 40.0), "a4": (40.0, 40.0)}
    tracker, at = KirchhoffTracker(), np.array([10.0, 20.0])
    tracker.fold(
        [BASE, *(Node(t=0.0, node=n, role="anchor", position_m=(*p, 0.0)) for n, p in places.items())]
    )
    for second in range(1, 40):
        t = float(second)
        if second > 5:
            at = at + PACE_M
        ranges = [
            Range(t=t, a=n, b="ff1", range_m=math.dist(at, p), technology="uwb") for n, p in places.items()
        ]
        tracker.fold([*ranges, *([step(t)] if second > 5 else [])])
        if second == 5:
            tracker.fold([Node(t=5.5, node="ff1", role="responder", callsign="E7-1")])
        found = shown(tracker)
        if second > 6:
            assert found.role == "responder"
            assert squared_error(found, at) < SURE_AND_WRONG
    assert off_m(shown(tracker), at) < 1.0


def test_fixes_that_are_all_off_alike_make_nobody_sure() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([BASE, Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=3.0)])
    for second in range(1, 181):
        fix = Position(t=float(second), node="ff1", position_m=(4.0, 0.0, 0.0), sigma_m=(3.0, 3.0, 5.0))
        tracker.fold([step(float(second), (0.0, 0.0, 0.0)), fix])
    assert squared_error(shown(tracker), (0.0, 0.0)) < 9.0


def test_an_altimeter_that_is_off_makes_no_storey_sure() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([BASE, Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=1.0)])
    for second in range(1, 61):
        height = Altitude(t=float(second), node="ff1", up_m=1.8, sigma_m=1.0)
        tracker.fold([step(float(second), (0.0, 0.0, 0.0)), height])
    covariance = shown(tracker).covariance_m2
    assert covariance is not None
    assert math.sqrt(covariance[5]) > 0.4


def test_bearings_from_who_may_have_turned_since_his_unit_fell_silent_are_set_aside() -> None:
    anchors = {"a1": (0.0, 30.0), "a2": (20.0, 20.0)}
    tracker = KirchhoffTracker()
    tracker.fold(
        [
            BASE,
            Node(
                t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3, heading_rad=0.0
            ),
            *(Node(t=0.0, node=n, role="anchor", position_m=(*p, 0.0)) for n, p in anchors.items()),
        ]
    )
    tracker.fold([step(float(second), (0.0, 0.5, 0.0)) for second in range(1, 21)])
    turned_rad = 1.2
    for second in range(26, 60):
        seen = [
            Bearing(
                t=float(second),
                a="ff1",
                b=name,
                bearing_rad=math.atan2(north - 10.0, east) - turned_rad,
                sigma_rad=0.05,
                frame="body",
            )
            for name, (east, north) in anchors.items()
        ]
        tracker.fold(seen)
    assert off_m(shown(tracker), (0.0, 10.0)) < 3.0
    assert "not_fused" in {notice.code for notice in tracker.take_notices()}
