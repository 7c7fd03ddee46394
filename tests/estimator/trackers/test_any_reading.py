"""What every tracker promises: nothing valid brings it down, and a snapshot of it goes on."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator import trackers
from estimator.evaluate import full_covariance
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.range import Range
from estimator.trackers.base import TrackerSettings
from tests.estimator.arbitrary import readings
from tests.estimator.walks import two_responders

WALK = two_responders(50)


@pytest.mark.parametrize("name", trackers.TRACKERS)
@settings(max_examples=250, deadline=None)
@given(st.lists(st.lists(readings, max_size=12), max_size=8), st.booleans())
def test_any_valid_readings_give_finite_estimates_and_covariances_that_are_positive(
    name: str, batches: list[list[AnyReading]], located: bool
) -> None:
    origin = (47.0, 8.0, 400.0) if located else None
    tracker = trackers.create(name, TrackerSettings(origin_wgs84=origin))
    for batch in batches:
        tracker.fold(batch)
        for estimate in tracker.estimates():
            if estimate.position_m is None:
                continue
            assert np.isfinite(estimate.position_m).all()
            assert estimate.covariance_m2 is not None
            covariance = full_covariance(np.array([estimate.covariance_m2]))[0]
            assert np.isfinite(covariance).all()
            assert (np.linalg.eigvalsh(covariance) >= -1e-6 * np.trace(covariance)).all()
    names = [e.node for e in tracker.estimates()]
    for a in names:
        tracker.relative(a, names[0])
    assert tracker.counts()["received"] == sum(len(batch) for batch in batches)
    tracker.take_notices()
    restored = trackers.restore(name, tracker.snapshot())
    assert restored.estimates() == tracker.estimates()
    assert restored.counts() == tracker.counts()


@pytest.mark.parametrize("name", trackers.TRACKERS)
@pytest.mark.parametrize("cut", [0, 1, 40, 120, 200])
def test_a_tracker_restored_from_a_snapshot_goes_on_to_the_last_bit(name: str, cut: int) -> None:
    whole = trackers.create(name, TrackerSettings())
    whole.fold(WALK[:cut])
    restored = trackers.restore(name, whole.snapshot())
    assert restored.take_notices() == whole.take_notices()
    late = Range(t=max(WALK[cut].t - 3.0, 0.0), a="ff1", b="anchor", range_m=9.0)
    for tracker in (whole, restored):
        tracker.fold(WALK[cut:])
        tracker.fold([late])
    assert restored.estimates() == whole.estimates()
    assert restored.counts() == whole.counts()
    assert restored.take_notices() == whole.take_notices()
    assert restored.snapshot() == whole.snapshot()


def test_a_way_of_kilometres_in_no_time_brings_no_window_down() -> None:
    tracker = trackers.create("kirchhoff", TrackerSettings())
    tracker.fold(
        [
            Drop(t=0.0, node="base", by="ff2"),
            Displacement(t=1e-20, node="base", delta_m=(79028.0, 99998.0, 0.0)),
            Altitude(t=10.0, node="ff2", up_m=0.0),
        ]
    )
    assert np.isfinite([e.position_m for e in tracker.estimates() if e.position_m is not None]).all()
