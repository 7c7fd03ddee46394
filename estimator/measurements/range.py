"""`range`: a measured distance between two nodes."""

from typing import Annotated, NamedTuple

import numpy as np
from msgspec import Meta
from numba import njit

from estimator.graph.dense import Array
from estimator.measurements.base import Identifier, PairReading, SigmaM

RangeM = Annotated[float, Meta(ge=0.0, le=100_000.0)]


class Range(PairReading, tag="range", frozen=True):
    """The distance from `a` to `b`.

    Attributes:
        range_m: distance (m).
        sigma_m: standard deviation (m).
        technology: `uwb`, `ultrasound`, `rtt` …: each has its own noise, bias and scale.
    """

    range_m: RangeM
    sigma_m: SigmaM | None = None
    technology: Identifier | None = None


NEAR_M = 1e-3


class PairJacobian(NamedTuple):
    """A predicted reading between two nodes, and its derivatives, for m readings.

    Attributes:
        predicted: h(x), m.
        by_a: derivatives by the position of `a`, m × 3.
        by_b: derivatives by the position of `b`, m × 3.
        by_extra: derivatives by the states of the technology, m × 2.
    """

    predicted: Array
    by_a: Array
    by_b: Array
    by_extra: Array


@njit(cache=True)
def range_slope(squared_m2: float, scale_error: float) -> float:
    """How a range grows with the distance, over the distance, at ‖a − b‖² (m²)."""
    slope: float = (1.0 + scale_error) / np.sqrt(squared_m2 + NEAR_M * NEAR_M)
    return slope


class Along(NamedTuple):
    """A predicted reading of two ends, and its slopes: by `b` it has those by `a`, the other way.

    Attributes:
        predicted: h(x).
        by_a: derivative by the position of `a`, less that of `b` (3): this many times it.
        by_first: derivative by the first state of the technology.
        by_second: derivative by the second one.
    """

    predicted: float
    by_a: float
    by_first: float
    by_second: float


@njit(cache=True)
def range_at(squared_m2: float, scale_error: float, bias_m: float) -> Along:
    """One range at ‖a − b‖² (m²); see `predict_range`."""
    distance, scale = np.sqrt(squared_m2 + NEAR_M * NEAR_M), 1.0 + scale_error
    return Along(scale * distance + bias_m, range_slope(squared_m2, scale_error), distance, 1.0)


@njit(cache=True)
def predict_range(a: Array, b: Array, scale_error: Array, bias_m: Array) -> PairJacobian:
    """Range that a technology with a scale and a bias of its own reports: (1 + k) ‖a − b‖ + c.

    Paper A's γ-noise range (before eq. 1, Jacobian eq. 19) with scale and bias as states. At distance 0
    the direction is undefined: there the Jacobian falls to 0 instead.

    Args:
        a: positions, m × 3 (m).
        b: positions, m × 3 (m).
        scale_error: k, m.
        bias_m: c, m (m).
    """
    m = len(a)
    predicted, by_a, by_b, by_extra = np.empty(m), np.empty((m, 3)), np.empty((m, 3)), np.ones((m, 2))
    for i in range(m):
        e, n, u = a[i, 0] - b[i, 0], a[i, 1] - b[i, 1], a[i, 2] - b[i, 2]
        found = range_at(e * e + n * n + u * u, scale_error[i], bias_m[i])
        along = found.by_a
        by_a[i, 0], by_a[i, 1], by_a[i, 2] = e * along, n * along, u * along
        by_b[i, 0], by_b[i, 1], by_b[i, 2] = -e * along, -n * along, -u * along
        by_extra[i, 0], predicted[i] = found.by_first, found.predicted
    return PairJacobian(predicted, by_a, by_b, by_extra)
