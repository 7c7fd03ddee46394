"""The online pass over an incident: what its solution as a whole starts from."""

import math
from collections.abc import Sequence

import numpy as np

from estimator.fusion.state import FusionState
from estimator.fusion.tick import flush, fold_tick
from estimator.graph.dense import Array
from estimator.measurements import AnyReading


class Pace:
    """The fusion after all readings, and where its moving nodes were on the way.

    Attributes:
        state: the fusion after all readings.
        poses: of each moving node, second by second: epoch, whether by its unit, position and unit errors or
            velocity, 6.
    """

    def __init__(self, state: FusionState) -> None:
        self.state = state
        self.poses: dict[str, list[tuple[float, bool, Array]]] = {}

    def keep(self) -> None:
        """Take down where everyone is now."""
        for name, node in self.state.nodes.items():
            if not node.moving:
                continue
            rest = node.unit if node.mode == "unit" else node.velocity
            value = np.concatenate([self.state.graph.value(node.position), self.state.graph.value(rest)])
            poses = self.poses.setdefault(name, [])
            if poses and node.pose_t <= poses[-1][0]:
                poses.pop()
            poses.append((node.pose_t, node.mode == "unit", value))

    def along(self, name: str, is_unit: bool, epochs: Array) -> Array:
        """States of one node at epochs (k), interpolated, k × 6."""
        poses = self.poses[name]
        t = np.array([p[0] for p in poses])
        values = np.array([p[2] for p in poses])
        other = np.array([p[1] != is_unit for p in poses])
        values[other, 3:] = values[~other][0, 3:] if not other.all() else 0.0
        return np.column_stack([np.interp(epochs, t, values[:, c]) for c in range(6)])


def online_pass(readings: Sequence[AnyReading], origin_wgs84: tuple[float, float, float] | None) -> Pace:
    """Fold the readings once, in ticks of a second.

    Args:
        readings: in canonical order.
        origin_wgs84: of the local origin, if known.
    """
    pace = Pace(FusionState(origin_wgs84))
    start = 0
    while start < len(readings):
        second = math.floor(readings[start].t) + 1
        end = start
        while end < len(readings) and readings[end].t < second:
            end += 1
        fold_tick(pace.state, float(second), readings[start:end])
        pace.keep()
        start = end
    flush(pace.state)
    pace.keep()
    return pace
