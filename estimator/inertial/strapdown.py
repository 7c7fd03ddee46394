"""Inertial navigation of a boot, held by its own standstills: a filter of the errors of a strapdown system.

What the gyros and accelerometers tell is summed up to attitude, velocity and place. Each time that the boot
stands, its velocity is known to be nearly nil (ZUPT; Foxlin 2005, paper C): an extended Kalman filter of nine
errors, of place, velocity and attitude, then corrects all three, and with them the step just made. Paper C
corrects velocities in retrospect along a line; the covariances of the filter do that here.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import ERRORS, GRAVITY, RISE_M, Strapdown
from estimator.inertial.holding import hold
from estimator.inertial.levelling import gather
from estimator.inertial.rotations import turn_by
from estimator.inertial.stance import felt_by

VELOCITY_WALK = 0.01
"""Of a small MEMS accelerometer, 0.1 to 1 mg per root hertz, in m/s per root second."""
ATTITUDE_WALK = 1e-3
"""Of its gyro with what its scale and the blow of a heel do to it: 0.06° per root second."""


@njit(cache=True, error_model="numpy")
def advance(boot: Strapdown, force: Array, rate: Array, step_s: float) -> int:
    """Sum up samples, hold them by the standstills among them, and level what has not been levelled yet.

    Args:
        boot: changed in place.
        force: specific force, m × 3 (m/s²).
        rate: angular rate, m × 3 (rad/s).
        step_s: time from one sample to the next (s).

    Returns:
        How many samples it has taken: all, or those up to where it was levelled.
    """
    angle, halfway, ahead = np.empty(3), np.empty((3, 3)), np.empty(3)
    for i in range(len(force)):
        felt_by(boot.felt, force[i], rate[i], boot.bias, boot.known[GRAVITY], step_s)
        if boot.told[0] >= 0.0:
            gather(boot, force[i], rate[i], step_s)
            if boot.told[0] < 0.0:
                return i + 1
            continue
        for c in range(3):
            angle[c] = 0.5 * step_s * (rate[i, c] - boot.bias[c])
        turn_by(angle, boot.attitude, halfway)
        turn_by(angle, halfway, boot.attitude)
        for r in range(3):
            ahead[r] = halfway[r, 0] * force[i, 0] + halfway[r, 1] * force[i, 1] + halfway[r, 2] * force[i, 2]
        _spread(boot.covariance, ahead, step_s)
        ahead[2] -= boot.known[GRAVITY]
        boot.footing[RISE_M] += step_s * (boot.velocity[2] + 0.5 * step_s * ahead[2])
        for c in range(3):
            boot.place[c] += step_s * (boot.velocity[c] + 0.5 * step_s * ahead[c])
            boot.velocity[c] += step_s * ahead[c]
        hold(boot, ahead, step_s)
    return len(force)


@njit(cache=True, error_model="numpy")
def _spread(covariance: Array, force: Array, step_s: float) -> None:
    """Covariance after a sample: F P Fᵀ + Q, of p' = p + v Δt and v' = v − [f]× φ Δt, in place."""
    tilted = np.zeros((3, 3))
    tilted[0, 1], tilted[0, 2] = step_s * force[2], -step_s * force[1]
    tilted[1, 0], tilted[1, 2] = -step_s * force[2], step_s * force[0]
    tilted[2, 0], tilted[2, 1] = step_s * force[1], -step_s * force[0]
    for c in range(ERRORS):
        for r in range(3):
            covariance[r, c] += step_s * covariance[3 + r, c]
        for r in range(3):
            for j in range(3):
                covariance[3 + r, c] += tilted[r, j] * covariance[6 + j, c]
    for r in range(ERRORS):
        for c in range(3):
            covariance[r, c] += step_s * covariance[r, 3 + c]
        for c in range(3):
            for j in range(3):
                covariance[r, 3 + c] += tilted[c, j] * covariance[r, 6 + j]
    for c in range(3):
        covariance[3 + c, 3 + c] += VELOCITY_WALK**2 * step_s
        covariance[6 + c, 6 + c] += ATTITUDE_WALK**2 * step_s
