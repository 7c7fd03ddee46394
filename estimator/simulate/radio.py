"""Radios in a building: signal strengths and UWB ranges through walls and floors."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.simulate.base import FloatArray

Obstacles = NDArray[np.float64]
"""How many walls or floors a link crosses, n."""

SCALE_SIGMA, BIAS_SIGMA_M = 0.005, 0.1
"""How incidents differ in the scale and the bias that all their UWB ranges have. Against its survey hanyang
has +0.7 % and −14 cm (LOS_A1), +0.3 % and nil (NLOS_A1): a weak signal arrives late (Decawave APS011), so
that the error grows with the distance. DW1000 modules are said to be good to 10 cm (data sheet of DWM1000):
what their antennas delay is calibrated so well, and drifts by 2 mm a degree (user manual)."""


@dataclass(frozen=True, slots=True)
class PathLoss:
    """Received power: P0 - 10 n log10(d) - walls - floors + noise (dBm), Gaussian in dB.

    Attributes:
        p0_dbm: at 1 m (dBm).
        exponent: n.
        sigma_db: standard deviation of a reading (dB).
        near_m: nearer than this the direct path dominates (m).
        near_sigma_db: standard deviation there (dB).
        wall_db: lost per wall (dB).
        floor_db: lost per floor (dB).
        sensitivity_dbm: weaker packets are not heard (dBm).
        range_m: packets from farther away are not heard (m).
    """

    p0_dbm: float = -40.0
    exponent: float = 2.5
    sigma_db: float = 5.0
    near_m: float = 1.5
    near_sigma_db: float = 1.5
    wall_db: float = 3.0
    floor_db: float = 14.0
    sensitivity_dbm: float = -90.0
    range_m: float = np.inf

    def mean_dbm(self, distance_m: FloatArray, walls: Obstacles, floors: Obstacles) -> FloatArray:
        """Expected power at distances `distance_m`, n (dBm)."""
        lost = self.wall_db * walls + self.floor_db * floors
        free: FloatArray = self.p0_dbm - 10.0 * self.exponent * np.log10(np.maximum(distance_m, 0.1))
        return free - lost

    def heard_dbm(
        self, distance_m: FloatArray, walls: Obstacles, floors: Obstacles, rng: np.random.Generator
    ) -> FloatArray:
        """Powers heard, n (dBm); NaN where nothing is heard."""
        sigma = np.where(distance_m < self.near_m, self.near_sigma_db, self.sigma_db)
        dbm = self.mean_dbm(distance_m, walls, floors) + rng.normal(0.0, 1.0, len(distance_m)) * sigma
        return np.where((dbm >= self.sensitivity_dbm) & (distance_m <= self.range_m), dbm, np.nan)


@dataclass(frozen=True, slots=True)
class Uwb:
    """Two-way ranging: off in sight by a scale and a bias, too long through walls, now and then wildly so.

    Attributes:
        sigma_m: standard deviation in sight (m).
        bias_m: of every range (m).
        scale: of every range.
        wall_bias_m: mean of the exponential excess per wall (m).
        floor_bias_m: the same per floor (m).
        outlier_p: probability that a range is an outlier.
        outlier_m: mean of the exponential excess of an outlier (m).
        range_m: reach in sight (m).
        wall_range: each wall leaves this share of the reach.
        floor_range: each floor leaves this share of the reach.
        drop_p: probability that a range in reach fails.
    """

    sigma_m: float = 0.1
    bias_m: float = 0.0
    scale: float = 1.0
    wall_bias_m: float = 0.25
    floor_bias_m: float = 0.5
    outlier_p: float = 0.02
    outlier_m: float = 3.0
    range_m: float = 40.0
    wall_range: float = 0.6
    floor_range: float = 0.35
    drop_p: float = 0.1

    def ranged_m(
        self, distance_m: FloatArray, walls: Obstacles, floors: Obstacles, rng: np.random.Generator
    ) -> FloatArray:
        """Measured ranges, n (m); NaN where the exchange fails."""
        n = len(distance_m)
        reach = self.range_m * self.wall_range**walls * self.floor_range**floors
        excess = rng.exponential(1.0, n) * (self.wall_bias_m * walls + self.floor_bias_m * floors)
        outlier = (rng.random(n) < self.outlier_p) * rng.exponential(self.outlier_m, n)
        measured = self.scale * distance_m + self.bias_m + excess + outlier + rng.normal(0.0, self.sigma_m, n)
        fails = (distance_m > reach) | (rng.random(n) < self.drop_p)
        return np.where(fails, np.nan, np.maximum(measured, 0.0))


def calibrated(uwb: Uwb, rng: np.random.Generator) -> Uwb:
    """`uwb` as the radios of one incident are calibrated, all alike: scale and bias are drawn from `rng`."""
    # A stream of its own: how well radios are calibrated changes nothing in what is measured afterwards.
    scale, bias_m = rng.spawn(1)[0].normal((1.0, 0.0), (SCALE_SIGMA, BIAS_SIGMA_M))
    return replace(uwb, scale=float(scale), bias_m=float(bias_m))
