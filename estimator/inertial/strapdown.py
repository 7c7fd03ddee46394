"""Inertial navigation: what accelerometers and gyros tell, summed up to attitude, velocity and place.

With it goes the covariance of its errors, those of the sensors' biases among them (Foxlin 2005; Titterton and
Weston, Strapdown Inertial Navigation Technology).
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import (
    ATTITUDE,
    ERRORS,
    FORCE,
    RATE,
    SCALE,
    VELOCITY,
    Strapdown,
)
from estimator.inertial.rotations import turn_by, turned_about

VELOCITY_WALK = 0.01
"""Of a small MEMS accelerometer, 0.1 to 1 mg per root hertz, in m/s per root second."""
ATTITUDE_WALK = 1e-3
"""Of its gyro with what its scale and the blow of a heel do to it: 0.06° per root second."""
FORCE_SIGMA_MPS2, SCALE_SIGMA = 0.1, 0.02
"""Bias of a small accelerometer, and how much its scale is off."""
FORGOTTEN_PER_RAD = 0.1
"""What an accelerometer is off by is another bias after ten radians: its axes are not quite square."""
BETWEEN = 0.3
"""What a force may be off by between two samples, as a share of what it changes by."""
RATE_WALK = 1e-4
"""Of a gyro's bias, in rad/s per root second: 5 to 20 degrees an hour where it stays as warm as it is, and
ten times that where it warms by 3 K a minute (0.01 to 0.02 °/s a kelvin; data sheets of LSM6DSO, BMI270)."""


@njit(cache=True, error_model="numpy")
def without_biases(boot: Strapdown, force: Array, rate: Array, found: Array) -> None:
    """A sample without what its sensors are known to be off by.

    Args:
        boot: what knows that.
        force: specific force, 3 (m/s²).
        rate: angular rate, 3 (rad/s).
        found: takes both, 6.
    """
    for c in range(3):
        found[c] = (force[c] - boot.sensors[c]) * (1.0 - boot.sensors[3 + c])
        found[3 + c] = rate[c] - boot.sensors[6 + c]


@njit(cache=True, error_model="numpy")
def propagate(boot: Strapdown, sample: Array, gravity_mps2: float, size: int, step_s: float) -> Array:
    """Take in a sample.

    Args:
        boot: changed in place.
        sample: specific force (m/s²) and angular rate (rad/s) as `without_biases` leaves them, 6.
        gravity_mps2: as it is felt.
        size: how many of the errors are states: all, or 9, where its sensors are taken for perfect.
        step_s: time from the last sample to this one (s).

    Returns:
        Its acceleration, 3 (m/s²).
    """
    angle, halfway, ahead = np.empty(3), np.empty((3, 3)), np.empty(3)
    squared = 0.0
    for c in range(3):
        angle[c] = 0.5 * step_s * sample[3 + c]
        squared += angle[c] * angle[c]
    turn_by(angle, boot.attitude, halfway)
    turn_by(angle, halfway, boot.attitude)
    for r in range(3):
        ahead[r] = halfway[r, 0] * sample[0] + halfway[r, 1] * sample[1] + halfway[r, 2] * sample[2]
    kept = np.exp(-2.0 * FORGOTTEN_PER_RAD * np.sqrt(squared))
    _propagate_covariance(boot.covariance, halfway, ahead, sample, kept, size, step_s)
    ahead[2] -= gravity_mps2
    for c in range(3):
        boot.place[c] += step_s * (boot.velocity[c] + 0.5 * step_s * ahead[c])
        boot.velocity[c] += step_s * ahead[c]
        if size == ERRORS:
            boot.sensors[c] *= kept
    return ahead


@njit(cache=True, error_model="numpy")
def _propagate_covariance(
    covariance: Array, attitude: Array, force: Array, sample: Array, kept: float, size: int, step_s: float
) -> None:
    """Covariance after a sample: F P Fᵀ + Q, in place.

    Place moves by v Δt, velocity by −([f]× φ + A b + A diag(s) f) Δt, attitude by −A g Δt; b, the bias of
    accelerometers, is partly another one after a turn; g, that of gyros, walks.
    """
    tilted, turned, scaled = np.zeros((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    tilted[0, 1], tilted[0, 2] = step_s * force[2], -step_s * force[1]
    tilted[1, 0], tilted[1, 2] = -step_s * force[2], step_s * force[0]
    tilted[2, 0], tilted[2, 1] = step_s * force[1], -step_s * force[0]
    for r in range(3):
        for c in range(3):
            turned[r, c] = -step_s * attitude[r, c]
            scaled[r, c] = turned[r, c] * sample[c]
    for c in range(size):
        for r in range(3):
            covariance[r, c] += step_s * covariance[VELOCITY + r, c]
        for r in range(3):
            for j in range(3):
                covariance[VELOCITY + r, c] += tilted[r, j] * covariance[ATTITUDE + j, c]
        if size < ERRORS:
            continue
        for r in range(3):
            for j in range(3):
                covariance[VELOCITY + r, c] += turned[r, j] * covariance[FORCE + j, c]
                covariance[VELOCITY + r, c] += scaled[r, j] * covariance[SCALE + j, c]
                covariance[ATTITUDE + r, c] += turned[r, j] * covariance[RATE + j, c]
        for r in range(3):
            covariance[FORCE + r, c] *= kept
    for r in range(size):
        row = covariance[r]
        for c in range(3):
            row[c] += step_s * row[VELOCITY + c]
        for c in range(3):
            for j in range(3):
                row[VELOCITY + c] += tilted[c, j] * row[ATTITUDE + j]
        if size < ERRORS:
            continue
        for c in range(3):
            for j in range(3):
                row[VELOCITY + c] += turned[c, j] * row[FORCE + j] + scaled[c, j] * row[SCALE + j]
                row[ATTITUDE + c] += turned[c, j] * row[RATE + j]
        for c in range(3):
            row[FORCE + c] *= kept
    for c in range(3):
        covariance[VELOCITY + c, VELOCITY + c] += VELOCITY_WALK**2 * step_s
        covariance[ATTITUDE + c, ATTITUDE + c] += ATTITUDE_WALK**2 * step_s
        if size == ERRORS:
            covariance[FORCE + c, FORCE + c] += FORCE_SIGMA_MPS2**2 * (1.0 - kept * kept)
            covariance[RATE + c, RATE + c] += RATE_WALK**2 * step_s


@njit(cache=True, error_model="numpy")
def doubt_force(boot: Strapdown, jerked_m2ps4: float, step_s: float) -> None:
    """Doubt a velocity by what a force may have been between two samples, where it changes fast.

    Args:
        boot: its covariance is changed in place.
        jerked_m2ps4: squared change of the force from one sample to the next (m²/s⁴).
        step_s: time between them (s).
    """
    for c in range(VELOCITY, ATTITUDE):
        boot.covariance[c, c] += (BETWEEN * step_s) ** 2 * jerked_m2ps4


@njit(cache=True, error_model="numpy")
def update_state(covariance: Array, error: Array, state: int, value: float, sigma: float) -> None:
    """Kalman update by a direct measurement of one state's error.

    Args:
        covariance: of the errors, 18 × 18; changed in place.
        error: the errors found so far, 18; this update is added to them.
        state: index among the errors.
        value: the measured error of that state.
        sigma: standard deviation of that.
    """
    variance = covariance[state, state] + sigma * sigma
    gain = covariance[:, state] / variance
    missed = value - error[state]
    for r in range(ERRORS):
        error[r] += gain[r] * missed
    for r in range(ERRORS):
        for c in range(ERRORS):
            covariance[r, c] -= gain[r] * gain[c] * variance


@njit(cache=True, error_model="numpy")
def remove_errors(boot: Strapdown, error: Array) -> None:
    """Correct a navigation by the errors that updates have found, 18."""
    for c in range(3):
        boot.place[c] += error[c]
        boot.velocity[c] += error[VELOCITY + c]
    for c in range(9):
        boot.sensors[c] += error[FORCE + c]
    boot.attitude[:] = turned_about(error[ATTITUDE:FORCE], boot.attitude)


@njit(cache=True, error_model="numpy")
def zero_velocity_update(boot: Strapdown, error: Array, velocity_mps: Array, sigma_mps: float) -> None:
    """Zero-velocity update (ZUPT), axis by axis: a standing boot has the velocity of its rolling.

    Args:
        boot: its covariance is changed in place.
        error: the errors found so far, 18; this update is added to them.
        velocity_mps: its true velocity, 3 (m/s).
        sigma_mps: standard deviation of that along each axis (m/s).
    """
    for axis in range(3):
        update_state(
            boot.covariance, error, VELOCITY + axis, velocity_mps[axis] - boot.velocity[axis], sigma_mps
        )
