"""A bearer of whose way both displacements and raw samples tell."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.fusion.readings.test_raw_samples import BEGINS, GAIT, START_T, incident, shown, truth_m


@pytest.mark.parametrize("begun", [True, False], ids=["since the last one", "with a beginning"])
@pytest.mark.parametrize("first", ["imu", "displacement"])
def test_of_two_units_that_tell_of_the_same_way_one_counts(first: str, begun: bool) -> None:
    seconds = range(int(START_T) + 1, int(GAIT.t[-1]))
    told: list[AnyReading] = []
    for t in seconds:
        way_m = truth_m(GAIT, float(t)) - truth_m(GAIT, t - 1.0)
        cosine, sine = math.cos(0.7), math.sin(0.7)
        ahead, left = (cosine * way_m[0] + sine * way_m[1], cosine * way_m[1] - sine * way_m[0])
        step = Displacement(t=float(t), node="ff1", delta_m=(float(ahead), float(left), float(way_m[2])))
        told.append(step if begun else replace(step, from_t=t - 1.0))
    later = told if first == "displacement" else told[8:]
    samples = incident() if first == "imu" else [r for r in incident() if r is BEGINS or r.t > START_T + 8.0]
    tracker = KirchhoffTracker()
    tracker.fold(sorted([*samples, *later], key=lambda r: r.t))
    estimate = shown(tracker)
    assert estimate.position_m is not None
    assert np.linalg.norm(np.array(estimate.position_m[:2]) - truth_m(GAIT, estimate.t)[:2]) < 1.5
    assert [notice.code for notice in tracker.take_notices()] == ["conflict"]
    assert tracker.counts()["not_fused"] >= len(later if first == "imu" else samples) - 2
