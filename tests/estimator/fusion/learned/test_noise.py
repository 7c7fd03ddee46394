"""Noise that is learned, and readings that share an error."""

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.learned.noise import LearnedNoise, link_sigma, near_dbm, through_sigma


def test_the_learned_factor_follows_the_errors_that_come_in() -> None:
    chance = np.random.default_rng(1)
    noise = LearnedNoise()
    for error in chance.normal(0.0, 1.7, 2000).tolist():
        noise = noise.with_errors(1.0, error**2, 0.0, 0.0, 1.0, 0.0, t=0.0)
    assert noise.factor == pytest.approx(1.7, rel=0.1)


def test_the_shared_part_of_the_noise_is_told_by_successive_errors() -> None:
    chance = np.random.default_rng(2)
    noise, before, common = LearnedNoise(), 0.0, 0.0
    for k in range(4000):
        common = float(chance.normal(0.0, np.sqrt(0.6))) if k % 40 == 0 else common
        error = common + chance.normal(0.0, np.sqrt(0.4))
        noise = noise.with_errors(1.0, error**2, 1.0, error * before, 1.0, 0.0, t=0.0)
        before = error
    assert noise.shared == pytest.approx(0.6, abs=0.2)


def test_the_share_of_outliers_goes_from_the_usual_one_to_what_is_seen() -> None:
    noise = LearnedNoise()
    assert noise.outliers(0.1) == pytest.approx(0.1)
    for _ in range(3000):
        noise = noise.with_errors(0.6, 0.6, 0.0, 0.0, 1.0, 0.0, t=0.0)
    assert noise.outliers(0.1) == pytest.approx(0.4, abs=0.06)


@pytest.mark.parametrize("each_s", [pytest.param(0.02, id="a crew's"), pytest.param(1.0, id="one man's")])
@pytest.mark.parametrize("powers", [True, False], ids=["powers", "ranges"])
def test_noise_is_learned_from_some_hundred_readings_and_of_powers_from_a_minute_at_least(
    each_s: float, powers: bool
) -> None:
    """A crew's radios measure fifty times a second: three quiet seconds at the door are no quiet radio."""
    noise, many = LearnedNoise(), physics.NOISE_MEMORY
    if powers:
        many = max(many, physics.POWER_NOISE_MEMORY_S / each_s)
    begun, quiet = round(8 * many), 150
    for k in range(begun + quiet):
        noise = noise.with_errors(1.0, float(k < begun), 0.0, 0.0, 1.0, float(powers), t=k * each_s)
    assert noise.count == pytest.approx(many, rel=0.01)
    assert noise.factor**2 == pytest.approx(np.exp(-quiet / many), rel=0.02)


def test_alike_readings_are_together_worth_no_more_than_their_common_error_allows() -> None:
    noise = LearnedNoise(count=100.0, squares=100.0, pairs=100.0, products=50.0)
    worth = sum(link_sigma(noise.factor, noise.shared, 1.0, float(k), 0.0, 0.0) ** -2 for k in range(1, 200))
    assert worth == pytest.approx(199.0 / (0.5 + 199.0 * 0.5), rel=1e-6)


def test_ranges_behind_a_wall_are_together_worth_no_more_than_it_is_known() -> None:
    worth = sum(link_sigma(1.0, 0.0, 0.1, float(k), 0.25, 0.04) ** -2 for k in range(1, 2000))
    assert worth == pytest.approx(1.0 / 0.04, rel=0.01)
    assert worth < 1.0 / 0.04


def test_independent_readings_keep_their_full_worth() -> None:
    noise = LearnedNoise(count=100.0, squares=100.0, pairs=100.0, products=0.0)
    assert link_sigma(noise.factor, noise.shared, 0.3, 50.0, 0.0, 0.0) == pytest.approx(0.3)


def test_however_often_one_listens_through_a_floor_it_tells_no_more_than_the_floor_lets() -> None:
    told = [through_sigma(5.0, True, float(k)) ** -2 for k in range(1, 1001)]
    assert told[0] == pytest.approx(1.0 / (5.0**2 + physics.FLOOR_SIGMA[1] ** 2))
    assert sum(told) == pytest.approx(physics.FLOOR_SIGMA[1] ** -2, rel=1e-3)
    assert through_sigma(0.3, False, 7.0) == pytest.approx(np.hypot(0.3, physics.FLOOR_SIGMA[0]))


def test_the_near_zone_ends_at_a_metre_and_a_half() -> None:
    assert near_dbm(-40.0, 2.5) == pytest.approx(-40.0 - 25.0 * np.log10(1.5))


def test_what_is_known_of_a_technology_is_the_same_all_at_once_as_one_by_one() -> None:
    noise = LearnedNoise(squares=40.0, products=9.0, seen=20.0, odd=3.0)
    assert noise.terms(0.1) == (noise.factor, noise.shared, noise.outliers(0.1))
