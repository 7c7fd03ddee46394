"""A UAV around the office: its circle, its fixes, and its ranges through windows."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from estimator.measurements import AnyReading, Position, Range
from estimator.simulate.base import FloatArray, TrueTrack
from estimator.simulate.building import DEPTH_M, EAST_M, WEST_M, walls_between
from estimator.simulate.links import Radio
from estimator.simulate.radio import Uwb

LAP_S = 150.0
REACH_M = 45.0
FIX_SIGMA_M = (1.2, 1.2, 2.0)


def circle(end_s: float) -> TrueTrack:
    """An ellipse round the building, 9 to 15 m up, a lap in 150 s, until `end_s`."""
    t_s = np.arange(0.0, end_s + 0.05, 0.1)
    angle = np.pi + 2 * np.pi * t_s / LAP_S
    east = (WEST_M + EAST_M) / 2 + 34.0 * np.cos(angle)
    north = (DEPTH_M + 11.0) * np.sin(angle)
    up = 12.0 + 3.0 * np.sin(0.37 * angle)
    heading = np.unwrap(np.arctan2(np.gradient(north), np.gradient(east)))
    position = np.stack([east, north, up], axis=1)
    return TrueTrack(t_s, position, np.zeros(len(t_s), dtype=np.int64), heading)


def window_ranges(
    uav: str,
    flight: TrueTrack,
    node: str,
    truth: TrueTrack,
    t_s: FloatArray,
    uwb: Uwb,
    rng: np.random.Generator,
) -> list[Range]:
    """Ranges from `uav` to `node` at epochs `t_s`: one outer wall counts as a window, a second one blocks.

    Args:
        uav: who ranges.
        flight: its way.
        node: who is ranged.
        truth: that one's way.
        t_s: when, n (s).
        uwb: the radios that the responders carry; aloft it reaches farther, and fails more often.
        rng: where noise comes from.
    """
    a, b = flight.at(t_s), truth.at(t_s)
    distance = np.linalg.norm(b - a, axis=1)
    walls = np.maximum(walls_between(a, b) - 1.0, 0.0)
    seen = (walls == 0) & (distance < REACH_M)
    aloft = replace(uwb, range_m=REACH_M, drop_p=0.3)
    measured = aloft.ranged_m(distance, walls, np.zeros(len(t_s)), rng)
    return [
        Range(t=round(t, 3), a=uav, b=node, range_m=round(range_m, 3), technology="uwb")
        for t, range_m, ok in zip(t_s.tolist(), measured.tolist(), seen.tolist(), strict=True)
        if ok and not np.isnan(range_m)
    ]


def flight_readings(
    uav: str, flight: TrueTrack, radios: Mapping[str, Radio], uwb: Uwb | None, rng: np.random.Generator
) -> list[AnyReading]:
    """Its GNSS fixes each second, and its ranges to those near windows on its side.

    Args:
        uav: its name.
        flight: its way.
        radios: of those whom it ranges; silent ones do not answer.
        uwb: the radios that they carry; None: they have none.
        rng: where noise comes from.
    """
    t_s = np.arange(0.5, flight.t_s[-1], 1.0)
    fixes = flight.at(t_s) + rng.normal(0.0, 1.0, (len(t_s), 3)) * np.array(FIX_SIGMA_M)
    readings: list[AnyReading] = [
        Position(t=t, node=uav, position_m=(round(e, 2), round(n, 2), round(u, 2)), sigma_m=FIX_SIGMA_M)
        for t, (e, n, u) in zip(t_s.tolist(), fixes.tolist(), strict=True)
    ]
    if uwb is None:
        return readings
    for node, radio in radios.items():
        ranges = window_ranges(uav, flight, node, radio.truth, t_s, uwb, rng)
        readings += [r for r in ranges if not radio.silent_s[0] <= r.t < radio.silent_s[1]]
    return readings
