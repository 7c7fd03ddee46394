"""A boot's navigation: where it leads, and how well it knows that."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimator.inertial.boot import HELD_S, Strapdown
from estimator.inertial.strapdown import ATTITUDE_WALK, VELOCITY_WALK, advance
from tests.estimator.inertial.gait import AROUND, STEP_S, Gait, Stride, walked


def led(gait: Gait, heading_rad: float = 0.0) -> Strapdown:
    boot, done = Strapdown.new(heading_rad), 0
    while done < len(gait.force):
        done += advance(boot, gait.force[done:], gait.rate[done:], STEP_S)
    return boot


def test_samples_without_errors_lead_along_the_way_and_up_the_stair() -> None:
    gait = walked(AROUND)
    boot = led(gait)
    np.testing.assert_allclose(boot.place, gait.place_m[-1], atol=0.005 * 22.0)
    assert boot.heading_rad == pytest.approx(gait.heading_rad, abs=0.01)


@pytest.mark.parametrize("seed", range(5))
def test_a_small_unit_is_a_hundredth_of_the_way_off(seed: int) -> None:
    gait = walked(AROUND).noisy(np.random.default_rng(seed))
    boot = led(gait)
    assert np.linalg.norm(boot.place - gait.place_m[-1]) < 0.015 * 22.0
    assert np.linalg.norm(boot.velocity) < 0.02


@pytest.mark.parametrize("angle_rad", [(0.0, 0.5, 0.0), (np.pi, 0.0, 0.0), (0.3, -1.2, 0.4)])
def test_however_the_unit_is_mounted(angle_rad: tuple[float, float, float]) -> None:
    """The frame's x axis is what the sensor's x axis faces at rest, seen from above."""
    mounted = Rotation.from_rotvec(angle_rad)
    faced = mounted.apply([1.0, 0.0, 0.0])
    gait = walked(AROUND, mounted=mounted)
    boot = led(gait, heading_rad=float(np.arctan2(faced[1], faced[0])))
    np.testing.assert_allclose(boot.place, gait.place_m[-1], atol=0.005 * 22.0)


@pytest.mark.parametrize("times", [1.0, 3.0])
def test_what_gyros_at_rest_tell_is_taken_for_their_bias(times: float) -> None:
    gait, bias = walked([Stride()] * 5), times * np.array([0.01, -0.02, 0.015])
    boot = led(gait._replace(rate=gait.rate + bias))
    np.testing.assert_allclose(boot.bias, bias, atol=1e-6)
    np.testing.assert_allclose(boot.place, gait.place_m[-1], atol=0.005 * 6.5)


def test_the_covariance_of_errors_is_that_of_its_linear_model() -> None:
    """F P Fᵀ + Q by whole matrices, while nothing holds a boot that swings."""
    gait = walked([Stride()])
    swing = slice(420, 470)
    boot = Strapdown.new(0.0)
    advance(boot, gait.force[:100], gait.rate[:100], STEP_S)
    advance(boot, gait.force[100:420], gait.rate[100:420], STEP_S)
    expected, attitude = boot.covariance.copy(), Rotation.from_matrix(boot.attitude)
    for force, rate in zip(gait.force[swing], gait.rate[swing], strict=True):
        f = (attitude * Rotation.from_rotvec(0.5 * STEP_S * (rate - boot.bias))).apply(force)
        attitude = attitude * Rotation.from_rotvec(STEP_S * (rate - boot.bias))
        tilt, drift = np.eye(9), np.eye(9)
        tilt[3:6, 6:9] = -STEP_S * np.array([[0, -f[2], f[1]], [f[2], 0, -f[0]], [-f[1], f[0], 0]])
        drift[0:3, 3:6] = STEP_S * np.eye(3)
        noise = np.diag([0.0] * 3 + [VELOCITY_WALK**2 * STEP_S] * 3 + [ATTITUDE_WALK**2 * STEP_S] * 3)
        # A place moves on with the velocity before the sample.
        expected = tilt @ drift @ expected @ drift.T @ tilt.T + noise
    boot.footing[HELD_S] = -1e9
    advance(boot, gait.force[swing], gait.rate[swing], STEP_S)
    np.testing.assert_allclose(boot.covariance, expected, rtol=1e-6, atol=1e-15)


def test_a_boot_that_never_stands_grows_unsure_of_its_speed() -> None:
    gait = walked([Stride()] * 3)
    boot = Strapdown.new(0.0)
    advance(boot, gait.force[:100], gait.rate[:100], STEP_S)
    advance(boot, gait.force[100:400], gait.rate[100:400], STEP_S)
    told = [boot.covariance[3, 3]]
    for _ in range(3):
        rolls = np.tile([5.0, 0.0, 0.0], (200, 1))
        advance(boot, np.tile([0.0, 0.0, 9.8], (200, 1)), rolls, STEP_S)
        told.append(boot.covariance[3, 3])
    assert told == sorted(told)
    # Its accelerometer alone tells so much less of it; what its tilt does comes on top.
    assert told[-1] - told[0] > 3.0 * VELOCITY_WALK**2
