"""Whose unit dies while his radio goes on: powers alone tell where he is."""

import numpy as np
import pytest

from estimator.measurements.displacement import Displacement
from estimator.simulate import scenario
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside

DIES_S, END_S = 70, 200


@pytest.mark.parametrize("seed", [5, 41])
def test_he_is_followed_by_powers_and_not_surely_elsewhere(seed: int) -> None:
    """Held to a random walk, he fell behind, good powers were outliers of it, and his breadcrumbs shrank
    to where he was left: 20 m off, sure of two."""
    walked = scenario("paper-a", seed)
    told = [r for r in walked.readings if not (isinstance(r, Displacement) and r.t > DIES_S)]
    tracker, off = KirchhoffTracker(), list[float]()
    for second in range(END_S + 1):
        tracker.fold([reading for reading in told if second - 1 < reading.t <= second])
        (found,) = (e for e in tracker.estimates() if e.node == "ff1")
        if second > DIES_S:
            (true_m,) = walked.truth["ff1"].at(np.array([found.t]))
            off.append(outside(found.position_m, found.covariance_m2, true_m))
    assert sum(one > SURE for one in off) < 0.1 * len(off)
    assert sum(one < INSIDE for one in off) > 0.8 * len(off)
