"""Whose tag is below, or above, the plane of all radios that range it: distances alone tell its height."""

import math

import numpy as np
import pytest

from estimator.estimate import TrackPoint
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import outside
from tests.estimator.trackers.test_antenna_delays import SURE

ROOF_M = 2.0
CORNERS_M = np.array([[-2.2, 0.9], [2.2, 0.9], [2.2, -0.9], [-2.2, -0.9]])
SECONDS, RATE_HZ, SPEED_MPS, FAR_M, SIGMA_M = 60, 10, 1.1, 12.0, 0.05
SURE_HEIGHT = 10.8
"""Squared error of a height that it exceeds once in a thousand."""


def way(seed: int) -> Array:
    """From goal to goal round the vehicle: where he is ten times a second, n × 2 (m)."""
    chance = np.random.default_rng(seed)
    at, goal, found = np.array([-2.6, -4.3]), np.array([-2.6, -4.3]), list[Array]()
    for _ in range(SECONDS * RATE_HZ):
        while np.hypot(*(goal - at)) < 1.0:
            goal = chance.uniform(-FAR_M, FAR_M, 2)
        at = at + (goal - at) / np.hypot(*(goal - at)) * SPEED_MPS / RATE_HZ
        found.append(at)
    return np.array(found)


def measured(seed: int, up_m: float, told_t: float = math.inf) -> list[AnyReading]:
    """Ranges from the roof's corners to a tag that stays at a height, which is told from an epoch on (s)."""
    chance = np.random.default_rng(seed + 1000)
    corners = [(*corner, ROOF_M) for corner in CORNERS_M.tolist()]
    readings: list[AnyReading] = [Node(t=0.0, node="f", role="responder")]
    readings += [Node(t=0.0, node=f"a{k}", role="anchor", position_m=p) for k, p in enumerate(corners)]
    for i, at in enumerate(way(seed).tolist()):
        t = i / RATE_HZ
        for k, corner in enumerate(corners):
            range_m = math.dist((*at, up_m), corner) + float(chance.normal(0.0, SIGMA_M))
            readings.append(Range(t=t, a="f", b=f"a{k}", range_m=range_m, technology="uwb"))
        if t >= told_t and i % RATE_HZ == 0:
            readings.append(Altitude(t=t, node="f", up_m=up_m + float(chance.normal(0.0, 0.3)), sigma_m=0.5))
    return readings


def shown(readings: list[AnyReading]) -> list[TrackPoint]:
    """Where he was shown, second by second."""
    tracker, found = KirchhoffTracker(), list[TrackPoint]()
    for second in range(1, SECONDS + 1):
        tracker.fold([r for r in readings if second - 1 <= r.t < second])
        found += [
            TrackPoint(t=e.t, position_m=e.position_m, covariance_m2=e.covariance_m2)
            for e in tracker.estimates()
            if e.node == "f" and e.position_m is not None and e.covariance_m2 is not None
        ]
    return found


def smoothed(readings: list[AnyReading]) -> list[TrackPoint]:
    """The same with all that is known afterwards."""
    return list(BatchSmoother().smooth(readings)["f"])


def errors(points: list[TrackPoint], seed: int) -> tuple[Array, Array]:
    """How far off he is on the plane (m), and its square by what is said."""
    places = way(seed)
    true = [places[min(round(p.t * RATE_HZ), len(places) - 1)] for p in points]
    off = [math.dist(p.position_m[:2], at) for p, at in zip(points, true, strict=True)]
    squares = [outside(p.position_m, p.covariance_m2, at) for p, at in zip(points, true, strict=True)]
    return np.array(off), np.array(squares)


def beyond(points: list[TrackPoint], up_m: float) -> int:
    """How often a height is said surely that is not his."""
    return sum((p.position_m[2] - up_m) ** 2 > SURE_HEIGHT * p.covariance_m2[5] for p in points)


@pytest.mark.parametrize("up_m", [0.3, 3.7])
@pytest.mark.parametrize("seed", [3, 4])
def test_what_a_height_makes_ranges_longer_by_moves_nobody_outwards(seed: int, up_m: float) -> None:
    """Held in the plane of the roof he was half a metre off for most of the time, and surely so."""
    readings = measured(seed, up_m)
    live, whole = shown(readings), smoothed(readings)
    assert len(live) > 0.9 * (SECONDS - 5)
    assert len(whole) >= SECONDS - 1
    for points, usual_m in ((live, 0.35), (whole, 0.25)):
        off_m, squares = errors(points, seed)
        assert math.sqrt((off_m**2).mean()) < usual_m
        assert (squares > SURE).mean() < 0.05


@pytest.mark.parametrize("up_m", [0.3, 3.7])
def test_above_the_plane_he_is_as_likely_as_below(up_m: float) -> None:
    readings = measured(3, up_m)
    for points in (shown(readings), smoothed(readings)):
        assert beyond(points, up_m) == 0
        assert max(math.sqrt(p.covariance_m2[5]) for p in points[len(points) // 2 :]) > 1.5


@pytest.mark.parametrize("up_m", [0.3, 3.7])
def test_an_altimeter_tells_on_which_side_he_is(up_m: float) -> None:
    readings = measured(3, up_m, told_t=30.0)
    live, whole = shown(readings), smoothed(readings)
    assert beyond(live, up_m) == 0
    assert beyond(whole, up_m) == 0
    assert abs(live[-1].position_m[2] - up_m) < 1.0
    assert max(abs(p.position_m[2] - up_m) for p in whole) < 1.0


def test_who_is_in_the_plane_stays_there() -> None:
    readings = measured(3, ROOF_M)
    for points in (shown(readings), smoothed(readings)):
        off_m, squares = errors(points, 3)
        assert math.sqrt((off_m**2).mean()) < 0.35
        assert (squares > SURE).mean() < 0.05
        assert beyond(points, ROOF_M) == 0
