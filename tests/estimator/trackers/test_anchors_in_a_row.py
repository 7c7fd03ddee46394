"""Whom anchors range that stand in a row, and who has no unit: nothing tells on which side of them he is."""

from functools import lru_cache

import numpy as np
import pytest

from estimator.fusion.images import mirrored
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside

ANCHORS_M = np.array([[0.0, 0.9, 2.0], [0.0, -0.9, 2.0], [0.0, 0.9, 0.5], [0.0, -0.9, 0.5]])
BESIDE_M = np.array([12.0, -3.0, 1.5])
"""A fifth anchor, where there is one."""
UP_M, SPEED_MPS, RATE_HZ, RANGE_SIGMA_M = 1.0, 1.3, 2, 0.05
TURNS_M = np.array([8.0, 16.0, 4.0, 16.0, 4.0, 16.0, -16.0])
"""To and fro on one side of the line, nearer to it than where he began, and then across: east (m)."""
SINCE_S, FIFTH_S, TOLD_S, UNTIL_S = 12, 64, 67, 70
"""It is asked where he is shown; a fifth anchor ranges him as well; has told the side; and the end."""
OTHER_SIDE = mirrored(np.zeros(2), 0.5 * np.pi)


def way() -> Array:
    """Where he is, twice a second, n × 2 (m)."""
    t = np.arange(UNTIL_S * RATE_HZ) / RATE_HZ
    gone_m = np.concatenate([[0.0], np.abs(np.diff(TURNS_M)).cumsum()])
    return np.stack([np.interp(SPEED_MPS * t, gone_m, TURNS_M), 4.0 + 3.0 * np.sin(t / 9.0)], axis=1)


def ranged(i: int, at_m: Array, anchors_m: Array, chance: np.random.Generator) -> list[AnyReading]:
    """His ranges to all anchors."""
    true_m = np.linalg.norm([*at_m, UP_M] - anchors_m, axis=1)
    return [
        Range(t=i / RATE_HZ, a="f", b=f"a{k}", range_m=range_m, technology="uwb")
        for k, range_m in enumerate((true_m + chance.normal(0.0, RANGE_SIGMA_M, len(true_m))).tolist())
    ]


@lru_cache
def followed(seed: int) -> tuple[Array, Array]:
    """How far outside his ellipse he and his image are, at the end of each second from `SINCE_S` on, k."""
    tracker, chance, places_m = KirchhoffTracker(), np.random.default_rng(seed), way()
    nodes: list[AnyReading] = [Node(t=0.0, node="f", role="responder")]
    for k, at in enumerate([*ANCHORS_M, BESIDE_M]):
        nodes.append(Node(t=0.0, node=f"a{k}", role="anchor", position_m=(*at.tolist(),), sigma_m=0.01))
    tracker.fold(nodes)
    here, there = list[float](), list[float]()
    for second in range(UNTIL_S):
        anchors_m = ANCHORS_M if second < FIFTH_S else np.array([*ANCHORS_M, BESIDE_M])
        for i in range(second * RATE_HZ, (second + 1) * RATE_HZ):
            tracker.fold(ranged(i, places_m[i], anchors_m, chance))
        (found,) = (one for one in tracker.estimates() if one.node == "f")
        at_m = places_m[round(found.t * RATE_HZ)]
        if second >= SINCE_S:
            here.append(outside(found.position_m, found.covariance_m2, at_m))
            there.append(outside(found.position_m, found.covariance_m2, OTHER_SIDE.of(at_m)))
    return np.array(here), np.array(there)


@pytest.mark.parametrize("seed", [0, 1])
def test_who_walks_across_their_line_may_still_be_on_either_side_of_it(seed: int) -> None:
    """Where his way and its image met they were taken for one: he was sure of a side from there on."""
    here, there = (squares[: FIFTH_S - SINCE_S] for squares in followed(seed))
    assert here.max() < SURE
    assert there.max() < SURE


@pytest.mark.parametrize("seed", [0, 1])
def test_an_anchor_that_stands_elsewhere_tells_the_side_within_seconds(seed: int) -> None:
    here, there = (squares[TOLD_S - SINCE_S :] for squares in followed(seed))
    assert here.max() < SURE
    assert there.min() > SURE
