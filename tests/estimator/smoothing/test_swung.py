"""Headings that are hardly known, in the smoothed view and its evidence."""

import math

import numpy as np
import pytest

from estimator.estimate import TrackPoint
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother

INSIDE = 5.99
WAY_M = 20.0


def incident(heading_sigma_rad: float) -> list[AnyReading]:
    """Who walks 20 m straight ahead, drops a breadcrumb halfway, and hears it go."""
    readings: list[AnyReading] = [
        Node(
            t=0.0,
            node="ff1",
            role="responder",
            position_m=(0.0, 0.0, 0.0),
            sigma_m=0.1,
            heading_sigma_rad=heading_sigma_rad,
        ),
        Drop(t=WAY_M / 2.0, node="b1", by="ff1"),
    ]
    for t in np.arange(1.0, WAY_M + 1.0).tolist():
        readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0)))
        if t > WAY_M / 2.0 + 2.0:
            dbm = -45.0 - 22.0 * math.log10(t - WAY_M / 2.0)
            readings.append(Rssi(t=t, a="ff1", b="b1", dbm=dbm))
    return readings


def outside(point: TrackPoint, place_m: tuple[float, float]) -> float:
    ee, en, _, nn, _, _ = point.covariance_m2
    off = np.array(point.position_m[:2]) - place_m
    return float(off @ np.linalg.solve([[ee, en], [en, nn]], off))


@pytest.mark.parametrize("turned_rad", [0.0, 1.0, 2.0, 3.0])
def test_what_he_has_dropped_may_be_anywhere_around_as_he_may(turned_rad: float) -> None:
    tracks = BatchSmoother(TrackerSettings()).smooth(incident(math.pi))
    facing = np.array([np.cos(turned_rad), np.sin(turned_rad)])
    for point in tracks["ff1"]:
        assert outside(point, tuple((point.t * facing).tolist())) < INSIDE
    for point in tracks["b1"]:
        assert outside(point, tuple((WAY_M / 2.0 * facing).tolist())) < INSIDE


@pytest.mark.parametrize("node", ["ff1", "b1"])
@pytest.mark.parametrize("heading_sigma_rad", [0.05, math.pi])
def test_evidence_is_as_sure_as_the_smoothed_view(node: str, heading_sigma_rad: float) -> None:
    smoother, readings = BatchSmoother(TrackerSettings()), incident(heading_sigma_rad)
    evidence = smoother.evidence(readings, node)
    assert evidence is not None
    last = smoother.smooth(readings)[node][-1]
    assert evidence.position_m == pytest.approx(last.position_m, abs=1e-6)
    assert evidence.covariance_m2 == pytest.approx(last.covariance_m2, rel=0.02, abs=1e-4)
