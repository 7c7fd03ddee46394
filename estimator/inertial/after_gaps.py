"""Where a boot is found again after missing samples: by its next standstill, read backwards to them.

What a boot did meanwhile nobody knows. But a standstill tells what is up and that its velocity is nil, and
from there gyros and accelerometers lead back to the first sample after the gap as well as they lead on.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import (
    ATTITUDE,
    AXIS,
    AZIMUTH,
    BIAS_RADPS,
    FOOTHOLD_M,
    GRAVITY,
    HEADING,
    TURNED_RAD2,
    VELOCITY,
    Boot,
)
from estimator.inertial.free_navigation import start_free
from estimator.inertial.levelling import azimuth_variance_rad2, initial_free_covariance
from estimator.inertial.rotations import azimuth_rad, level, turn_by, turned_about
from estimator.inertial.strapdown import without_biases
from estimator.inertial.zero_velocity import LAST, add_sample, rolling_mps, stance_sigma
from estimator.inertial.zupt import note_heading

SOUGHT_S = 1.0
"""Whoever walks sets down each boot once in so long."""
STANDS_S = 0.1
"""What has stood for so long is a foothold."""
STANDS_MPS = 0.1
"""What may move faster while it does is none that tells what is up."""
TILT_SIGMA_RAD = 0.02
"""A boot that rolls over its sole is accelerated by 0.2 m/s²."""
START_SIGMA_MPS = 0.1
"""What that tilt makes of a velocity in half a second."""
STEEP = 0.9
"""An axis of which so much points up or down faces nothing that can be told."""


@njit(cache=True, error_model="numpy")
def find_standstill(boot: Boot, samples: Array, step_s: float) -> int:
    """Number of samples up to the end of the first standstill of `STANDS_S`; 0: there is none.

    Args:
        boot: what is known of its sensors.
        samples: specific force and angular rate, m × 6 (m/s², rad/s).
        step_s: time from one sample to the next (s).
    """
    stance, sample, stood_s = np.zeros(13), np.empty(6), 0.0
    for i in range(len(samples)):
        without_biases(boot.held, samples[i, :3], samples[i, 3:], sample)
        if i == 0:
            _begin_stance(stance, sample)
        add_sample(stance, sample[:3], sample[3:], boot.known[GRAVITY], step_s)
        stood_s = stood_s + step_s if stance_sigma(stance, np.inf) < STANDS_MPS else 0.0
        if stood_s > STANDS_S - 0.5 * step_s:
            return i + 1
    return 0


@njit(cache=True, error_model="numpy")
def level_backwards(boot: Boot, samples: Array, upto: int, step_s: float) -> bool:
    """Level a boot at a standstill, and lead it back to before its first sample.

    It is taken to face there what it faced before the gap.

    Args:
        boot: from `Boot.to_level_again`, changed in place: its navigation is then that at the beginning of
            the first sample.
        samples: specific force and angular rate, m × 6 (m/s², rad/s).
        upto: of so many the last ones are a standstill, see `find_standstill`.
        step_s: time from one sample to the next (s).

    Returns:
        False where nobody can say what it faces.
    """
    held, known, axis = boot.held, boot.known, int(boot.known[AXIS])
    middle = upto - max(round(0.5 * STANDS_S / step_s), 1)
    mean, sample = np.zeros(3), np.empty(6)
    for i in range(max(2 * middle - upto, 0), upto):
        without_biases(held, samples[i, :3], samples[i, 3:], sample)
        mean += sample[:3]
    attitude = level(mean, axis, 0.0)
    if abs(attitude[2, axis]) > STEEP:
        return False
    without_biases(held, samples[middle - 1, :3], samples[middle - 1, 3:], sample)
    velocity, below = rolling_mps(attitude, sample[3:]), np.zeros(3)
    halfway, before = np.empty((3, 3)), np.empty((3, 3))
    for i in range(middle - 1, -1, -1):
        without_biases(held, samples[i, :3], samples[i, 3:], sample)
        turn_by(-0.5 * step_s * sample[3:], attitude, halfway)
        turn_by(-0.5 * step_s * sample[3:], halfway, before)
        attitude[:] = before
        for r in range(3):
            ahead = halfway[r, 0] * sample[0] + halfway[r, 1] * sample[1] + halfway[r, 2] * sample[2]
            ahead -= known[GRAVITY] if r == 2 else 0.0
            velocity[r] -= step_s * ahead
            below[r] += step_s * (velocity[r] + 0.5 * step_s * ahead)
    if abs(attitude[2, axis]) > STEEP:
        return False
    turn = np.array([0.0, 0.0, known[HEADING] + known[AZIMUTH] - azimuth_rad(attitude, axis)])
    held.attitude[:] = turned_about(turn, attitude)
    cosine, sine = np.cos(turn[2]), np.sin(turn[2])
    held.velocity[0] = cosine * velocity[0] - sine * velocity[1]
    held.velocity[1] = sine * velocity[0] + cosine * velocity[1]
    held.velocity[2] = velocity[2]
    without_biases(held, samples[0, :3], samples[0, 3:], sample)
    _begin_stance(boot.stance, sample)
    held.covariance[:] = 0.0
    for c in range(3):
        held.covariance[VELOCITY + c, VELOCITY + c] = START_SIGMA_MPS**2
    for c in range(2):
        held.covariance[ATTITUDE + c, ATTITUDE + c] = TILT_SIGMA_RAD**2
    known[TURNED_RAD2] += azimuth_variance_rad2(held.attitude[2, axis], TILT_SIGMA_RAD)
    free = boot.free
    free.attitude[:], free.sensors[:], free.velocity[:] = held.attitude, held.sensors, held.velocity
    free.covariance[:] = 0.0
    initial_free_covariance(free, mean / (upto - max(2 * middle - upto, 0)), 1, boot.gyros[BIAS_RADPS])
    boot.footing[FOOTHOLD_M] = below[2]
    boot.levelling[0] = -1.0
    start_free(boot)
    return True


@njit(cache=True, error_model="numpy")
def _begin_stance(stance: Array, sample: Array) -> None:
    """Start a stance detector as if its first specific force had lasted for ever, in place."""
    stance[:] = 0.0
    stance[:3] = stance[5:8] = stance[LAST : LAST + 3] = sample[:3]


@njit(cache=True, error_model="numpy")
def keep_heading(boot: Boot) -> None:
    """Store the heading at which samples begin to be missing, unless its axis points up or down."""
    if abs(boot.held.attitude[2, int(boot.known[AXIS])]) < STEEP:
        note_heading(boot)
