"""`rssi`: how strongly one radio heard another."""

from typing import Annotated

import numpy as np
from msgspec import Meta

from estimator.graph.dense import Array
from estimator.measurements.base import PairReading
from estimator.measurements.range import PairJacobian

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
"""Antennas never coincide: a boot passes a breadcrumb at about this distance; the logarithm stays finite."""


def predict_rssi(a: Array, b: Array, power_dbm: Array, exponent: Array) -> PairJacobian:
    """Received power by the log-distance law: P0 − 10 n log10 d, Gaussian in dB (estimation.md, point 4).

    Args:
        a: positions, m × 3 (m).
        b: positions, m × 3 (m).
        power_dbm: P0, received at 1 m, m (dBm).
        exponent: n, path-loss exponent, m.
    """
    difference = a - b
    squared = (difference**2).sum(axis=1) + ANTENNA_M**2
    decades = 0.5 * np.log10(squared)
    along = difference * (-10.0 * exponent / np.log(10.0) / squared)[:, None]
    extra = np.column_stack([np.ones_like(squared), -10.0 * decades])
    return PairJacobian(power_dbm - 10.0 * exponent * decades, along, -along, extra)
