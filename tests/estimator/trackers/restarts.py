"""A tracker that is stopped on the way, and goes on from its snapshot."""

from collections.abc import Sequence

from estimator.measurements import AnyReading
from estimator.trackers.kirchhoff import KirchhoffTracker


def assert_goes_on_alike(readings: Sequence[AnyReading], stopped_t: float) -> None:
    """Assert that estimates are the same, then and after all readings, whether it was stopped or not (s)."""
    tracker = KirchhoffTracker()
    tracker.fold([r for r in readings if r.t <= stopped_t])
    again = KirchhoffTracker.restore(tracker.snapshot())
    assert again.estimates() == tracker.estimates()
    later = [r for r in readings if r.t > stopped_t]
    for one in (tracker, again):
        one.fold(later)
    assert again.estimates() == tracker.estimates()
