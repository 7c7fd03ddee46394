"""What two gateways have heard of one radio, and both report."""

import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.walks import two_responders

WALK = two_responders(20)


def folded(*batches: list[AnyReading]) -> KirchhoffTracker:
    tracker = KirchhoffTracker()
    for batch in batches:
        tracker.fold(batch)
    return tracker


@pytest.mark.parametrize(
    "cut", [0, 100, len(WALK)], ids=["another gateway's batch", "a part of it", "twice in one"]
)
def test_what_two_gateways_have_heard_was_measured_once(cut: int) -> None:
    once, twice = folded(WALK), folded([*WALK, *WALK[:cut]], WALK[cut:])
    assert twice.estimates() == once.estimates()
    assert twice.counts()["received"] == 2 * len(WALK)


def test_a_copy_is_counted_as_not_fused() -> None:
    heard: list[AnyReading] = [reading for reading in WALK if not isinstance(reading, Displacement)]
    once, twice = folded(heard), folded(heard, heard[-30:])
    assert twice.counts()["fused"] == once.counts()["fused"]
    assert twice.counts()["not_fused"] == once.counts()["not_fused"] + 30
    assert twice.take_notices() == once.take_notices()


def test_smoothed_a_copy_tells_nothing_either() -> None:
    assert BatchSmoother().smooth([*WALK, *WALK]) == BatchSmoother().smooth(WALK)
