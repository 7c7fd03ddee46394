"""`bearing`: the direction in which one node sees another."""

from typing import Literal, NamedTuple

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


class Toward(NamedTuple):
    """A predicted bearing (rad), and its derivatives by the position of `a` (rad/m); by `b` the other way."""

    predicted: float
    by_e: float
    by_n: float


@njit(cache=True)
def bearing_at(east_m: float, north_m: float, heading_rad: float) -> Toward:
    """One bearing of what lies so far away; see `predict_bearing`."""
    squared = east_m * east_m + north_m * north_m + NEAR_M * NEAR_M
    return Toward(np.arctan2(north_m, east_m) - heading_rad, north_m / squared, -east_m / squared)


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
        found = bearing_at(e, n, heading_rad[i])
        by_a[i, 0], by_a[i, 1] = found.by_e, found.by_n
        by_b[i, 0], by_b[i, 1] = -found.by_e, -found.by_n
        by_extra[i, 0], predicted[i] = -1.0, found.predicted
    return PairJacobian(predicted, by_a, by_b, by_extra)


@njit(cache=True)
def wrap(angle_rad: Array) -> Array:
    """The same angles within −π to π."""
    return np.remainder(angle_rad + np.pi, 2.0 * np.pi) - np.pi


def within_pi(angle_rad: float) -> float:
    """One angle in [−π, π) (rad)."""
    return float((angle_rad + np.pi) % (2.0 * np.pi) - np.pi)
