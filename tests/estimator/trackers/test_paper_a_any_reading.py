"""Paper A's system is restored, takes any order, and nothing brings it down."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.evaluate import full_covariance
from estimator.measurements import AnyReading
from estimator.trackers.base import TrackerSettings
from estimator.trackers.paper_a import PaperATracker
from tests.estimator.arbitrary import readings
from tests.estimator.paper_a.folding import folded
from tests.estimator.walks import two_responders

WALK = two_responders(50)


def test_readings_of_one_batch_may_stand_in_any_order() -> None:
    by_name = {e.node: e for e in folded(WALK).estimates()}
    assert {e.node: e for e in folded(WALK[::-1]).estimates()} == by_name


@pytest.mark.parametrize("cut", [0, 1, 40, 120, 200])
def test_a_tracker_restored_from_a_snapshot_goes_on_to_the_last_bit(cut: int) -> None:
    whole = folded(WALK[:cut])
    restored = PaperATracker.restore(whole.snapshot())
    for tracker in (whole, restored):
        tracker.fold(WALK[cut:])
    assert restored.estimates() == whole.estimates()
    assert restored.counts() == whole.counts()
    assert restored.take_notices() == whole.take_notices()
    assert restored.snapshot() == whole.snapshot()


@settings(max_examples=250, deadline=None)
@given(st.lists(st.lists(readings, max_size=12), max_size=8), st.booleans())
def test_any_valid_readings_give_finite_estimates_and_covariances_that_are_positive(
    batches: list[list[AnyReading]], located: bool
) -> None:
    origin = (47.0, 8.0, 400.0) if located else None
    tracker = PaperATracker(TrackerSettings(origin_wgs84=origin))
    for batch in batches:
        tracker.fold(batch)
        for shown in tracker.estimates():
            if shown.position_m is None:
                continue
            assert np.isfinite(shown.position_m).all()
            covariance = full_covariance(np.array([shown.covariance_m2]))[0]
            assert np.isfinite(covariance).all()
            assert (np.linalg.eigvalsh(covariance) >= -1e-6 * np.trace(covariance)).all()
    names = [e.node for e in tracker.estimates()]
    for a in names:
        tracker.relative(a, names[0])
    counts = tracker.counts()
    assert counts["received"] == sum(len(batch) for batch in batches)
    assert counts["received"] == sum(n for what, n in counts.items() if what != "received")
    tracker.take_notices()
    restored = PaperATracker.restore(tracker.snapshot())
    assert restored.estimates() == tracker.estimates()
    assert restored.counts() == tracker.counts()
