"""Readings of raw samples that overlap those before."""

import numpy as np
import pytest

from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.inertial.gait import AROUND, walked

GAIT = walked(AROUND, 1000.0).noisy(np.random.default_rng(3))
BEGINS = Node(t=1000.0, node="ff1", role="responder", position_m=(5.0, -3.0, 0.0), sigma_m=0.1)


@pytest.mark.parametrize("step", [100, 200])
def test_a_reading_of_which_a_part_is_new_counts_and_needs_no_notice(step: int) -> None:
    readings = [GAIT.imu(first, first + 300) for first in range(0, len(GAIT.t) - 300, step)]
    tracker = KirchhoffTracker()
    tracker.fold([BEGINS, *readings])
    assert tracker.counts()["fused"] == len(readings) + 1
    assert tracker.counts()["not_fused"] == 0
    assert tracker.take_notices() == []
