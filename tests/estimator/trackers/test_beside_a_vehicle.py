"""Who walks about a vehicle whose anchors stand close together: centimetres of theirs are metres of him."""

import math

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.walks import from_goal_to_goal

ANCHORS_M = np.array([[0.7, 0.9, 0.5], [2.6, 0.9, 2.0], [2.6, -0.9, 2.0], [2.6, -0.9, 0.5]])
SECONDS, RATE_HZ, SPEED_MPS, UP_M, FAR_M = 40, 10, 1.1, 1.0, 25.0
RANGE_SIGMA_M, LASTING_S = 0.02, 3.0


def way(seed: int) -> Array:
    """From goal to goal on all sides of the vehicle: where he is ten times a second, n × 2 (m)."""
    chance, start = np.random.default_rng(seed), np.array([-2.6, -4.3])
    return from_goal_to_goal(
        chance, start, (-FAR_M, FAR_M), SPEED_MPS / RATE_HZ, near_m=1.0, steps=SECONDS * RATE_HZ
    )


def measured(seed: int, anchors_m: float, lasting_m: float) -> list[AnyReading]:
    """Ranges to all anchors from each place, and who they are; nobody tells where he begins.

    Args:
        seed: of all that is drawn.
        anchors_m: what the ranges of each anchor are off by all the time, one standard deviation (m).
        lasting_m: what those of each link are off by for some seconds at a time (m).
    """
    chance = np.random.default_rng(seed + 1000)
    readings: list[AnyReading] = [Node(t=0.0, node="f", role="responder")]
    for k, place in enumerate(ANCHORS_M.tolist()):
        readings.append(Node(t=0.0, node=f"a{k}", role="anchor", position_m=tuple(place), sigma_m=0.01))
    always_m, kept = anchors_m * chance.normal(0.0, 1.0, 4), math.exp(-1.0 / (RATE_HZ * LASTING_S))
    lasting = chance.normal(0.0, 1.0, 4)
    for i, at in enumerate(way(seed)):
        lasting = kept * lasting + math.sqrt(1.0 - kept**2) * chance.normal(0.0, 1.0, 4)
        off_m = always_m + lasting_m * lasting + RANGE_SIGMA_M * chance.normal(0.0, 1.0, 4)
        true_m = np.linalg.norm([*at, UP_M] - ANCHORS_M, axis=1)
        readings += [
            Range(t=i / RATE_HZ, a="f", b=f"a{k}", range_m=range_m, technology="uwb")
            for k, range_m in enumerate((true_m + off_m).tolist())
        ]
    return readings


@pytest.mark.parametrize(
    ("seed", "anchors_m", "lasting_m"), [(0, 0.03, 0.06), (2, 0.03, 0.06), (6, 0.03, 0.06), (6, 0.03, 0.0)]
)
def test_what_anchors_and_places_are_off_by_is_no_delay_of_his(
    seed: int, anchors_m: float, lasting_m: float
) -> None:
    """Taken for one, he was shown metres nearer to the vehicle for most of the time, and surely so."""
    tracker, places, squares = KirchhoffTracker(), way(seed), list[float]()
    readings = measured(seed, anchors_m, lasting_m)
    for second in range(1, SECONDS + 1):
        tracker.fold([r for r in readings if second - 1 <= r.t < second])
        for found in tracker.estimates():
            if found.node == "f" and found.position_m is not None:
                at = places[round(found.t * RATE_HZ)]
                squares.append(outside(found.position_m, found.covariance_m2, at))
    assert not [notice for notice in tracker.take_notices() if "antenna delay" in notice.text]
    assert len(squares) > 0.9 * (SECONDS - 5)
    assert (np.array(squares) > SURE).mean() < 0.15
