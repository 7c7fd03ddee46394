"""Somebody who enters and walks, as his unit tells it, and where he is shown."""

import math
from collections.abc import Callable, Sequence

from estimator.estimate import NodeEstimate
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside

PACE_M = (0.8, 0.3)
EAST = (0.5, 0.0, 0.0)
Place = tuple[float, float]
BASE = Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))


def step(t: float, delta_m: Sequence[float] = (*PACE_M, 0.0)) -> Displacement:
    east, north, up = delta_m
    return Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(east, north, up), heading_rad=0.0)


def shown(tracker: KirchhoffTracker, node: str = "ff1") -> NodeEstimate:
    return next(estimate for estimate in tracker.estimates() if estimate.node == node)


def squared_error(found: NodeEstimate, at_m: Sequence[float] | Array) -> float:
    """Of his place, in what is said of it."""
    return outside(found.position_m, found.covariance_m2, at_m)


def off_m(found: NodeEstimate, at_m: Sequence[float] | Array) -> float:
    assert found.position_m is not None
    return math.dist(found.position_m[:2], at_m[:2])


def followed(readings: Sequence[AnyReading], since_t: int) -> list[tuple[int, NodeEstimate]]:
    """What is shown of him each second from one on (s), in which all that is older comes with the first."""
    tracker, found = KirchhoffTracker(), []
    tracker.fold([reading for reading in readings if reading.t < since_t])
    for second in range(since_t, max(int(reading.t) for reading in readings) + 1):
        tracker.fold([reading for reading in readings if int(reading.t) == second])
        found.append((second, shown(tracker)))
    return found


def surely_elsewhere(
    found: Sequence[tuple[int, NodeEstimate]], way: Callable[[int], Place], after_t: float = -math.inf
) -> list[int]:
    """The seconds after one (s) in which he is shown elsewhere, sure of it.

    Args:
        found: what is shown each second.
        way: where he is then.
        after_t: those until then do not count.
    """
    return [
        second
        for second, one in found
        if second > after_t and one.position_m is not None and squared_error(one, way(second)) > SURE
    ]
