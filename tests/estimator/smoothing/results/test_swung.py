"""Headings that are hardly known, in the smoothed view and its evidence."""

import math

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.drop import Drop
from estimator.measurements.rssi import Rssi
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from tests.estimator.ellipses import INSIDE, outside
from tests.estimator.fusion.motion.test_swings import WAY_M, ahead


def incident(heading_sigma_rad: float) -> list[AnyReading]:
    """Who walks 20 m straight ahead, drops a breadcrumb halfway, and hears it go."""
    heard = [
        Rssi(t=t, a="ff1", b="b1", dbm=-45.0 - 22.0 * math.log10(t - WAY_M / 2.0))
        for t in np.arange(WAY_M / 2.0 + 3.0, WAY_M + 1.0).tolist()
    ]
    return ahead(heading_sigma_rad, (Drop(t=WAY_M / 2.0, node="b1", by="ff1"), *heard))


@pytest.mark.parametrize("turned_rad", [0.0, 1.0, 2.0, 3.0])
def test_what_he_has_dropped_may_be_anywhere_around_as_he_may(turned_rad: float) -> None:
    tracks = BatchSmoother(TrackerSettings()).smooth(incident(math.pi))
    facing = np.array([np.cos(turned_rad), np.sin(turned_rad)])
    for point in tracks["ff1"]:
        assert outside(point.position_m, point.covariance_m2, point.t * facing) < INSIDE
    for point in tracks["b1"]:
        assert outside(point.position_m, point.covariance_m2, WAY_M / 2.0 * facing) < INSIDE


@pytest.mark.parametrize("node", ["ff1", "b1"])
@pytest.mark.parametrize("heading_sigma_rad", [0.05, math.pi])
def test_evidence_is_as_sure_as_the_smoothed_view(node: str, heading_sigma_rad: float) -> None:
    smoother, readings = BatchSmoother(TrackerSettings()), incident(heading_sigma_rad)
    evidence = smoother.evidence(readings, node)
    assert evidence is not None
    last = smoother.smooth(readings)[node][-1]
    assert evidence.position_m == pytest.approx(last.position_m, abs=1e-6)
    assert evidence.covariance_m2 == pytest.approx(last.covariance_m2, rel=0.02, abs=1e-4)
