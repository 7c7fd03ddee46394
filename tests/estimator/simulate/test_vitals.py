"""Units tell of air, stillness and pressure what is physically so."""

import numpy as np
import pytest

from estimator.simulate.base import static_track
from estimator.simulate.vitals import (
    Breathing,
    altitude_readings,
    pressure_pa,
    pressure_readings,
    status_readings,
    weather_pa,
)
from estimator.simulate.walking import Leg, walk

EPOCHS = np.arange(0.0, 600.0, 1.0)


def test_pressure_falls_by_12_pa_a_metre_near_the_ground() -> None:
    fall = pressure_pa(np.array([0.0]), 101_325.0) - pressure_pa(np.array([10.0]), 101_325.0)
    assert fall[0] / 10.0 == pytest.approx(12.0, abs=0.1)


def test_a_barometer_errs_by_its_offset_and_by_its_noise() -> None:
    truth = static_track(np.array([0.0, 0.0, 6.8]), 2, 0.0, 600.0)
    readings = pressure_readings("ff1", truth, EPOCHS, np.random.default_rng(0), offset_pa=5.0)
    error = np.array([r.pressure_pa for r in readings]) - pressure_pa(np.full(600, 6.8), weather_pa(EPOCHS))
    assert np.mean(error) == pytest.approx(5.0, abs=0.4)
    assert np.std(error) == pytest.approx(2.5, rel=0.1)


def test_an_altimeter_states_the_spread_that_it_has() -> None:
    truth = static_track(np.array([0.0, 0.0, 3.4]), 1, 0.0, 600.0)
    readings = altitude_readings("ff1", truth, EPOCHS, np.random.default_rng(0), sigma_m=0.4)
    assert np.std([r.up_m - 3.4 for r in readings]) == pytest.approx(0.4, rel=0.1)
    assert {r.sigma_m for r in readings} == {0.4}


def test_air_goes_faster_while_working_and_stillness_is_counted() -> None:
    truth = walk((0.0, 0.0, 0.0), [Leg((60.0, 0.0, 0.0), 1.0)], (), end_s=120.0)
    told = status_readings(
        "ff1", truth, np.array([0.0, 60.0, 120.0]), np.array([500.0, 0.0, 0.0]), Breathing(12.0, 6.0)
    )
    assert [r.air_bar for r in told] == pytest.approx([300.0, 288.0, 282.0], abs=1.0)
    assert [r.motionless_s for r in told] == pytest.approx([0.0, 0.0, 60.0], abs=1.0)


def test_it_is_hotter_near_the_fire() -> None:
    truth = walk((0.0, 0.0, 0.0), [Leg((20.0, 0.0, 0.0), 1.0)], (), end_s=20.0)
    told = status_readings("ff1", truth, np.arange(0.0, 20.0, 2.0), np.array([20.0, 0.0, 0.0]), None)
    heat = [r.temperature_c for r in told if r.temperature_c is not None]
    assert heat == sorted(heat)
    assert heat[0] < 25.0 < 150.0 < heat[-1]
    assert {r.air_bar for r in told} == {None}
