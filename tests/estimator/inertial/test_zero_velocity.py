"""How nearly a boot stands, by what it feels."""

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.inertial.zero_velocity import (
    ALIKE_S,
    BEFORE,
    LEVER_M,
    MOST_MPS,
    STEADY_MPS,
    add_sample,
    rolling_mps,
    stance_sigma,
)
from tests.estimator.inertial.gait import STANCE_S, STEP_S, SWING_S, Stride, walked


def sigmas(force: np.ndarray, rate: np.ndarray) -> np.ndarray:
    felt, found = BEFORE.copy(), []
    for one, other in zip(force, rate, strict=True):
        add_sample(felt, one, other, 9.80665, STEP_S)
        found.append(stance_sigma(felt, ALIKE_S))
    return np.array(found)


def test_a_boot_at_rest_stands_as_still_as_one_can() -> None:
    gait = walked([])
    assert sigmas(gait.force, gait.rate)[-1] < 1.1 * STEADY_MPS


def test_a_boot_that_swings_tells_nothing_and_one_that_stands_does() -> None:
    gait = walked([Stride()] * 10)
    found = sigmas(gait.force, gait.rate)
    speed = np.linalg.norm(np.diff(gait.place_m, axis=0, prepend=0.0), axis=1) / STEP_S
    assert np.isinf(found[speed > 2.0 * MOST_MPS]).all()
    stands = speed == 0.0
    assert np.isfinite(found[stands]).mean() > 0.8
    assert 0.8 < np.isfinite(found).sum() / stands.sum() < 1.1
    assert stands.sum() * STEP_S > 10 * STANCE_S > 10 * SWING_S


def test_what_its_speed_can_be_grows_with_what_it_turns_by() -> None:
    rest = np.tile([0.0, 0.0, 9.80665], (100, 1))
    told = [sigmas(rest, np.tile([turning, 0.0, 0.0], (100, 1)))[-1] for turning in (0.0, 0.1, 0.5, 1.0)]
    assert told == sorted(told)
    assert told[-1] > 5.0 * told[0]


def test_a_unit_on_a_boot_that_rolls_moves_as_its_height_above_the_ground_is_turned() -> None:
    """Against differences: the boot is turned by a little about where it stands."""
    chance, short_s = np.random.default_rng(4), 1e-6
    for _ in range(20):
        attitude, rate = Rotation.random(random_state=int(chance.integers(1 << 30))), chance.normal(size=3)
        up = attitude.inv().apply([0.0, 0.0, LEVER_M])
        later = attitude * Rotation.from_rotvec(rate * short_s)
        moved = (later.apply(up) - attitude.apply(up)) / short_s
        np.testing.assert_allclose(rolling_mps(attitude.as_matrix(), rate), moved, atol=1e-5)


def test_standstills_near_to_each_other_count_once() -> None:
    gait = walked([])
    felt = BEFORE.copy()
    for force, rate in zip(gait.force, gait.rate, strict=True):
        add_sample(felt, force, rate, 9.80665, STEP_S)
    assert np.isinf(stance_sigma(felt, 0.5 * ALIKE_S))
    assert np.isfinite(stance_sigma(felt, ALIKE_S))
