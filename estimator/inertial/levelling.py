"""What is up, and what gyros at rest tell: what a boot's first half second is gathered for."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import (
    ATTITUDE,
    AXIS,
    AZIMUTH,
    BIAS_RADPS,
    CHANGED,
    ERRORS,
    FORCE,
    GRAVITY,
    GRAVITY_MPS2,
    HEADING,
    RATE,
    RESTED_S,
    SCALE,
    TURNED_RAD2,
    VELOCITY,
    Boot,
    Strapdown,
)
from estimator.inertial.rotations import azimuth_rad, level
from estimator.inertial.strapdown import FORCE_SIGMA_MPS2, SCALE_SIGMA, remove_errors
from estimator.inertial.zaru import ANEW_RAD2PS2, KNOWN_RADPS, RESTED_RADPS, UNRESTED_RADPS, bias_share

GRAVITY_OFF_MPS2 = 0.6
"""What a unit at rest may feel more or less of gravity: small accelerometers are off by 0.2 to 0.4 m/s² (20
to 40 mg) and by 1 to 3 % (data sheets of BMI270, LSM6DSO, ICM-42688)."""
FELT_MPS2 = 4.0
"""A unit that feels so much more or less for half a second falls, is dead, or measures in other units."""
ALIGN_S = 0.5
"""So long is looked for what is up, and for what gyros at rest tell."""
RESTING_RADPS, BIASED_RADPS = 0.05, 0.1
"""A boot that rests trembles by so much at most; a gyro's bias is less than this, 6 degrees a second."""
UNSETTLED = 0.1
"""What is less than this of what a bias is unsure by anyway is nothing."""
TILT_SIGMA_RAD = (0.02, 0.4)
"""Of a boot that rests while it is levelled, and of one that does not."""
ANYWHERE_RAD = 1.8
"""Standard deviation of a heading that may be any."""
START_SIGMA_MPS = (0.02, 2.0)
"""How fast it may be, or have been while it was levelled: a boot goes a stride in half a second, of 1.3 m
where its wearer walks and of two and more where he runs."""
SWING_SIGMA_MPS = (0.02, 3.0)
"""The same of what is not held by standstills: a boot may be swung when it begins."""
LEVEL_SIGMA_RAD = (0.003, 0.5)
"""The tilt beside what its accelerometers are off by."""
UP_SIGMA_MPS2 = 0.03
"""How well gravity is known: what accelerometers at rest feel more or less of it is their own."""


@njit(cache=True, error_model="numpy")
def add_levelling_sample(boot: Boot, force: Array, rate: Array, step_s: float) -> None:
    """Take in a sample of a boot that is to be levelled, and level it when there are enough.

    Args:
        boot: changed in place; it is `levelled` where this was the last sample that was wanting.
        force: specific force, 3 (m/s²).
        rate: angular rate, 3 (rad/s).
        step_s: time from one sample to the next (s).
    """
    told = boot.levelling
    told[0] += 1.0
    told[8] += step_s
    for c in range(3):
        told[1 + c] += force[c]
        told[4 + c] += rate[c]
        told[7] += rate[c] * rate[c]
        told[9 + c] += rate[c] if told[8] > 0.5 * ALIGN_S + 0.5 * step_s else -rate[c]
    if told[8] < ALIGN_S - 0.5 * step_s:
        return
    mean = told[1:4] / told[0]
    pull = np.sqrt(np.dot(mean, mean))
    if abs(pull - GRAVITY_MPS2) > FELT_MPS2:
        told[:] = 0.0
        return
    turning = told[4:7] / told[0]
    biased = np.dot(turning, turning)
    trembles = told[7] / told[0] - biased
    rests = (
        trembles < RESTING_RADPS**2
        and biased < BIASED_RADPS**2
        and abs(pull - GRAVITY_MPS2) < GRAVITY_OFF_MPS2
    )
    held, free = boot.held, boot.free
    if rests:
        boot.known[GRAVITY] = pull
    if rests and (boot.gyros[BIAS_RADPS] == 0.0 or boot.gyros[BIAS_RADPS] > KNOWN_RADPS):
        # What rests in its first quarter of a second and not in its second one has begun to move.
        unsettled = told[9:12] / told[0]
        share, more2 = bias_share(turning, np.dot(unsettled, unsettled))
        held.sensors[6:] = share * turning
        boot.gyros[CHANGED] = more2 if more2 > (UNSETTLED * RESTED_RADPS) ** 2 else 0.0
        if boot.gyros[BIAS_RADPS] > 0.0:
            boot.gyros[CHANGED], boot.gyros[RESTED_S] = ANEW_RAD2PS2, step_s
        boot.gyros[BIAS_RADPS] = np.sqrt(RESTED_RADPS**2 + more2)
    elif boot.gyros[BIAS_RADPS] == 0.0:
        boot.gyros[BIAS_RADPS] = UNRESTED_RADPS
        boot.gyros[CHANGED] = UNRESTED_RADPS**2 - RESTED_RADPS**2
    held.attitude[:] = level(mean, int(boot.known[AXIS]), boot.known[HEADING] + boot.known[AZIMUTH])
    unrested = 0 if rests else 1
    boot.known[TURNED_RAD2] += azimuth_variance_rad2(
        held.attitude[2, int(boot.known[AXIS])], TILT_SIGMA_RAD[unrested]
    )
    for axis in range(2):
        if abs(held.attitude[2, axis]) <= abs(held.attitude[2, 1 - axis]):
            boot.known[AXIS] = float(axis)
    axis = int(boot.known[AXIS])
    boot.known[AZIMUTH] = azimuth_rad(held.attitude, axis) - boot.known[HEADING]
    for c in range(3):
        held.covariance[VELOCITY + c, VELOCITY + c] = START_SIGMA_MPS[unrested] ** 2
    for c in range(2):
        held.covariance[ATTITUDE + c, ATTITUDE + c] = TILT_SIGMA_RAD[unrested] ** 2
    free.attitude[:] = held.attitude
    free.sensors[:] = held.sensors
    initial_free_covariance(free, mean, unrested, boot.gyros[BIAS_RADPS])
    if rests:
        _hold_gravity(free, mean)
    told[0] = -1.0


