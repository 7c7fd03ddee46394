"""`bearing`: the direction in which one node sees another."""

from typing import Literal

import numpy as np
from numba import njit

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


@njit(cache=True)
def predict_bearing(a: Array, b: Array, heading_rad: Array) -> PairJacobian:
    """Horizontal direction of `b` from `a`, less the heading of `a`; by_extra: derivative by that heading.

    Nearer than an arm's length the direction is undefined: there the Jacobian falls to 0 instead.

    Args:
        a: positions, m × 3 (m).
        b: positions, m × 3 (m).
        heading_rad: what the bearing is counted from, from east, m (rad).
    """
    m = len(a)
    predicted, by_a, by_b, by_extra = np.empty(m), np.zeros((m, 3)), np.zeros((m, 3)), np.zeros((m, 2))
    for i in range(m):
        e, n = b[i, 0] - a[i, 0], b[i, 1] - a[i, 1]
        squared = e * e + n * n + NEAR_M * NEAR_M
        by_b[i, 0], by_b[i, 1] = -n / squared, e / squared
        by_a[i, 0], by_a[i, 1] = n / squared, -e / squared
        by_extra[i, 0] = -1.0
        predicted[i] = np.arctan2(n, e) - heading_rad[i]
    return PairJacobian(predicted, by_a, by_b, by_extra)


@njit(cache=True)
def wrap(angle_rad: Array) -> Array:
    """The same angles within −π to π."""
    return np.remainder(angle_rad + np.pi, 2.0 * np.pi) - np.pi
