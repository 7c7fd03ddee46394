"""Somebody who enters and walks, as his unit tells it, and where he is shown."""

import math
from collections.abc import Sequence

import numpy as np

from estimator.estimate import NodeEstimate
from estimator.graph.dense import Array
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker

PACE_M = (0.8, 0.3)
BASE = Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))


def step(t: float, delta_m: Sequence[float] = (*PACE_M, 0.0)) -> Displacement:
    east, north, up = delta_m
    return Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(east, north, up), heading_rad=0.0)


def shown(tracker: KirchhoffTracker, node: str = "ff1") -> NodeEstimate:
    return next(estimate for estimate in tracker.estimates() if estimate.node == node)


def squared_error(found: NodeEstimate, at_m: Sequence[float] | Array) -> float:
    """Of his place, in what is said of it."""
    assert found.position_m is not None
    assert found.covariance_m2 is not None
    ee, en, _, nn, *_ = found.covariance_m2
    off = np.array(found.position_m[:2]) - np.array(at_m[:2])
    return float(off @ np.linalg.solve(np.array([[ee, en], [en, nn]]), off))


def off_m(found: NodeEstimate, at_m: Sequence[float] | Array) -> float:
    assert found.position_m is not None
    return math.dist(found.position_m[:2], at_m[:2])
