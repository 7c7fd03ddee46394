"""By what an altimeter is off beforehand, told by its first readings where its bearer's height is known."""

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.learned.altimeter_zero import FLAT, ODD_S, READINGS, AltimeterZero

SIGMA_M = 0.5


def first_readings(off_m: float, odd_m: float = 0.0) -> AltimeterZero:
    known = AltimeterZero()
    for second in range(READINGS):
        assert not known.enough(float(second))
        known = known.with_one(float(second), off_m + (odd_m if second == 0 else 0.0))
    assert known.enough(float(READINGS - 1))
    return known


@pytest.mark.parametrize("off_m", [-0.6, 0.0, 0.6])
def test_one_that_is_as_far_off_as_its_noise_is_believed(off_m: float) -> None:
    likely_m, doubt_m = first_readings(off_m).judged(SIGMA_M, 0.3**2)
    assert likely_m == 0.0
    assert doubt_m < 0.4


@pytest.mark.parametrize("off_m", [-4.0, 4.0, 8.0])
def test_one_that_is_off_at_a_door_of_known_height_is_not_believed(off_m: float) -> None:
    likely_m, doubt_m = first_readings(off_m).judged(SIGMA_M, 0.3**2)
    assert likely_m == pytest.approx(off_m, rel=0.03)
    assert doubt_m == pytest.approx(physics.HEIGHT_OFF_M, rel=0.1)


def test_one_odd_reading_makes_none_doubtful() -> None:
    assert first_readings(0.0, odd_m=6.0).judged(SIGMA_M, 0.3**2)[0] == 0.0


def test_where_no_height_is_known_it_stays_in_doubt_what_it_is_off_by() -> None:
    """A fifth are off by four metres: nothing has told that this one is not."""
    _, doubt_m = first_readings(0.0).judged(SIGMA_M, 30.0**2)
    assert doubt_m**2 == pytest.approx(0.2 * 4.0**2, rel=0.1)


def expected_and_read(off_m: list[float]) -> AltimeterZero:
    known = AltimeterZero(name="altimeter")
    for i, off in enumerate(off_m):
        known = known.after(2.0 * i, off, 0.0, off, SIGMA_M)
    return known


def test_readings_that_stay_off_for_some_seconds_have_jumped() -> None:
    assert expected_and_read([0.1, *(3.0,) * 6]).has_jumped(SIGMA_M, 0.1) == (2.0, 3.0)


def test_a_draught_is_no_jump() -> None:
    """It lasts for some seconds."""
    count = int(ODD_S / 2.0) + 1
    assert expected_and_read([*(3.0,) * count, 0.1, *(3.0,) * count]).has_jumped(SIGMA_M, 0.1) is None


def test_who_is_expected_anywhere_has_not_jumped() -> None:
    assert expected_and_read([3.0] * 6).has_jumped(SIGMA_M, 2.0**2) is None


def walked_and_read(way_m: float, up_m: float) -> AltimeterZero:
    """He stands, walks so far within one reading and the next, by which these differ so much, and stands."""
    known = AltimeterZero(name="altimeter")
    for i in range(2 * FLAT):
        after = i >= FLAT
        known = known.after(2.0 * i, up_m * after, way_m * after, 0.0, SIGMA_M)
    return known


@pytest.mark.parametrize("up_m", [-3.0, 3.0])
def test_what_is_steeper_than_any_stair_is_a_jump(up_m: float) -> None:
    found = walked_and_read(1.0, up_m).steeper()
    assert found is not None
    assert found[1] == up_m


@pytest.mark.parametrize("up_m", [-3.0, 3.0])
def test_a_stair_is_none(up_m: float) -> None:
    assert walked_and_read(4.0, up_m).steeper() is None


def test_what_it_is_said_to_be_off_by_is_what_it_is_off_by() -> None:
    """Altimeters of both kinds, at doors whose height is known to a metre."""
    chance = np.random.default_rng(0)
    squared_m2, said_m2 = [], []
    for _ in range(20_000):
        off_m = chance.normal(0.0, physics.HEIGHT_OFF_M if chance.random() < physics.HEIGHTS_OFF else 0.2)
        shared_m, door_m = chance.normal(0.0, SIGMA_M * 0.5**0.5), chance.normal()
        known = AltimeterZero()
        for second in range(READINGS):
            noise_m = shared_m + chance.normal(0.0, SIGMA_M * 0.5**0.5)
            known = known.with_one(float(second), off_m + noise_m + door_m)
        likely_m, doubt_m = known.judged(SIGMA_M, 1.0)
        if likely_m == 0.0:
            squared_m2.append(off_m**2)
            said_m2.append(doubt_m**2)
    assert np.mean(squared_m2) == pytest.approx(np.mean(said_m2), rel=0.15)


def test_it_is_level_since_what_it_reads_now() -> None:
    assert expected_and_read([0.1, 0.0, 1.5, 3.0, 3.1, 2.9]).level_since() == 6.0
    assert expected_and_read([0.1, 0.0, 3.0, 6.0, 9.0, 12.0]).level_since() == 10.0
