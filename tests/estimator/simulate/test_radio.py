"""Radios err as they are told to, and walls and floors weigh on them."""

import numpy as np
import pytest

from estimator.simulate.base import static_track
from estimator.simulate.building import floors_between, walls_between
from estimator.simulate.links import Radio, Site, range_readings, rssi_readings
from estimator.simulate.radio import BIAS_SIGMA_M, SCALE_SIGMA, PathLoss, Uwb, calibrated

MANY = 20_000
NONE = np.zeros(MANY)


def test_power_falls_by_the_exponent_and_by_each_wall_and_floor() -> None:
    loss = PathLoss(p0_dbm=-40.0, exponent=2.0, wall_db=3.0, floor_db=14.0)
    dbm = loss.mean_dbm(np.array([1.0, 10.0, 10.0]), np.array([0.0, 0.0, 2.0]), np.array([0.0, 0.0, 1.0]))
    assert dbm.tolist() == pytest.approx([-40.0, -60.0, -80.0])


def test_weak_and_far_packets_are_not_heard() -> None:
    loss = PathLoss(sensitivity_dbm=-70.0, range_m=25.0, sigma_db=0.001)
    heard = loss.heard_dbm(np.array([10.0, 24.0, 26.0]), np.zeros(3), np.zeros(3), np.random.default_rng(0))
    assert np.isnan(heard).tolist() == [False, True, True]


def test_ranges_in_sight_are_unbiased_with_the_stated_spread() -> None:
    uwb = Uwb(sigma_m=0.1, outlier_p=0.0, drop_p=0.0)
    measured = uwb.ranged_m(np.full(MANY, 12.0), NONE, NONE, np.random.default_rng(0))
    assert np.mean(measured) == pytest.approx(12.0, abs=0.003)
    assert np.std(measured) == pytest.approx(0.1, rel=0.02)


def test_walls_make_ranges_too_long_never_too_short() -> None:
    uwb = Uwb(sigma_m=0.001, outlier_p=0.0, drop_p=0.0, wall_bias_m=0.3)
    measured = uwb.ranged_m(np.full(MANY, 5.0), np.full(MANY, 2.0), NONE, np.random.default_rng(0))
    assert measured.min() > 4.99
    assert np.mean(measured) == pytest.approx(5.6, abs=0.02)


def test_exchanges_fail_and_go_wild_as_often_as_stated() -> None:
    uwb = Uwb(sigma_m=0.001, outlier_p=0.1, outlier_m=5.0, drop_p=0.25)
    measured = uwb.ranged_m(np.full(MANY, 12.0), NONE, NONE, np.random.default_rng(0))
    answered = measured[~np.isnan(measured)]
    assert 1.0 - len(answered) / MANY == pytest.approx(0.25, abs=0.01)
    assert np.mean(answered > 12.1) == pytest.approx(0.098, abs=0.01)


def test_scale_and_bias_of_a_technology_are_in_every_range() -> None:
    uwb = Uwb(sigma_m=0.001, outlier_p=0.0, drop_p=0.0, scale=1.07, bias_m=0.2)
    measured = uwb.ranged_m(np.full(MANY, 20.0), NONE, NONE, np.random.default_rng(0))
    assert np.mean(measured) == pytest.approx(21.6, abs=0.001)


def test_incidents_differ_in_how_well_their_radios_are_calibrated() -> None:
    drawn = [calibrated(Uwb(range_m=30.0), np.random.default_rng(seed)) for seed in range(400)]
    scales, biases = np.array([uwb.scale for uwb in drawn]), np.array([uwb.bias_m for uwb in drawn])
    assert np.std(scales) == pytest.approx(SCALE_SIGMA, rel=0.1)
    assert np.std(biases) == pytest.approx(BIAS_SIGMA_M, rel=0.1)
    assert abs(scales.mean() - 1.0) < 3 * SCALE_SIGMA / 20
    assert abs(biases.mean()) < 3 * BIAS_SIGMA_M / 20
    assert {uwb.range_m for uwb in drawn} == {30.0}


def test_how_well_radios_are_calibrated_changes_nothing_in_what_is_drawn_afterwards() -> None:
    untouched, used = np.random.default_rng(1), np.random.default_rng(1)
    calibrated(Uwb(), used)
    assert used.normal() == untouched.normal()


def test_a_room_is_two_walls_from_its_neighbour_over_the_corridor_unless_the_doors_are_in_line() -> None:
    north, south = np.array([[21.5, 5.0, 0.0]]), np.array([[21.5, -5.0, 0.0]])
    door = 2.0 + 3.5 * 6.0
    assert walls_between(north, south).tolist() == [2.0]
    assert walls_between(north * [0, 1, 1] + [door, 0, 0], south * [0, 1, 1] + [door, 0, 0]).tolist() == [0.0]


def test_floors_lie_between_storeys_only() -> None:
    a = np.array([[5.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 0.0, 6.8]])
    b = np.array([[9.0, 0.0, 1.7], [9.0, 0.0, 3.4], [9.0, 0.0, 0.0]])
    assert floors_between(a, b).tolist() == [0.0, 1.0, 2.0]


def test_a_dead_radio_is_neither_heard_nor_ranged() -> None:
    radios = {
        "ff1": Radio(static_track(np.zeros(3), 0, 0.0, 100.0)),
        "b1": Radio(static_track(np.array([3.0, 0.0, 0.0]), 0, 0.0, 100.0), on_s=20.0, off_s=60.0),
    }
    epochs, rng = np.arange(0.0, 100.0), np.random.default_rng(0)
    heard = [r.t for r in rssi_readings("ff1", radios, epochs, PathLoss(), Site(), rng, lost_p=0.0)]
    ranged = [r.t for r in range_readings("ff1", radios, epochs, Uwb(drop_p=0.0), Site(), rng)]
    assert heard == ranged == [float(t) for t in range(20, 60)]
