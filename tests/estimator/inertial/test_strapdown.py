"""Strapdown navigation: its errors spread as its linear model says, and what is told of them is taken in."""

import numpy as np
import pytest
from numba import njit
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from estimator.graph.dense import Array
from estimator.inertial.boot import ATTITUDE, ERRORS, FORCE, GRAVITY_MPS2, RATE, SCALE, VELOCITY, Strapdown
from estimator.inertial.strapdown import (
    ATTITUDE_WALK,
    FORCE_SIGMA_MPS2,
    FORGOTTEN_PER_RAD,
    RATE_WALK,
    VELOCITY_WALK,
    propagate,
    remove_errors,
    update_state,
    without_biases,
    zero_velocity_update,
)
from tests.estimator.inertial.gait import STEP_S, Stride, walked

SWING = slice(420, 470)


def unsure(chance: np.random.Generator) -> Strapdown:
    """A navigation whose errors hang together, and whose sensors are known to be off."""
    boot = Strapdown.new()
    root = chance.normal(0.0, 0.05, (ERRORS, ERRORS))
    boot.covariance[:] = root @ root.T
    boot.sensors[:] = chance.normal(0.0, 0.02, 9)
    boot.velocity[:] = chance.normal(0.0, 0.5, 3)
    return boot


@njit()
def take_in(boot: Strapdown, sample: Array) -> None:
    propagate(boot, sample, GRAVITY_MPS2, ERRORS, STEP_S)


def carried(boot: Strapdown, force: Array, rate: Array) -> None:
    sample = np.empty(6)
    for one, other in zip(force, rate, strict=True):
        without_biases(boot, one, other, sample)
        take_in(boot, sample)


def test_the_covariance_of_errors_is_that_of_its_linear_model() -> None:
    """F P Fᵀ + Q by whole matrices, through a swing."""
    gait, boot = walked([Stride()]), unsure(np.random.default_rng(1))
    expected, attitude, sensors = boot.covariance.copy(), Rotation.identity(), boot.sensors.copy()
    for force, rate in zip(gait.force[SWING], gait.rate[SWING], strict=True):
        felt, turning = (force - sensors[:3]) * (1.0 - sensors[3:6]), rate - sensors[6:]
        halfway = (attitude * Rotation.from_rotvec(0.5 * STEP_S * turning)).as_matrix()
        attitude = attitude * Rotation.from_rotvec(STEP_S * turning)
        f = halfway @ felt
        kept = np.exp(-FORGOTTEN_PER_RAD * STEP_S * np.linalg.norm(turning))
        model = np.eye(ERRORS)
        model[:3, VELOCITY:ATTITUDE] = STEP_S * np.eye(3)
        model[VELOCITY:ATTITUDE, ATTITUDE:FORCE] = -STEP_S * np.array(
            [[0, -f[2], f[1]], [f[2], 0, -f[0]], [-f[1], f[0], 0]]
        )
        model[VELOCITY:ATTITUDE, FORCE:SCALE] = -STEP_S * halfway
        model[VELOCITY:ATTITUDE, SCALE:RATE] = -STEP_S * halfway * felt
        model[ATTITUDE:FORCE, RATE:] = -STEP_S * halfway
        model[FORCE:SCALE, FORCE:SCALE] *= kept
        walks = [0.0, VELOCITY_WALK**2, ATTITUDE_WALK**2, 0.0, 0.0, RATE_WALK**2]
        noise = block_diag(*[STEP_S * each * np.eye(3) for each in walks])
        noise[FORCE:SCALE, FORCE:SCALE] = FORCE_SIGMA_MPS2**2 * (1.0 - kept**2) * np.eye(3)
        # Each state moves on with the others as they were before the sample.
        expected = model @ expected @ model.T + noise
        sensors[:3] *= kept
    carried(boot, gait.force[SWING], gait.rate[SWING])
    np.testing.assert_allclose(boot.covariance, expected, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("state", range(VELOCITY, ERRORS))
def test_a_small_error_leads_where_its_linear_model_says(state: int) -> None:
    """Finite differences: what is true less what is told, carried on by both; but for half a sample."""
    gait, size = walked([Stride()]), 1e-6
    told, true = Strapdown.new(), Strapdown.new()
    error = np.zeros(ERRORS)
    error[state] = size
    remove_errors(true, error)
    told.covariance[:] = np.outer(error, error)
    for boot in (told, true):
        carried(boot, gait.force[SWING], gait.rate[SWING])
    quiet = Strapdown.new()
    carried(quiet, gait.force[SWING], gait.rate[SWING])
    spread = told.covariance - quiet.covariance
    column = spread[:, state] / np.sqrt(spread[state, state])
    found = np.concatenate([true.place - told.place, true.velocity - told.velocity])
    np.testing.assert_allclose(found, column[:ATTITUDE], rtol=2e-2, atol=6e-3 * size)


def test_what_is_told_of_a_state_is_taken_in_as_by_bayes() -> None:
    """The information form: the inverse covariance gains what is told."""
    boot = unsure(np.random.default_rng(2))
    before, error = boot.covariance.copy(), np.zeros(ERRORS)
    update_state(boot.covariance, error, 7, 0.3, 0.1)
    row = np.zeros(ERRORS)
    row[7] = 10.0
    information = np.linalg.inv(before) + np.outer(row, row)
    np.testing.assert_allclose(boot.covariance, np.linalg.inv(information), rtol=1e-6, atol=1e-10)
    np.testing.assert_allclose(error, np.linalg.solve(information, row * 3.0), rtol=1e-6, atol=1e-10)


def test_who_stands_has_no_velocity() -> None:
    boot, error = unsure(np.random.default_rng(3)), np.zeros(ERRORS)
    zero_velocity_update(boot, error, np.zeros(3), 1e-4)
    remove_errors(boot, error)
    assert np.abs(boot.velocity).max() < 1e-3
    assert np.abs(boot.covariance[VELOCITY:ATTITUDE, VELOCITY:ATTITUDE]).max() < 1e-7
