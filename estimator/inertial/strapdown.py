"""Inertial navigation of a boot, held by its own standstills: a filter of the errors of a strapdown system.

What the gyros and accelerometers tell is summed up to attitude, velocity and place. Each time that the boot
stands, its velocity is known to be nearly nil (ZUPT; Foxlin 2005, paper C): an extended Kalman filter of nine
errors, of place, velocity and attitude, then corrects all three, and with them the step just made. Paper C
corrects velocities in retrospect along a line; the covariances of the filter do that here.
"""

from typing import NamedTuple, Self

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.rotations import level, turn_by, turned_about
from estimator.inertial.stance import ALIKE_S, BEFORE, felt_by, stance_sigma

GRAVITY_MPS2 = 9.80665
GRAVITY_OFF_MPS2 = 0.3
"""The Earth's gravity differs by 0.03 m/s² from place to place, a unit's scale by a few per cent of it."""
FELT_MPS2 = 4.0
"""A unit that feels so much more or less for half a second falls, is dead, or measures in other units."""
VELOCITY_WALK = 0.01
"""Of a small MEMS accelerometer, 0.1 to 1 mg per root hertz, in m/s per root second."""
ATTITUDE_WALK = 1e-3
"""Of its gyro with what its scale and the blow of a heel do to it: 0.06° per root second."""
ALIGN_S = 0.5
"""So long is looked for what is up, and for what gyros at rest tell."""
RESTING_RADPS = 0.05
TILT_SIGMA_RAD = (0.02, 0.2)
"""Of a boot that rests while it is levelled, and of one that does not."""
START_SIGMA_MPS = (0.02, 1.0)
TOLD = 9
"""Numbers gathered while a boot is levelled: samples, forces 3, rates 3, their squares, seconds."""
ERRORS = 9
"""Place, velocity, attitude (3 each)."""
GRAVITY, HELD_S, HEADING, AXIS, AZIMUTH = range(5)
"""What `known` holds."""
UNHELD_S = 1.0
"""What a boot is moved by while it seems to stand is forgotten in so long: its tilt is not known better."""


class Strapdown(NamedTuple):
    """A boot's navigation between two samples. The frame has z up, and x where `heading_rad` says.

    Attributes:
        attitude: from the sensor's axes to the frame's, 3 × 3.
        velocity: 3 (m/s).
        place: 3 (m).
        covariance: of the errors of place, velocity and attitude, 9 × 9.
        bias: of the gyros, 3 (rad/s).
        felt: what the last samples were like, see `stance.felt_by`.
        told: what is gathered while it is levelled, see `TOLD`; its first number is −1 afterwards.
        known: gravity as the unit feels it (m/s²); how long ago a standstill last held it (s); what its x
            axis faced then (rad); which of its axes tells that, the most level one; and that one's direction
            less the x axis' (rad): 5.
        unheld: velocity (m/s) and way (m) that it seems to have while it stands, 6: that may move, too.
    """

    attitude: Array
    velocity: Array
    place: Array
    covariance: Array
    bias: Array
    felt: Array
    told: Array
    known: Array
    unheld: Array

    @classmethod
    def new(cls, heading_rad: float) -> Self:
        """One that nothing is known of yet, but what its x axis faces."""
        nothing = np.zeros(3)
        return cls(
            np.eye(3),
            nothing,
            nothing.copy(),
            np.zeros((ERRORS, ERRORS)),
            nothing.copy(),
            BEFORE.copy(),
            np.zeros(TOLD),
            np.array([GRAVITY_MPS2, 0.0, heading_rad, 0.0, 0.0]),
            np.zeros(6),
        )

    def anew(self) -> Self:
        """One that is to be levelled again, and faces what this one faced when it last stood."""
        again = self.new(self.heading_rad)
        again.known[AXIS], again.known[AZIMUTH] = self.known[AXIS], self.known[AZIMUTH]
        return again

    def copy(self) -> Self:
        """Another one that may be changed."""
        return type(self)(*(array.copy() for array in self))

    @property
    def levelled(self) -> bool:
        """Whether it is known what is up: before that it navigates nothing."""
        return bool(self.told[0] < 0.0)

    @property
    def heading_rad(self) -> float:
        """What its x axis faced when it last stood, seen from above (rad)."""
        return float(self.known[HEADING])


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
            _gather(boot, force[i], rate[i], step_s)
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
        for c in range(3):
            boot.place[c] += step_s * (boot.velocity[c] + 0.5 * step_s * ahead[c])
            boot.velocity[c] += step_s * ahead[c]
        boot.known[HELD_S] += step_s
        _hold(boot)
        _follow(boot, ahead, step_s)
    return len(force)


@njit(cache=True, error_model="numpy")
def _gather(boot: Strapdown, force: Array, rate: Array, step_s: float) -> None:
    """Take in a sample of a boot that is to be levelled, and level it when there are enough."""
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
    rests = told[7] / told[0] < RESTING_RADPS**2 and abs(pull - GRAVITY_MPS2) < GRAVITY_OFF_MPS2
    if rests:
        boot.bias[:] = told[4:7] / told[0]
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


@njit(cache=True, error_model="numpy")
def _hold(boot: Strapdown) -> None:
    """Hold a boot's velocity against nil, where it stands."""
    sigma = stance_sigma(boot.felt, boot.known[HELD_S])
    if np.isinf(sigma):
        return
    boot.known[HELD_S] = 0.0
    covariance = boot.covariance
    # One axis after the other: their errors at a standstill are independent of each other.
    gain, error = np.empty(ERRORS), np.zeros(ERRORS)
    for axis in range(3, 6):
        variance = covariance[axis, axis] + sigma * sigma
        gain[:] = covariance[:, axis] / variance
        missed = -(boot.velocity[axis - 3] + error[axis])
        for r in range(ERRORS):
            error[r] += gain[r] * missed
        for r in range(ERRORS):
            for c in range(ERRORS):
                covariance[r, c] -= gain[r] * gain[c] * variance
    for c in range(3):
        boot.place[c] += error[c]
        boot.velocity[c] += error[3 + c]
    boot.attitude[:] = turned_about(error[6:9], boot.attitude)
    axis = int(boot.known[AXIS])
    azimuth = np.arctan2(boot.attitude[1, axis], boot.attitude[0, axis])
    boot.known[HEADING] = azimuth - boot.known[AZIMUTH]


@njit(cache=True, error_model="numpy")
def _follow(boot: Strapdown, ahead: Array, step_s: float) -> None:
    """Sum up what a boot that stands is moved by all the same: in a lift, on a stretcher, where it slides."""
    unheld, stands = boot.unheld, boot.known[HELD_S] <= 2.0 * ALIKE_S
    for c in range(3):
        unheld[c] = unheld[c] * (1.0 - step_s / UNHELD_S) + step_s * ahead[c] if stands else 0.0
        unheld[3 + c] += step_s * unheld[c]
