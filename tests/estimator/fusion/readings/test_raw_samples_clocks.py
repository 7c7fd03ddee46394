"""Firefighters whose units take more or fewer samples a second than they say."""

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.inertial.boot_navigation import BLOCK, entered, track_boot
from tests.estimator.inertial.gait import walked

START_T = 1000.0
FACES_RAD = 0.7


@pytest.mark.parametrize("pace", [0.9, 0.96, 0.98, 1.02, 1.04, 1.1])
def test_he_is_followed_by_the_true_rate_of_his_samples(pace: float) -> None:
    truth = walked(BLOCK * 3, START_T, heading_rad=FACES_RAD, rests_s=4.0)
    gait = truth.sampled(pace).noisy(np.random.default_rng(0), 0.003)
    notices, farthest_m = track_boot(truth, gait, entered(START_T, FACES_RAD))
    assert farthest_m < 0.6
    assert [notice.code for notice in notices] == ["conflict"]
    assert float(notices[0].text.split()[4]) == pytest.approx(200.0 / pace, abs=0.4)


@pytest.mark.parametrize("cut", [2, 6, 14])
def test_what_is_learned_of_a_clock_is_in_a_snapshot(cut: int) -> None:
    gait = walked(BLOCK * 3, START_T, heading_rad=FACES_RAD).sampled(0.96)
    readings: list[AnyReading] = [
        entered(START_T, FACES_RAD),
        *gait.noisy(np.random.default_rng(0)).readings(),
    ]
    whole = KirchhoffTracker()
    whole.fold(readings[:cut])
    restored = KirchhoffTracker.restore(whole.snapshot())
    for tracker in (whole, restored):
        tracker.fold(readings[cut:])
    assert restored.estimates() == whole.estimates()
    assert restored.snapshot() == whole.snapshot()
