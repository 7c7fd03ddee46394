"""What leads the filter far away is believed by the window as well."""

import math
from itertools import pairwise

import numpy as np
import pytest
from msgspec import structs

from estimator import trackers
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.position import Position
from estimator.trackers.base import Tracker, TrackerSettings
from tests.estimator.ellipses import outside
from tests.estimator.smoothing.windows import entered

STOOD_S = 20.4
WALKED_S = 100
FIXED_S = 0.4
"""So long before a step is reported the fix was taken: inside the step, not at its end."""


def walked(seconds: float, bias_radps: float, since_s: float = 0.0, steps: int = 1) -> list[Displacement]:
    """A metre a second to the east, as a unit reports it whose gyro has been biased from the start.

    Args:
        seconds: how long.
        bias_radps: of the gyro (rad/s).
        since_s: when it begins (s).
        steps: that are reported each second.
    """
    found = []
    for last_t, t in pairwise(np.linspace(since_s, since_s + seconds, round(steps * seconds) + 1).tolist()):
        turned_rad = -bias_radps * t
        delta_m = ((t - last_t) * math.cos(turned_rad), (t - last_t) * math.sin(turned_rad), 0.0)
        found.append(Displacement(t=t, node="ff1", delta_m=delta_m, from_t=last_t, heading_rad=turned_rad))
    return found


def stood(seconds: float, bias_radps: float) -> list[Displacement]:
    """The same while its bearer stands, ten times a second."""
    steps = walked(seconds, bias_radps, steps=10)
    return [structs.replace(step, delta_m=(0.0, 0.0, 0.0)) for step in steps]


def followed(readings: list[AnyReading]) -> Tracker:
    """The tracker after readings that came one by one."""
    tracker = trackers.create("kirchhoff", TrackerSettings())
    for reading in sorted(readings, key=lambda r: r.t):
        tracker.fold([reading])
        tracker.estimates()
    return tracker


def off(tracker: Tracker, east_m: float) -> tuple[float, float]:
    """How far off the responder is shown, in metres, and squared by what is said of it."""
    shown = next(e for e in tracker.estimates() if e.node == "ff1")
    assert shown.position_m is not None
    assert shown.covariance_m2 is not None
    error_m = math.hypot(shown.position_m[0] - east_m, shown.position_m[1])
    return error_m, outside(shown.position_m, shown.covariance_m2, (east_m, 0.0))


@pytest.mark.parametrize("bias_deg_per_s", [-0.4, 0.2, 0.4])
def test_who_has_stood_long_enough_walks_straight_on_though_nothing_is_heard(bias_deg_per_s: float) -> None:
    bias_radps = math.radians(bias_deg_per_s)
    stands, walks = stood(STOOD_S, bias_radps), walked(60.0, bias_radps, since_s=STOOD_S, steps=5)
    readings: list[AnyReading] = [entered(), *stands, *walks]
    error_m, squared = off(followed(readings), 60.0)
    assert error_m < 2.0
    assert squared < 9.0


@pytest.mark.parametrize("seed", range(4))
def test_a_fix_inside_a_step_is_believed_at_once_by_whom_a_biased_gyro_has_led_astray(seed: int) -> None:
    chance = np.random.default_rng(seed)
    true_m = np.array([WALKED_S - FIXED_S, 0.0, 0.0])
    place = tuple((true_m + chance.normal(0.0, 1.0, 3)).tolist())
    fix = Position(t=WALKED_S - FIXED_S, node="ff1", position_m=place, sigma_m=(1.0, 1.0, 1.0))
    tracker = followed([entered(), *walked(WALKED_S, math.radians(0.4)), fix])
    error_m, squared = off(tracker, float(WALKED_S))
    assert error_m < 4.0
    assert squared < 12.0
