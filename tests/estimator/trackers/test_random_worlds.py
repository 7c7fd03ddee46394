"""Where radios are too few to tell where everybody is, nobody is shown elsewhere, and sure of it."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from estimator.estimate import Covariance6, Vector3
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.random_worlds import SECONDS, World, world

BEGUN_S = 5
WRONG_M, WRONG_SIGMAS = 1.5, 4.0
MOMENTS = 8
"""Seconds, over a whole crew, after which what nobody could tell before has been seen."""
HONEST = 3.0
WORLDS = (5, 8, 9, 14, 26, 28, 35, 38)


class Error(NamedTuple):
    """How far off somebody is shown: error, the larger half axis of what is said of it (m), NEES."""

    off_m: float
    said_m: float
    nees: float

    @property
    def wrong(self) -> bool:
        """Whether he is shown elsewhere, and sure of it."""
        return self.off_m > max(WRONG_M, WRONG_SIGMAS * self.said_m)


def error(place_m: Vector3, covariance_m2: Covariance6, true_m: Array) -> Error:
    """How far off a place is, east and north."""
    ee, en, _, nn, _, _ = covariance_m2
    matrix, off_m = np.array([[ee, en], [en, nn]]), np.array(place_m[:2]) - true_m
    largest_m2 = float(np.linalg.eigvalsh(matrix)[1])
    return Error(
        float(np.hypot(*off_m)), math.sqrt(largest_m2), 0.5 * float(off_m @ np.linalg.solve(matrix, off_m))
    )


def shown(there: World) -> list[Error]:
    """The errors of all responders as they are shown second by second."""
    tracker, found = KirchhoffTracker(TrackerSettings()), list[Error]()
    posted: dict[int, list[AnyReading]] = {}
    for reading in there.readings:
        posted.setdefault(int(reading.t), []).append(reading)
    for second in range(SECONDS):
        tracker.fold(posted.get(second, []))
        for one in tracker.estimates() if second >= BEGUN_S else ():
            if one.node in there.ways_m:
                assert one.position_m is not None
                assert one.covariance_m2 is not None
                true_m = there.ways_m[one.node][second]
                found.append(error(one.position_m, one.covariance_m2, true_m))
    return found


def smoothed(there: World) -> list[Error]:
    """Those of their smoothed tracks."""
    tracks = BatchSmoother(TrackerSettings()).smooth(there.readings)
    return [
        error(point.position_m, point.covariance_m2, way_m[int(point.t)])
        for who, way_m in there.ways_m.items()
        for point in tracks[who]
    ]


@pytest.mark.parametrize("seed", WORLDS)
def test_nobody_is_shown_elsewhere_and_sure_of_it(seed: int) -> None:
    errors = shown(world(seed))
    assert sum(one.wrong for one in errors) <= MOMENTS
    assert np.mean([one.nees for one in errors]) < HONEST


@pytest.mark.parametrize("seed", WORLDS)
def test_afterwards_nobody_is_said_to_have_been_elsewhere(seed: int) -> None:
    errors = smoothed(world(seed))
    assert not any(one.wrong for one in errors)
    assert np.mean([one.nees for one in errors]) < HONEST
