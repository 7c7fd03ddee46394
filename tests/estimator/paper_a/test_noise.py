"""Paper A's noise: what a power and a way walked tell of a distance."""

import numpy as np
import pytest

from estimator.paper_a.noise import pdr_sigma_m, range_of, rssi_sigma_m


def test_minus_40_dbm_is_a_metre_and_every_distance_has_one_power() -> None:
    assert range_of(-40.0, None) == pytest.approx(1.0)
    assert range_of(-60.0, 0.0) == pytest.approx(9.16, abs=0.01)
    assert range_of(-20.0, 20.0) == pytest.approx(1.0)
    heard = [range_of(dbm, None) for dbm in np.linspace(-20.0, -110.0, 200)]
    assert (np.diff(heard) >= 0.0).all()


def test_a_near_range_is_trusted_and_a_far_one_in_proportion_to_its_length() -> None:
    assert rssi_sigma_m(1.0) == 0.5
    assert rssi_sigma_m(20.0) == pytest.approx(2.0 * rssi_sigma_m(10.0))
    assert rssi_sigma_m(10.0) > 3.0


def test_dead_reckoning_is_7_3_m_off_after_100_m_and_four_times_that_after_400_m() -> None:
    for way, off in ((100, 7.3), (400, 29.2)):
        variance = sum(pdr_sigma_m(float(metre), 1.0) ** 2 for metre in range(way))
        assert np.sqrt(2.0 * variance) == pytest.approx(off, rel=0.01)


def test_at_first_a_displacement_is_better_than_a_range_and_after_a_long_way_no_more() -> None:
    """Section V-A: P_PDR ≤ P_RSSI while the way is short."""
    assert pdr_sigma_m(10.0, 1.0) < rssi_sigma_m(1.0)
    assert pdr_sigma_m(400.0, 1.0) > rssi_sigma_m(1.0)
