"""What a power says, from afar and of radios that lie on each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.measurements.rssi import ANTENNA_M, TOUCHING_M, predict_rssi

P0_DBM, EXPONENT = -40.0, 2.5
apart = st.floats(0.0, 30.0)


def off_db(heard_dbm: float, apart_m: float, p0_dbm: float = P0_DBM) -> float:
    """What was heard less what is predicted of radios so far apart (dB)."""
    a, b = np.array([[apart_m, 0.0, 0.0]]), np.zeros((1, 3))
    told = np.array([heard_dbm]), a, b, np.array([p0_dbm]), np.array([EXPONENT])
    return float(heard_dbm - predict_rssi(*told).predicted[0])


def law_dbm(apart_m: float) -> float:
    """What the law gives a power at a distance (dBm)."""
    return float(P0_DBM - 10.0 * EXPONENT * np.log10(apart_m))


@pytest.mark.parametrize("apart_m", [2.0, 10.0, 30.0])
def test_from_afar_power_falls_with_the_logarithm_of_the_distance(apart_m: float) -> None:
    assert off_db(law_dbm(apart_m), apart_m) == pytest.approx(0.0, abs=0.15)


@pytest.mark.parametrize("heard_dbm", [law_dbm(ANTENNA_M), law_dbm(0.1), law_dbm(TOUCHING_M)])
def test_a_breadcrumb_at_the_foot_is_as_strong_as_it_may_be(heard_dbm: float) -> None:
    assert off_db(heard_dbm, 0.0) == pytest.approx(0.0, abs=1e-9)
    assert off_db(heard_dbm, 0.0, P0_DBM - 1.0) == pytest.approx(0.0, abs=1.0 + 1e-9)


def test_radios_that_lie_on_each_other_say_nothing_of_how_strong_others_are() -> None:
    heard_dbm = law_dbm(0.1)
    assert off_db(heard_dbm, 0.0, P0_DBM - 3.0) == off_db(heard_dbm, 0.0, P0_DBM + 3.0) == 0.0


def test_who_is_thought_to_be_elsewhere_is_pulled_to_what_he_hears_beside_him() -> None:
    heard_dbm = law_dbm(0.1)
    assert off_db(heard_dbm, 5.0) > off_db(heard_dbm, 2.0) > off_db(heard_dbm, 1.0) > 5.0


def test_what_is_stronger_than_radios_can_be_is_stronger_than_predicted() -> None:
    assert off_db(law_dbm(TOUCHING_M) + 7.0, 0.0) == pytest.approx(7.0)


@given(apart, st.floats(-100.0, 20.0), st.floats(0.0, 20.0))
def test_the_stronger_the_power_the_nearer_it_pulls_and_without_a_jump(
    apart_m: float, heard_dbm: float, more_db: float
) -> None:
    less, more = off_db(heard_dbm, apart_m), off_db(heard_dbm + more_db, apart_m)
    assert -1e-9 <= more - less <= more_db + 1e-9
