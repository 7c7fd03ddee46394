"""Whatever valid readings say, and in whatever order, the tracker stays up and its numbers stay numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.evaluate import full_covariance
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.arbitrary import readings

if TYPE_CHECKING:
    from estimator.measurements import AnyReading


@settings(max_examples=250, deadline=None)
@given(st.lists(st.lists(readings, max_size=12), max_size=8), st.booleans())
def test_any_valid_readings_give_finite_estimates_and_covariances_that_are_positive(
    batches: list[list[AnyReading]], located: bool
) -> None:
    origin = (47.0, 8.0, 400.0) if located else None
    tracker = KirchhoffTracker(TrackerSettings(origin_wgs84=origin))
    for batch in batches:
        tracker.fold(batch)
        for estimate in tracker.estimates():
            if estimate.position_m is None:
                continue
            assert np.isfinite(estimate.position_m).all()
            if estimate.covariance_m2 is not None:
                covariance = full_covariance(np.array([estimate.covariance_m2]))[0]
                assert np.isfinite(covariance).all()
                assert (np.linalg.eigvalsh(covariance) >= -1e-6 * np.trace(covariance)).all()
    names = [e.node for e in tracker.estimates()]
    for a in names:
        tracker.relative(a, names[0])
    tracker.take_notices()
    restored = KirchhoffTracker.restore(tracker.snapshot())
    assert restored.estimates() == tracker.estimates()
    assert restored.counts() == tracker.counts()
