"""Displacements that nobody can have walked, or that tell again what was told (decision 0107)."""

import math

import pytest
from msgspec import structs

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.fusion.readings.test_impossible_ranges import among_four

SECONDS, SOUND_S = 60, 20
SOUND, WAY_M = among_four({}, unit=True)
"""He goes round among four anchors, whose ranges are sound; where he is each second (m)."""


def leaps(step_m: float) -> list[AnyReading]:
    """His unit tells steps of so many metres from some time on."""
    return [
        structs.replace(reading, delta_m=(step_m, -step_m, step_m))
        if isinstance(reading, Displacement) and reading.t > SOUND_S
        else reading
        for reading in SOUND
    ]


@pytest.mark.parametrize("step_m", [1e3, 1e5])
def test_who_is_told_to_leap_is_shown_where_ranges_say_live_and_looking_back(step_m: float) -> None:
    shown_where_he_is(leaps(step_m))


def test_the_commander_is_told_what_was_reported_and_that_it_is_not_used() -> None:
    leap = notice_of(leaps(1e3), "faster than anyone runs")
    assert "1732.1 m" in leap
    assert "tells nothing" in leap


def test_a_gateway_that_tells_always_the_same_from_t_leads_nobody_astray() -> None:
    """Its displacements are those of a second, and said to be since the beginning."""
    readings = [
        structs.replace(reading, from_t=0.0) if isinstance(reading, Displacement) else reading
        for reading in SOUND
    ]
    shown_where_he_is(readings)
    assert "look at from_t of its gateway" in notice_of(readings, "reports again since 0.0 s")


def test_a_unit_that_sums_up_the_last_seconds_again_and_again_still_leads_its_bearer() -> None:
    """Each displacement covers two seconds, of which one was told before; nothing else is heard."""
    readings: list[AnyReading] = [Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))]
    for second in range(1, SECONDS + 1):
        span_s = min(second, 2)
        gone_m = (0.8 * span_s, 0.0, 0.0)
        readings.append(Displacement(t=second, from_t=second - span_s, node="ff1", delta_m=gone_m))
    tracker = KirchhoffTracker()
    tracker.fold(readings)
    (shown,) = tracker.estimates()
    assert shown.position_m is not None
    assert math.dist(shown.position_m[:2], (0.8 * SECONDS, 0.0)) < 0.5


def shown_where_he_is(readings: list[AnyReading]) -> None:
    """Live at the end, and looking back, he is where ranges say, or not surely elsewhere."""
    tracker = KirchhoffTracker()
    tracker.fold(readings)
    shown = next(e for e in tracker.estimates() if e.node == "ff1")
    assert shown.position_m is not None
    assert math.dist(shown.position_m[:2], WAY_M[-1]) < 1.0
    for point in BatchSmoother().smooth(readings)["ff1"]:
        assert outside(point.position_m, point.covariance_m2, WAY_M[round(point.t)]) < SURE


def notice_of(readings: list[AnyReading], words: str) -> str:
    """The first notice that has these words."""
    tracker = KirchhoffTracker()
    tracker.fold(readings)
    tracker.estimates()
    return next(notice.text for notice in tracker.take_notices() if words in notice.text)
