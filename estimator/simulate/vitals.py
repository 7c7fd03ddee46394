"""What units tell beside their position: air, battery, heat, stillness, height and air pressure."""

from dataclasses import dataclass

import numpy as np

from estimator.measurements import Altitude, Pressure, Status
from estimator.simulate.base import FloatArray, TrueTrack

SEA_LEVEL_PA = 101_325.0
FULL_BAR = 300.0


def pressure_pa(up_m: FloatArray, ground_pa: FloatArray | float) -> FloatArray:
    """Air pressure at heights above the ground, n (Pa): the standard atmosphere (ISO 2533)."""
    pressure: FloatArray = ground_pa * (1.0 - up_m / 44_330.8) ** 5.2559
    return pressure


def weather_pa(t_s: FloatArray) -> FloatArray:
    """Pressure at the ground over an incident, n (Pa): a front passes at 1 hPa an hour."""
    return SEA_LEVEL_PA - 900.0 - 100.0 * t_s / 3600.0


def pressure_readings(
    node: str, truth: TrueTrack, t_s: FloatArray, rng: np.random.Generator, offset_pa: float
) -> list[Pressure]:
    """Readings of a barometer with a fixed offset (zeroed at the door) and 2.5 Pa (0.2 m) of noise."""
    up_m = truth.at(t_s)[:, 2]
    measured = pressure_pa(up_m, weather_pa(t_s)) + offset_pa + rng.normal(0.0, 2.5, len(t_s))
    return [
        Pressure(t=round(t, 3), node=node, pressure_pa=round(pa, 1))
        for t, pa in zip(t_s.tolist(), measured.tolist(), strict=True)
    ]


def altitude_readings(
    node: str, truth: TrueTrack, t_s: FloatArray, rng: np.random.Generator, sigma_m: float = 0.4
) -> list[Altitude]:
    """Heights that a unit works out itself, with noise `sigma_m` (m)."""
    up_m = truth.at(t_s)[:, 2] + rng.normal(0.0, sigma_m, len(t_s))
    return [
        Altitude(t=round(t, 3), node=node, up_m=round(up, 2), sigma_m=sigma_m)
        for t, up in zip(t_s.tolist(), up_m.tolist(), strict=True)
    ]


@dataclass(frozen=True, slots=True)
class Breathing:
    """How a responder's cylinder empties.

    Attributes:
        moving_bar_per_min: while he works.
        resting_bar_per_min: while he stands or lies.
    """

    moving_bar_per_min: float = 11.0
    resting_bar_per_min: float = 6.5


def status_readings(
    node: str,
    truth: TrueTrack,
    t_s: FloatArray,
    fire_m: FloatArray,
    breathing: Breathing | None,
) -> list[Status]:
    """Telemetry at epochs `t_s`.

    Args:
        node: the unit.
        truth: its true track.
        t_s: when it reports, n (s).
        fire_m: where it burns, shape (3,) (m).
        breathing: how its air goes; None: it does not report air.
    """
    step = np.linalg.norm(np.diff(truth.position_m, axis=0, prepend=truth.position_m[:1]), axis=1)
    moving = step > 1e-6
    tick = np.diff(truth.t_s, prepend=truth.t_s[0])
    newest = np.maximum.accumulate(np.where(moving, truth.t_s, truth.t_s[0]))
    motionless = np.interp(t_s, truth.t_s, truth.t_s - newest)
    heat = 22.0 + 260.0 * np.exp(-np.linalg.norm(truth.at(t_s) - fire_m, axis=1) / 3.5)
    if breathing is None:
        air: list[float | None] = [None] * len(t_s)
    else:
        rate = np.where(moving, breathing.moving_bar_per_min, breathing.resting_bar_per_min) / 60.0
        left = np.interp(t_s, truth.t_s, FULL_BAR - np.cumsum(rate * tick))
        air = [round(bar) for bar in np.maximum(left, 0.0).tolist()]
    return [
        Status(
            t=round(t, 3),
            node=node,
            battery=round(0.97 - t / 28_800.0, 3),
            air_bar=bar,
            temperature_c=round(celsius, 1),
            motionless_s=round(still),
        )
        for t, bar, celsius, still in zip(t_s.tolist(), air, heat.tolist(), motionless.tolist(), strict=True)
    ]
