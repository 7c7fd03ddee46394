"""Ranges that are far too long, as echoes are: they say nothing of those that are not."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers import create, smoother
from estimator.trackers.base import TrackerSettings
from tests.estimator.ellipses import outside

ANCHORS_M = {"a0": (0.0, 0.0), "a1": (12.0, 0.0), "a2": (12.0, 8.0), "a3": (0.0, 8.0)}
"""On a vehicle, radios stand near each other."""
OFF_M = {"a0": 0.1, "a1": -0.1, "a2": -0.1, "a3": 0.1}
"""What each antenna makes of a range: the nearer two seem to be nearer, as a scale would have it."""
SECONDS, PER_S, SIGMA_M, ECHO_M = 60, 5, 0.03, 10.0
CORNER_S = 20.0
SURE = 20.0
"""Who is farther off, in squares of what is said, is shown elsewhere and sure of it."""


class Corner(NamedTuple):
    """From when on a radio is heard round a corner, and how much longer that is."""

    since_s: float
    longer_m: float


CORNERS = {"a0": Corner(10.0, 3.0), "a1": Corner(20.0, 5.0), "a3": Corner(35.0, 4.0)}
NOWHERE = Corner(math.inf, 0.0)


def at_m(t: float) -> tuple[float, float]:
    """Where somebody is who walks about forty metres off."""
    angle = 0.75 - t / 40.0
    return 6.0 + 40.0 * math.cos(angle), 4.0 + 40.0 * math.sin(angle)


def heard(seed: int, echoes: float) -> list[AnyReading]:
    """Ranges to a walker without PDR, of which a share are echoes."""
    chance = np.random.default_rng(seed)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*place, 0.0)) for name, place in ANCHORS_M.items()
    ]
    readings.append(Node(t=0.0, node="f", role="responder", position_m=(*at_m(0.0), 0.0), sigma_m=0.5))
    for t in np.arange(1, SECONDS * PER_S) / PER_S:
        for name, place in ANCHORS_M.items():
            off_m = OFF_M[name] + chance.normal(0.0, SIGMA_M)
            echo_m = chance.uniform(0.0, ECHO_M) if chance.random() < echoes else 0.0
            range_m = math.dist(at_m(t), place) + off_m + echo_m
            readings.append(Range(t=float(t), a="f", b=name, range_m=range_m, technology="uwb"))
    return readings


def behind_corners(readings: list[AnyReading]) -> list[AnyReading]:
    """The readings, those to three radios metres longer for twenty seconds each, to two of them at a time."""
    return [
        replace(r, range_m=r.range_m + CORNERS.get(r.b, NOWHERE).longer_m)
        if isinstance(r, Range) and 0.0 <= r.t - CORNERS.get(r.b, NOWHERE).since_s < CORNER_S
        else r
        for r in readings
    ]


def off_m(readings: list[AnyReading]) -> float:
    """Root mean square of how far off the smoothed way is (m)."""
    track = smoother("kirchhoff", TrackerSettings()).smooth(readings)["f"]
    return math.sqrt(sum(math.dist(p.position_m[:2], at_m(p.t)) ** 2 for p in track) / len(track))


@pytest.mark.parametrize("seed", range(3))
def test_echoes_among_sharp_ranges_do_not_make_the_others_be_taken_for_too_long(seed: int) -> None:
    in_sight, among_echoes = off_m(heard(seed, 0.0)), off_m(heard(seed, 0.3))
    assert among_echoes < in_sight + 0.1


@pytest.mark.parametrize("seed", range(2))
def test_echoes_that_last_lead_nobody_astray_who_has_no_unit(seed: int) -> None:
    """Each of their ranges is one outlier among others; together they would bend his way until they fit."""
    in_sight = heard(seed, 0.0)
    readings = behind_corners(in_sight)
    assert off_m(readings) < off_m(in_sight) + 0.3
    tracker = create("kirchhoff", TrackerSettings())
    for second in range(SECONDS):
        tracker.fold([r for r in readings if math.floor(r.t) == second])
        shown = next(e for e in tracker.estimates() if e.node == "f")
        assert outside(shown.position_m, shown.covariance_m2, at_m(shown.t)) < SURE


CORNERS_M = {"a0": (0.0, 0.0), "a1": (0.0, 4.0), "a2": (4.0, 4.0), "a3": (4.0, 0.0)}
HERE_M, IMAGE_M = (2.9, 3.6), (-2.9, 3.6)
"""Where somebody switches on, and his image beyond the wall between the first two radios."""


def begun_at(scatter_m: float) -> Vector3 | None:
    """Where who switches on is shown, whose ranges to `a2` are about as long as from his image."""
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*place, 0.0)) for name, place in CORNERS_M.items()
    ]
    readings.append(Node(t=0.0, node="f", role="responder"))
    for k in range(25):
        name = f"a{k % 4}"
        range_m = math.dist(HERE_M, CORNERS_M[name])
        if name == "a2":
            range_m = math.dist(IMAGE_M, CORNERS_M[name]) + scatter_m * (-1) ** (k // 4)
        readings.append(
            Range(t=0.1 + 0.12 * k, a="f", b=name, range_m=range_m, sigma_m=0.1, technology="uwb")
        )
    tracker = create("kirchhoff", TrackerSettings())
    tracker.fold(readings)
    return next(e.position_m for e in tracker.estimates() if e.node == "f")


def test_nobody_begins_where_ranges_in_sight_would_be_metres_too_short() -> None:
    """An echo is too long; that all others are too short is no better story, however often it is heard."""
    begun = begun_at(0.3)
    assert begun is not None
    assert math.dist(begun[:2], HERE_M) < 0.3


def test_where_an_echo_stays_the_same_it_is_waited_for_more() -> None:
    begun = begun_at(0.0)
    assert begun is None or math.dist(begun[:2], HERE_M) < 0.3
