"""The plain baseline: each second a position of its own, from ranges to known anchors alone.

Ranges, or RSSI turned into ranges by a fixed log-distance law, of one second; Gauss-Newton in two dimensions.
No motion, no heights, no memory.
"""

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from estimator.estimate import TrackPoint
from estimator.measurements import AnyReading, Displacement, Drop, Node, Range, Rssi
from estimator.simulate import Report
from estimator.simulate.base import FloatArray

P0_DBM = -45.0
EXPONENT = 2.2
RSSI_SIGMA_DB = 6.0
RSSI_SHARE = RSSI_SIGMA_DB * math.log(10.0) / (10.0 * EXPONENT)
"""Standard deviation of a range from RSSI, as a share of the range."""

RANGE_SIGMA_M = 0.3
NEAREST_M = 0.3
ANCHORS = 3
ITERATIONS = 20
REST_M = 1e-3
LONGEST_STEP_M = 5.0

Measured = tuple[tuple[float, float], float, float]
"""An anchor's east and north (m), the distance to it (m), and its standard deviation (m)."""


def range_of(reading: Range | Rssi) -> tuple[float, float]:
    """Distance and its standard deviation (m), from RSSI by the fixed law d = 10^((P0 − rssi) / 10 n)."""
    if isinstance(reading, Range):
        return reading.range_m, reading.sigma_m or RANGE_SIGMA_M
    distance_m = max(NEAREST_M, 10.0 ** ((P0_DBM - reading.dbm) / (10.0 * EXPONENT)))
    return distance_m, RSSI_SHARE * distance_m


def takes(reports: Sequence[Report]) -> bool:
    """Whether there are three known anchors and nothing is dropped: then each second stands for itself."""
    readings = [report.reading for report in reports]
    return len(_anchors(readings)) >= ANCHORS and not any(isinstance(r, Drop) for r in readings)


def track(reports: Sequence[Report]) -> dict[str, list[TrackPoint]]:
    """A point for each second of each responder in which it measures three anchors or more."""
    readings = [report.reading for report in reports]
    anchors = _anchors(readings)
    walkers = {r.node for r in readings if isinstance(r, Node) and r.role == "responder"}
    walkers |= {r.node for r in readings if isinstance(r, Displacement)}
    gathered: dict[tuple[str, int], dict[str, list[Range | Rssi]]] = defaultdict(lambda: defaultdict(list))
    for r in readings:
        if isinstance(r, Range | Rssi):
            for walker, anchor in ((r.a, r.b), (r.b, r.a)):
                if walker in walkers and anchor in anchors:
                    gathered[walker, math.floor(r.t)][anchor].append(r)
    tracks: dict[str, list[TrackPoint]] = {}
    for (walker, _), heard in sorted(gathered.items()):
        if len(heard) < ANCHORS:
            continue
        measured = [_mean(anchors[anchor], own) for anchor, own in sorted(heard.items())]
        position, covariance = solve(measured)
        t = float(np.mean([r.t for own in heard.values() for r in own]))
        tracks.setdefault(walker, []).append(point(t, position, covariance, 0.0))
    return tracks


def solve(measured: Sequence[Measured]) -> tuple[FloatArray, FloatArray]:
    """Position, (2,) (m), and covariance, 2 × 2 (m²): the best of Gauss-Newton from several starts.

    They are the middle of the anchors, and four places round it as far off as the ranges are long.
    """
    places = np.array([place for place, _, _ in measured])
    distance_m = np.array([distance for _, distance, _ in measured])
    weight = 1.0 / np.array([sigma for _, _, sigma in measured]) ** 2
    starts = places.mean(axis=0) + np.median(distance_m) * np.array(
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]
    )
    found = [_gauss_newton(start, places, distance_m, weight) for start in starts]
    _, position, covariance = min(found, key=lambda one: one[0])
    return position, covariance


def _gauss_newton(
    position: FloatArray, places: FloatArray, distance_m: FloatArray, weight: FloatArray
) -> tuple[float, FloatArray, FloatArray]:
    """Weighted squared residuals, position and covariance where it comes to rest."""
    for _ in range(ITERATIONS):
        away = position - places
        predicted = np.maximum(np.hypot(away[:, 0], away[:, 1]), 1e-3)
        jacobian = away / predicted[:, None]
        information = jacobian.T @ (weight[:, None] * jacobian) + 1e-6 * np.eye(2)
        step = np.linalg.solve(information, jacobian.T @ (weight * (distance_m - predicted)))
        step *= min(1.0, LONGEST_STEP_M / max(float(np.hypot(*step)), 1e-9))
        position = position + step
        if np.hypot(*step) < REST_M:
            break
    off = distance_m - np.hypot(*(position - places).T)
    covariance = np.linalg.inv(information).astype(np.float64)
    return float(weight @ off**2), position, covariance


def point(t: float, position: FloatArray, covariance: FloatArray, up_m: float) -> TrackPoint:
    """A point of a track in a plane; its height is held to a metre.

    Args:
        t: epoch (s).
        position: east, north (m).
        covariance: 2 × 2 (m²).
        up_m: height (m).
    """
    ee, en, nn = float(covariance[0, 0]), float(covariance[0, 1]), float(covariance[1, 1])
    where = (float(position[0]), float(position[1]), up_m)
    return TrackPoint(t=t, position_m=where, covariance_m2=(ee, en, 0.0, nn, 0.0, 1.0))


def _anchors(readings: Sequence[AnyReading]) -> dict[str, tuple[float, float]]:
    return {
        r.node: (r.position_m[0], r.position_m[1])
        for r in readings
        if isinstance(r, Node) and r.role in ("anchor", "base") and r.position_m is not None
    }


def _mean(place: tuple[float, float], readings: Sequence[Range | Rssi]) -> Measured:
    """The mean of what one anchor measured in a second: of its ranges, else of its RSSI in dB."""
    ranges = [r for r in readings if isinstance(r, Range)]
    distances, sigmas = zip(*(range_of(r) for r in ranges or readings), strict=True)
    if not ranges:
        mean_m = float(np.exp(np.mean(np.log(distances))))
        return place, mean_m, RSSI_SHARE * mean_m / math.sqrt(len(readings))
    return place, float(np.mean(distances)), float(np.mean(sigmas)) / math.sqrt(len(ranges))
