"""One range that is wildly too long takes nobody away, and several that agree are believed."""

from collections.abc import Iterable

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker

PACE_M = 0.5
STANDS_M, SILENT_S = 10.0, 20.0


def step(t: float) -> Displacement:
    return Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(PACE_M, 0.0, 0.0))


def ranged(t: float, range_m: float) -> Range:
    return Range(t=t, a="ff1", b="base", range_m=range_m, sigma_m=0.3, technology="uwb")


def walked(with_ranges: bool) -> list[AnyReading]:
    """He walks ten metres away from the base in twenty seconds."""
    readings: list[AnyReading] = [
        Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
        Node(t=0.0, node="ff1", role="responder"),
    ]
    for t in range(1, 21):
        readings.append(step(float(t)))
        if with_ranges and t > 3:
            readings.append(ranged(float(t), PACE_M * t))
    return readings


def shown(readings: Iterable[AnyReading]) -> NodeEstimate:
    """Where he is shown after readings that have come one by one."""
    tracker = KirchhoffTracker()
    for reading in readings:
        tracker.fold([reading])
        tracker.estimates()
    return next(estimate for estimate in tracker.estimates() if estimate.node == "ff1")


def squared_error(found: NodeEstimate, east_m: float) -> float:
    """Of his place, in what is said of it; 9 is the 99th percentile."""
    assert found.position_m is not None
    assert found.covariance_m2 is not None
    ee, en, _, nn, *_ = found.covariance_m2
    off = np.array([found.position_m[0] - east_m, found.position_m[1]])
    return float(off @ np.linalg.solve(np.array([[ee, en], [en, nn]]), off))


@pytest.mark.parametrize("range_m", [60.0, 200.0])
def test_a_wild_range_after_a_silence_takes_nobody_there(range_m: float) -> None:
    found = shown([*walked(with_ranges=True), ranged(20.0 + SILENT_S, range_m)])
    assert found.position_m is not None
    assert found.position_m[0] < 0.5 * range_m
    assert squared_error(found, STANDS_M) < 9.0


@pytest.mark.parametrize("range_m", [30.0, 200.0])
def test_a_first_range_that_is_wild_bends_no_way(range_m: float) -> None:
    wild: list[AnyReading] = [step(21.0), ranged(21.0, range_m)]
    found = shown([*walked(with_ranges=False), *wild])
    assert squared_error(found, 10.5) < 9.0
    good: list[AnyReading] = [
        reading for k in range(1, 20) for reading in (step(21.0 + k), ranged(21.0 + k, 10.5 + PACE_M * k))
    ]
    found = shown([*walked(with_ranges=False), *wild, *good])
    assert found.position_m is not None
    assert found.position_m[0] == pytest.approx(20.0, abs=1.0)


def test_ranges_that_agree_after_a_silence_are_believed() -> None:
    """He has walked on while nothing was heard of him: nobody is shown for long where he no longer is."""
    since = 20.0 + SILENT_S
    away = [reading for k in range(8) for reading in (step(since + k), ranged(since + k, 25.0 + PACE_M * k))]
    found = shown([*walked(with_ranges=True), *away])
    assert found.position_m is not None
    assert np.hypot(*found.position_m[:2]) == pytest.approx(25.0 + PACE_M * 7.0, abs=1.0)
