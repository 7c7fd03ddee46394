"""`rssi`: how strongly one radio heard another."""

import math
from typing import Annotated

import numpy as np
from msgspec import Meta
from numba import njit

from estimator.graph.dense import Array
from estimator.measurements.base import PairReading
from estimator.measurements.range import Along, PairJacobian

PowerDbm = Annotated[float, Meta(ge=-200.0, le=100.0)]


class Rssi(PairReading, tag="rssi", frozen=True):
    """`a` heard `b`.

    Attributes:
        dbm: received power (dBm).
        tx_dbm: power that `b` sent with (dBm).
    """

    dbm: PowerDbm
    tx_dbm: PowerDbm | None = None


ANTENNA_M = 0.3
"""A boot passes a breadcrumb at about this distance; the logarithm stays finite."""
TOUCHING_M = 0.03
"""Antennas never coincide, nor are they nearer than this when one radio lies on the other."""
DB_PER_NEPER = 10.0 / math.log(10.0)
"""What a power of exponent 1 falls by with the natural logarithm of the distance."""
BESIDE, NEARER = DB_PER_NEPER * math.log(ANTENNA_M), DB_PER_NEPER * math.log(ANTENNA_M / TOUCHING_M)
"""What it falls by from 1 m to `ANTENNA_M`, and rises by from there to `TOUCHING_M` (dB)."""


@njit(cache=True)
def rssi_slope(squared_m2: float, exponent: float) -> float:
    """How a power grows with the distance, over the distance, at ‖a − b‖² (m²), in dB / m²."""
    slope: float = -DB_PER_NEPER * exponent / (squared_m2 + ANTENNA_M * ANTENNA_M)
    return slope


@njit(cache=True)
def rssi_at(heard_dbm: float, squared_m2: float, power_dbm: float, exponent: float) -> Along:
    """What the law predicts at ‖a − b‖² (m²) of a power that was heard; see `predict_rssi`."""
    # The natural logarithm takes half as long as the other one.
    tens = 0.5 * DB_PER_NEPER * np.log(squared_m2 + ANTENNA_M * ANTENNA_M)
    slope, over = rssi_slope(squared_m2, exponent), heard_dbm - (power_dbm - exponent * BESIDE)
    if over <= 0.0:
        return Along(power_dbm - exponent * tens, slope, 1.0, -tens)
    if over <= exponent * NEARER:
        return Along(heard_dbm - exponent * (tens - BESIDE), slope, 0.0, BESIDE - tens)
    return Along(power_dbm - exponent * (tens - NEARER), slope, 1.0, NEARER - tens)


@njit(cache=True)
def predict_rssi(heard_dbm: Array, a: Array, b: Array, power_dbm: Array, exponent: Array) -> PairJacobian:
    """Received power by the log-distance law: P0 − 10 n log10 d, Gaussian in dB.

    Places are never known as well as radios lie on each other: a power of more than there is at `ANTENNA_M`
    says that both ends are so near, and not by how much nearer, down to `TOUCHING_M`. It would otherwise
    raise P0, and all other radios would seem too weak and be thought farther away.

    Args:
        heard_dbm: what was received, m (dBm).
        a: positions, m × 3 (m).
        b: positions, m × 3 (m).
        power_dbm: P0, received at 1 m, m (dBm).
        exponent: n, path-loss exponent, m.
    """
    m = len(a)
    predicted, by_a, by_b, by_extra = np.empty(m), np.empty((m, 3)), np.empty((m, 3)), np.empty((m, 2))
    for i in range(m):
        e, n, u = a[i, 0] - b[i, 0], a[i, 1] - b[i, 1], a[i, 2] - b[i, 2]
        found = rssi_at(heard_dbm[i], e * e + n * n + u * u, power_dbm[i], exponent[i])
        along = found.by_a
        by_a[i, 0], by_a[i, 1], by_a[i, 2] = e * along, n * along, u * along
        by_b[i, 0], by_b[i, 1], by_b[i, 2] = -e * along, -n * along, -u * along
        by_extra[i, 0], by_extra[i, 1], predicted[i] = found.by_first, found.by_second, found.predicted
    return PairJacobian(predicted, by_a, by_b, by_extra)
