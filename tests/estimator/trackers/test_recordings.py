"""Accuracy on public recordings, with one set of parameters and no truth in the readings."""

from pathlib import Path

import numpy as np

from estimator.evaluate import errors, full_covariance
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.recordings import each_second, hanyang, judged, plaza1


def test_plaza1_online_with_unknown_beacons_stays_within_2_4_m(shared_data: Path) -> None:
    """M: the plain filter's figure is 2.33 m, anchored at the first pose."""
    recording = plaza1(shared_data)
    tracker = KirchhoffTracker()
    found = judged(each_second(tracker, recording.readings, "robot"), recording.truth, recording.distance_m)
    assert found.rmse_m <= 2.4
    assert found.aligned_rmse_m <= 0.6
    placed = [e.node for e in tracker.estimates() if e.position_m is not None]
    assert sorted(placed) == ["beacon0", "beacon1", "beacon5", "beacon6", "robot"]


def test_plaza1_smoothed_is_aligned_within_30_cm(shared_data: Path) -> None:
    recording = plaza1(shared_data)
    points = BatchSmoother().smooth(recording.readings)["robot"]
    points = [p for p in points if recording.truth[0, 0] <= p.t <= recording.truth[-1, 0]]
    t = np.array([p.t for p in points])
    truth = np.column_stack([np.interp(t, recording.truth[:, 0], recording.truth[:, a]) for a in (1, 2, 3)])
    covariance = full_covariance(np.array([p.covariance_m2 for p in points]))
    found = errors(np.array([p.position_m for p in points]), truth, covariance, recording.distance_m)
    assert found.aligned_rmse_m <= 0.30


def test_walkers_without_pdr_are_followed_by_ranges_alone(shared_data: Path) -> None:
    """The recording's authors: 1.12 and 0.94 m with a Kalman filter on the same ranges and inertial data."""
    for walk, bound in (("LOS_A1", 1.12), ("NLOS_A1", 0.94)):
        recording = hanyang(shared_data, walk)
        shown = each_second(KirchhoffTracker(), recording.readings, "walker")
        assert judged(shown, recording.truth, recording.distance_m).rmse_m <= bound
