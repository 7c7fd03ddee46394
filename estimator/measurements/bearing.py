"""`bearing`: the direction in which one node sees another."""

from typing import Literal

import numpy as np

from estimator.graph.dense import Array
from estimator.measurements.base import AngleRad, PairReading, SigmaRad
from estimator.measurements.range import PairJacobian


class Bearing(PairReading, tag="bearing", frozen=True):
    """The horizontal direction of `b` seen from `a`.

    Attributes:
        bearing_rad: direction (rad), anticlockwise.
        sigma_rad: standard deviation (rad).
        frame: `enu` counts from east, `body` from the heading of `a`.
    """

    bearing_rad: AngleRad
    sigma_rad: SigmaRad | None = None
    frame: Literal["enu", "body"] = "enu"


NEAR_M = 0.3


def predict_bearing(a: Array, b: Array, heading_rad: Array) -> PairJacobian:
    """Horizontal direction of `b` from `a`, less the heading of `a`; by_extra: derivative by that heading.

    Nearer than an arm's length the direction is undefined: there the Jacobian falls to 0 instead.

    Args:
        a: positions, m × 3 (m).
        b: positions, m × 3 (m).
        heading_rad: what the bearing is counted from, from east, m (rad).
    """
    difference = b - a
    squared = difference[:, 0] ** 2 + difference[:, 1] ** 2 + NEAR_M**2
    by_b = np.column_stack([-difference[:, 1], difference[:, 0], np.zeros(len(a))]) / squared[:, None]
    extra = np.column_stack([-np.ones(len(a)), np.zeros(len(a))])
    return PairJacobian(np.arctan2(difference[:, 1], difference[:, 0]) - heading_rad, -by_b, by_b, extra)


def wrap(angle_rad: Array) -> Array:
    """The same angles within −π to π."""
    return np.remainder(angle_rad + np.pi, 2.0 * np.pi) - np.pi
