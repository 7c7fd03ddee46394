"""What a live picture shows of people, second by second, and whether they are there."""

from collections.abc import Mapping, Sequence

import numpy as np

from estimator.estimate import TrackPoint
from estimator.measurements import AnyReading
from estimator.simulate.base import TrueTrack
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside


def followed(
    readings: Sequence[AnyReading], names: Sequence[str], seconds: int
) -> dict[str, list[TrackPoint]]:
    """What is shown of each, second by second; readings come in order."""
    tracker = KirchhoffTracker()
    points: dict[str, list[TrackPoint]] = {name: [] for name in names}
    coming = list(readings)
    for second in range(1, seconds + 1):
        now = [reading for reading in coming if reading.until_t <= second]
        coming = coming[len(now) :]
        tracker.fold(now)
        for e in tracker.estimates():
            if e.node in points and e.position_m is not None and e.covariance_m2 is not None:
                points[e.node].append(
                    TrackPoint(t=e.t, position_m=e.position_m, covariance_m2=e.covariance_m2)
                )
    return points


def surely_elsewhere(points: Mapping[str, Sequence[TrackPoint]], tracks: Mapping[str, TrueTrack]) -> int:
    """For how many seconds, of all people, somebody is shown elsewhere, and sure of it."""
    return sum(squared > SURE for squared in _squared(points, tracks))


def inside(points: Mapping[str, Sequence[TrackPoint]], tracks: Mapping[str, TrueTrack]) -> float:
    """The share of all seconds of all people in which somebody is inside the 95 % ellipse."""
    squared = _squared(points, tracks)
    return sum(one <= INSIDE for one in squared) / len(squared)


def _squared(points: Mapping[str, Sequence[TrackPoint]], tracks: Mapping[str, TrueTrack]) -> list[float]:
    return [
        outside(point.position_m, point.covariance_m2, track.at(np.array([point.t]))[0])
        for name, track in tracks.items()
        for point in points[name]
    ]
