"""Headings that are hardly known, in the smoothed view and its evidence."""

import math

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.smoothing.results.heading_arcs import arc_excess_m2, widen_by_arcs
from estimator.smoothing.whole import solve_whole
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from tests.estimator.ellipses import INSIDE, outside
from tests.estimator.fusion.motion.test_heading_arcs import WAY_M, ahead
from tests.estimator.smoothing.windows import fused


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


def ranged_from_above() -> list[AnyReading]:
    """Who does so, and is ranged in the second half of his way from a mast above it."""
    facing, mast_m = np.array([math.cos(-0.8), math.sin(-0.8), 0.0]), np.array([-8.0, 11.0, 9.0])
    ranges: list[AnyReading] = [
        Range(t=t, a="ff1", b="mast", range_m=float(np.linalg.norm(t * facing - mast_m)), technology="uwb")
        for t in np.arange(WAY_M / 2.0, WAY_M - 3.0).tolist()
    ]
    mast = Node(t=0.0, node="mast", role="anchor", position_m=(-8.0, 11.0, 9.0), sigma_m=0.05)
    return [mast, *incident(math.pi), *ranges]


@pytest.mark.parametrize("readings", [incident(math.pi), incident(0.3), ranged_from_above()])
def test_places_and_the_next_ones_are_told_of_one_distribution(readings: list[AnyReading]) -> None:
    """So whatever lies between two keyframes has a covariance."""
    problem, solved, _ = solve_whole(fused(readings))
    layout = problem.layout
    solved.chain.solve()
    found = solved.chain.covariances()
    linear = found[0].copy()
    widen_by_arcs(layout, solved, found)
    keyframes, ahead, border = found
    (walk,) = layout.walks
    assert np.abs(keyframes[walk.last, 0, :3, :3] - linear[walk.last, 0, :3, :3]).max() > 0.1
    for k in range(walk.first, walk.last):
        together = ahead[k, 0, :3, :3]
        joint = np.block([[keyframes[k, 0, :3, :3], together], [together.T, keyframes[k + 1, 0, :3, :3]]])
        assert np.linalg.eigvalsh(joint)[0] > 0.0
    for start in layout.stands.values():
        assert np.linalg.eigvalsh(border[start : start + 3, start : start + 3])[0] > 0.0


def test_a_height_that_goes_by_the_heading_is_turned_with_its_place() -> None:
    """A place that is told to 0.1 m but for a heading that may be anything, 10 m away."""
    slopes, variance = np.array([0.0, 10.0, 0.5, 1.0]), 9.0
    told = slopes[:, None] * variance
    place = variance * np.outer(slopes[:3], slopes[:3]) + 0.1**2 * np.eye(3)
    turned = place + arc_excess_m2(told, [3], 0)
    assert np.linalg.eigvalsh(turned)[0] > 0.1**2 - 1e-9


@pytest.mark.parametrize("node", ["ff1", "b1"])
@pytest.mark.parametrize("heading_sigma_rad", [0.05, math.pi])
def test_evidence_is_as_sure_as_the_smoothed_view(node: str, heading_sigma_rad: float) -> None:
    smoother, readings = BatchSmoother(TrackerSettings()), incident(heading_sigma_rad)
    evidence = smoother.evidence(readings, node)
    assert evidence is not None
    last = smoother.smooth(readings)[node][-1]
    assert evidence.position_m == pytest.approx(last.position_m, abs=1e-6)
    assert evidence.covariance_m2 == pytest.approx(last.covariance_m2, rel=0.02, abs=1e-4)
