"""Where somebody is shown whose newest readings no displacement has covered yet."""

import math
from collections.abc import Sequence

import pytest

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, off_m, shown, step

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
