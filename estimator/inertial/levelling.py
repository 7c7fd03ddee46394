"""What is up, and what gyros at rest tell: what a boot's first half second is gathered for."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import AXIS, AZIMUTH, GRAVITY, GRAVITY_MPS2, HEADING, Strapdown
from estimator.inertial.rotations import level

GRAVITY_OFF_MPS2 = 0.3
"""The Earth's gravity differs by 0.03 m/s² from place to place, a unit's scale by a few per cent of it."""
FELT_MPS2 = 4.0
"""A unit that feels so much more or less for half a second falls, is dead, or measures in other units."""
ALIGN_S = 0.5
"""So long is looked for what is up, and for what gyros at rest tell."""
RESTING_RADPS, BIASED_RADPS = 0.05, 0.1
"""A boot that rests trembles by so much at most; a gyro's bias is less than this, 6 degrees a second."""
TILT_SIGMA_RAD = (0.02, 0.2)
"""Of a boot that rests while it is levelled, and of one that does not."""
START_SIGMA_MPS = (0.02, 1.0)


@njit(cache=True, error_model="numpy")
def gather(boot: Strapdown, force: Array, rate: Array, step_s: float) -> None:
    """Take in a sample of a boot that is to be levelled, and level it when there are enough.

    Args:
        boot: changed in place; it is `levelled` where this was the last sample that was wanting.
        force: specific force, 3 (m/s²).
        rate: angular rate, 3 (rad/s).
        step_s: time from one sample to the next (s).
    """
    told = boot.told
    told[0] += 1.0
    told[8] += step_s
    for c in range(3):
        told[1 + c] += force[c]
        told[4 + c] += rate[c]
        told[7] += rate[c] * rate[c]
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
    if rests:
        boot.bias[:] = turning
        boot.known[GRAVITY] = pull
    boot.attitude[:] = level(mean, int(boot.known[AXIS]), boot.known[HEADING] + boot.known[AZIMUTH])
    for axis in range(2):
        if abs(boot.attitude[2, axis]) <= abs(boot.attitude[2, 1 - axis]):
            boot.known[AXIS] = float(axis)
    axis = int(boot.known[AXIS])
    azimuth = np.arctan2(boot.attitude[1, axis], boot.attitude[0, axis])
    boot.known[AZIMUTH] = azimuth - boot.known[HEADING]
    tilt, speed = TILT_SIGMA_RAD[0 if rests else 1], START_SIGMA_MPS[0 if rests else 1]
    for c in range(3):
        boot.covariance[3 + c, 3 + c] = speed * speed
    for c in range(2):
        boot.covariance[6 + c, 6 + c] = tilt * tilt
    told[0] = -1.0
