"""Where somebody is shown whose newest readings no displacement has covered yet."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE
from tests.estimator.trackers.entry import BASE, off_m, shown, squared_error, step

ENTERS = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.05, heading_rad=0.0)
FAR_NORTH = Node(t=0.0, node="a1", role="anchor", position_m=(0.0, 200.0, 0.0), sigma_m=0.01)
"""A range to it tells nothing of how far east somebody is."""
LAST_S = 20


def going(pace_m: Sequence[float], waiting: Sequence[AnyReading]) -> NodeEstimate:
    """A responder after twenty seconds at a pace, and what came after his last displacement."""
    tracker = KirchhoffTracker()
    tracker.fold([BASE, FAR_NORTH, ENTERS, *(step(float(t), pace_m) for t in range(1, LAST_S + 1))])
    tracker.fold(waiting)
    return shown(tracker)


def range_after(gap_s: float, east_m: float) -> Range:
    return Range(
        t=LAST_S + gap_s, a="ff1", b="a1", range_m=math.hypot(east_m, 200.0), sigma_m=1.0, technology="uwb"
    )


def sigma_m(found: NodeEstimate) -> float:
    assert found.covariance_m2 is not None
    return math.sqrt(found.covariance_m2[0] + found.covariance_m2[3])


@pytest.mark.parametrize("gap_s", [0.3, 0.6, 0.9])
def test_who_walks_is_shown_as_having_walked_on(gap_s: float) -> None:
    east_m = LAST_S + gap_s
    found = going((1.0, 0.0, 0.0), [range_after(gap_s, east_m)])
    assert found.t == LAST_S + gap_s
    assert off_m(found, (east_m, 0.0)) < 0.25


def test_the_ellipse_of_who_stands_does_not_swell_with_each_reading_that_comes_before_his_next_report() -> (
    None
):
    still = (0.0, 0.0, 0.0)
    told, waiting = going(still, []), going(still, [range_after(0.9, 0.0)])
    assert sigma_m(waiting) < math.hypot(sigma_m(told), 0.35)


def test_who_has_been_silent_may_have_gone_anywhere() -> None:
    found = going((1.0, 0.0, 0.0), [range_after(8.0, LAST_S)])
    assert sigma_m(found) > 2.0


def test_what_is_foreseen_for_a_picture_is_never_held_against_what_is_told_later() -> None:
    asked, unasked = KirchhoffTracker(), KirchhoffTracker()
    for tracker in (asked, unasked):
        tracker.fold([BASE, FAR_NORTH, ENTERS])
    for t in range(1, LAST_S):
        for tracker in (asked, unasked):
            tracker.fold([step(float(t), (1.0, 0.0, 0.0)), Range(t=t + 0.9, a="ff1", b="a1", range_m=200.0)])
        asked.estimates()
    assert asked.estimates() == unasked.estimates()


def seldom(heard: Sequence[AnyReading]) -> NodeEstimate:
    """Who walks for forty seconds at a metre a second, told each eight of them, and what came after that."""
    tracker = KirchhoffTracker()
    ways = [
        Displacement(t=t + 8.0, from_t=t, node="ff1", delta_m=(8.0, 0.0, 0.0))
        for t in (0.0, 8.0, 16.0, 24.0, 32.0)
    ]
    tracker.fold([BASE, FAR_NORTH, ENTERS, *ways])
    tracker.fold(heard)
    return shown(tracker)


def north_of_him(t: float) -> Range:
    """It tells nothing of how far east he is."""
    return Range(t=t, a="ff1", b="a1", range_m=math.hypot(t, 200.0), sigma_m=1.0, technology="uwb")


@pytest.mark.parametrize("gap_s", [1.0, 3.0, 6.0])
def test_whose_unit_reports_seldom_goes_on_between_two_reports_and_the_picture_says_how_unsure_that_is(
    gap_s: float,
) -> None:
    """He may have turned a corner in the middle of the newest one, or just now."""
    found = seldom([north_of_him(40.0 + second) for second in np.arange(1.0, gap_s + 0.5)])
    assert found.t == 40.0 + gap_s
    on_m = (40.0 + gap_s, 0.0)
    assert off_m(found, on_m) < 0.5 * gap_s + 0.5
    assert squared_error(found, on_m) < INSIDE
    assert squared_error(found, (40.0, gap_s)) < SURE


def test_who_is_heard_between_two_reports_is_known_no_better_than_by_what_is_heard() -> None:
    """Seconds of ranges do not add up as if his way meanwhile were known."""
    one = seldom([north_of_him(46.0)])
    many = seldom([north_of_him(40.0 + 0.5 * k) for k in range(1, 13)])
    assert one.covariance_m2 is not None
    assert many.covariance_m2 is not None
    assert many.covariance_m2[3] > 0.3 * one.covariance_m2[3]


def test_who_has_drifted_since_his_last_report_does_not_go_on_as_it_told() -> None:
    """His unit is silent: ranges alone tell where he goes."""
    stays = north_of_him(40.0)
    found = seldom([replace(stays, t=40.0 + second) for second in range(1, 31)])
    assert squared_error(found, (40.0, 0.0)) < SURE
    assert sigma_m(found) > 3.0
