"""How far radios reach, from where they fell silent."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.learned.reach import (
    EXPONENT,
    OUTLIER_DB2,
    OUTLIERS,
    REACH_DB,
    SPREADS_DB2,
    Reach,
    in_metres,
)

OFF_DB = st.floats(-30.0, 30.0)
UNSURE_DB2 = st.floats(0.01, 50.0)


def crossed(*off_db: float, variance_db2: float = 0.25) -> Reach:
    return Reach().with_crossings(off_db, [variance_db2] * len(off_db))


def test_until_it_is_known_how_many_packets_are_lost_silence_tells_nothing() -> None:
    assert Reach().silent is None
    assert Reach().with_packets(20, 0).silent is None


@pytest.mark.parametrize(
    ("lost", "silent"), [(0, 1), (2, 1), (10, 2), (60, None)], ids=["none", "1 %", "5 %", "30 %"]
)
def test_the_more_packets_are_lost_the_longer_a_radio_in_reach_may_be_silent(
    lost: int, silent: int | None
) -> None:
    assert Reach().with_packets(200, lost).silent == silent


def test_what_seemed_lost_may_turn_out_to_be_out_of_reach() -> None:
    assert Reach().with_packets(100, 3).with_packets(0, -3) == Reach().with_packets(100, 0)
    assert Reach().with_packets(0, -1).lost == 0


def test_reaches_that_agree_are_sharp_and_reaches_that_differ_are_not() -> None:
    alike, different = crossed(0.1, -0.2, 0.0, 0.2, -0.1, 0.1), crossed(3.0, -4.0, 5.0, -3.0, 4.0, -5.0)
    assert alike.sigma_db < 0.5
    assert 2.0 < different.sigma_db < 6.0
    assert alike.sigma_db < Reach().sigma_db < different.sigma_db


def test_what_was_hardly_predicted_tells_hardly_anything() -> None:
    vague = crossed(1.0, -2.0, 3.0, variance_db2=400.0)
    assert vague.sigma_db == pytest.approx(Reach().sigma_db, rel=0.1)


def test_a_radio_that_was_switched_off_does_not_make_the_others_soft() -> None:
    usual = (0.1, -0.2, 0.0, 0.2, -0.1, 0.1)
    assert crossed(*usual, 25.0).sigma_db < 1.5 * crossed(*usual).sigma_db
    assert math.isfinite(crossed(*usual, 1e6).sigma_db)


@given(told=st.lists(st.tuples(OFF_DB, UNSURE_DB2), max_size=8))
def test_the_spread_is_its_posteriors_mean_in_the_logarithm(told: list[tuple[float, float]]) -> None:
    """By products of densities, not sums of logarithms."""

    def density(off: float, variance: float) -> float:
        return math.exp(-0.5 * off * off / variance) / math.sqrt(variance)

    posterior = np.ones(len(SPREADS_DB2))
    reach = Reach()
    for off_db, variance in told:
        reach = reach.with_crossings([off_db], [variance])
        odd = OUTLIERS * density(off_db, variance + OUTLIER_DB2)
        posterior *= [(1.0 - OUTLIERS) * density(off_db, variance + s) + odd for s in SPREADS_DB2]
    posterior /= posterior.sum()
    at_once = Reach().with_crossings([off for off, _ in told], [variance for _, variance in told])
    assert at_once.sigma_db == reach.sigma_db
    assert math.log(reach.sigma_db) == pytest.approx(posterior @ np.log(np.sqrt(SPREADS_DB2)), abs=1e-6)


@given(reach_m=st.floats(5.0, 80.0), away_m=st.floats(2.0, 100.0))
def test_in_metres_a_crossing_is_off_by_how_much_farther_radios_reach(reach_m: float, away_m: float) -> None:
    level_db, off_db = 10.0 * EXPONENT * np.log10([reach_m, away_m / reach_m])
    found_m, off_m, sigma_m = in_metres(level_db, off_db, 0.5)
    assert found_m == pytest.approx(reach_m)
    assert off_m == pytest.approx(reach_m - away_m, abs=1e-9)
    # One standard deviation farther, as far as the logarithm is straight.
    assert in_metres(level_db, -0.5, 0.5)[1] == pytest.approx(sigma_m, rel=0.05)


def test_beforehand_a_reach_is_that_of_a_radio_in_a_building() -> None:
    assert in_metres(REACH_DB, 0.0, 1.0)[0] == pytest.approx(22.0)