@njit(cache=True, error_model="numpy")
def azimuth_variance_rad2(up: float, tilt_rad: float) -> float:
    """Variance of an axis' azimuth by an unknown tilt (rad²): the steeper the axis, the larger.

    Turned about what it faces by a small tilt, an axis of elevation e veers by the tilt times tan e.

    Args:
        up: how much of the axis points up, sin e.
        tilt_rad: standard deviation of the tilt (rad).
    """
    level2 = max(1.0 - up * up, 1e-12)
    return min(tilt_rad * tilt_rad * up * up / level2, ANYWHERE_RAD**2)


@njit(cache=True, error_model="numpy")
def initial_free_covariance(boot: Strapdown, force: Array, unrested: int, bias_radps: float) -> None:
    """Set the covariance of a free navigation that has just been levelled, in place.

    Args:
        boot: the navigation; its sensors' biases and scales are states.
        force: mean specific force that it was levelled by, 3 (m/s²).
        unrested: 0 where the boot rested meanwhile, 1 where it did not.
        bias_radps: standard deviation of its gyros' biases (rad/s).
    """
    covariance, attitude = boot.covariance, boot.attitude
    for c in range(3):
        covariance[VELOCITY + c, VELOCITY + c] = SWING_SIGMA_MPS[unrested] ** 2
        covariance[FORCE + c, FORCE + c] = FORCE_SIGMA_MPS2**2
        covariance[SCALE + c, SCALE + c] = SCALE_SIGMA**2
        covariance[RATE + c, RATE + c] = bias_radps**2
    # What accelerometers are off by across gravity has been taken for a tilt.
    tilted = np.zeros((3, 6))
    for c in range(3):
        tilted[0, c], tilted[1, c] = -attitude[1, c] / GRAVITY_MPS2, attitude[0, c] / GRAVITY_MPS2
        tilted[:, 3 + c] = tilted[:, c] * force[c]
    offs = np.diag(np.diag(covariance)[FORCE:RATE])
    covariance[ATTITUDE:FORCE, FORCE:RATE] = tilted @ offs
    covariance[FORCE:RATE, ATTITUDE:FORCE] = (tilted @ offs).T
    covariance[ATTITUDE:FORCE, ATTITUDE:FORCE] = tilted @ offs @ tilted.T
    for c in range(2):
        covariance[ATTITUDE + c, ATTITUDE + c] += LEVEL_SIGMA_RAD[unrested] ** 2


@njit(cache=True, error_model="numpy")
def _hold_gravity(boot: Strapdown, force: Array) -> None:
    """Update biases and scales by the size of a force at rest, which is gravity's: 3 (m/s²)."""
    pull = np.sqrt(np.dot(force, force))
    row = np.zeros(ERRORS)
    for c in range(3):
        row[FORCE + c], row[SCALE + c] = force[c] / pull, force[c] * force[c] / pull
    along = boot.covariance @ row
    variance = np.dot(row, along) + UP_SIGMA_MPS2**2
    boot.covariance[:] -= np.outer(along, along) / variance
    remove_errors(boot, along * ((pull - GRAVITY_MPS2) / variance))
