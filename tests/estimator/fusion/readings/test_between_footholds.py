"""Bearers of boots in pictures between two footholds, and what a radio at the chest tells of them."""

import math

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, outside
from tests.estimator.inertial.boot_motion import BootMotion
from tests.estimator.inertial.boot_navigation import entered
from tests.estimator.inertial.gait import Gait, Stride, walked

RADIOS_M = {
    "a1": (-4.0, -4.0, 2.0),
    "a2": (20.0, -4.0, 2.0),
    "a3": (20.0, 16.0, 2.0),
    "a4": (-4.0, 16.0, 2.0),
}
CHEST_M, SIGMA_M = 1.3, 0.1
BLOCK = [Stride()] * 8 + [Stride(0.9, 0.785)] * 2


def ranges(gait: Gait, chance: np.random.Generator) -> list[AnyReading]:
    """Three radios range to his chest twice a second."""
    found: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=place, sigma_m=0.05)
        for name, place in RADIOS_M.items()
    ]
    for i, (name, place) in enumerate(RADIOS_M.items()):
        for t in np.arange(0.3 + 0.13 * i, gait.t[-1], 0.5).tolist():
            chest_m = gait.bearer_m(t) + np.array([0.0, 0.0, CHEST_M])
            range_m = abs(float(np.linalg.norm(chest_m - place) + chance.normal(0.0, SIGMA_M)))
            found.append(Range(t=t, a="ff1", b=name, range_m=range_m, technology="uwb", sigma_m=SIGMA_M))
    return found


def pictures(readings: list[AnyReading], until_s: int) -> list[NodeEstimate]:
    """What is shown of him at each whole second."""
    tracker, shown = KirchhoffTracker(), list[NodeEstimate]()
    for second in range(1, until_s):
        tracker.fold([r for r in readings if max(math.ceil(r.until_t), 1) == second])
        shown += [e for e in tracker.estimates() if e.node == "ff1"]
    return shown


@pytest.mark.parametrize("seed", [30, 31])
def test_a_chest_is_where_it_is_said_to_be_while_the_boot_swings(seed: int) -> None:
    chance = np.random.default_rng(seed)
    gait = walked(BLOCK * 3, rests_s=3.0).noisy(chance)
    readings = [entered(0.0), *ranges(gait, chance), *gait.readings()]
    shown = pictures(readings, int(gait.t[-1]))
    off = [outside(e.position_m, e.covariance_m2, gait.bearer_m(e.t)) for e in shown]
    assert np.mean(np.array(off) < INSIDE) > 0.9
    smoothed = BatchSmoother(TrackerSettings()).smooth(readings)["ff1"]
    off = [outside(p.position_m, p.covariance_m2, gait.bearer_m(p.t)) for p in smoothed]
    assert np.mean(np.array(off) < INSIDE) > 0.9
    errors_m = [np.linalg.norm(np.array(p.position_m[:2]) - gait.bearer_m(p.t)[:2]) for p in smoothed]
    assert np.sqrt(np.mean(np.square(errors_m))) < 0.12


def test_a_picture_is_as_new_as_the_newest_sample_wherever_the_boot_is() -> None:
    gait = walked([Stride()] * 12).noisy(np.random.default_rng(1))
    tracker = KirchhoffTracker()
    tracker.fold([entered(0.0)])
    for reading in gait.readings(20):
        tracker.fold([reading])
        (shown,) = tracker.estimates()
        if reading.until_t > 1.0:
            assert shown.t == pytest.approx(reading.until_t, abs=0.01)
            assert shown.position_m is not None
            assert np.linalg.norm(np.array(shown.position_m) - gait.bearer_m(shown.t)) < 0.6


def test_who_crawls_without_setting_his_boot_down_does_not_freeze() -> None:
    gait = BootMotion(5).rests(2.0).works(7.0, by_m=0.05, by_rad=0.5).gait()
    tracker = KirchhoffTracker()
    tracker.fold([entered(0.0)])
    for reading in gait.readings():
        tracker.fold([reading])
        (shown,) = tracker.estimates()
        assert shown.t == pytest.approx(reading.until_t, abs=0.01)
        assert outside(shown.position_m, shown.covariance_m2, gait.place_m[-1]) < INSIDE
