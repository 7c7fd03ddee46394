"""Samples of a boot, one after the other: a strapdown system that is held by its own standstills.

Each time that the boot stands, its velocity is known (ZUPT; Foxlin 2005, paper C): an
extended Kalman filter of its errors then corrects all of them, and with them the step just made. Paper C
corrects velocities in retrospect along a line; the covariances of the filter do that here.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import (
    ATTITUDE,
    BLOWN_M2PS4,
    ERRORS,
    FORCE,
    GRAVITY,
    GRAVITY_MPS2,
    SINCE_S,
    VELOCITY,
    Boot,
)
from estimator.inertial.footholds import HIDDEN_M2PS2, NOT_YET, due_s
from estimator.inertial.free_navigation import hold_or_release, start_free
from estimator.inertial.levelling import add_levelling_sample
from estimator.inertial.saturation import doubt, hidden_peak
from estimator.inertial.strapdown import doubt_force, propagate, without_biases
from estimator.inertial.zaru import apply_zaru
from estimator.inertial.zero_velocity import JERKED, add_sample
from estimator.inertial.zupt import apply_zupt


@njit(cache=True, error_model="numpy")
def note_hidden(boot: Boot) -> None:
    """Keep what a peak has hidden of the velocity: the next standstill tells that, and not the way till then.

    Each stride hides as much, and the same way.
    """
    for c in range(VELOCITY, ATTITUDE):
        boot.footholds[HIDDEN_M2PS2] = max(boot.footholds[HIDDEN_M2PS2], boot.held.covariance[c, c])


@njit(cache=True, error_model="numpy")
def advance(boot: Boot, force: Array, rate: Array, step_s: float) -> int:
    """Sum up samples, hold them by the standstills among them, and level what has not been levelled yet.

    Args:
        boot: changed in place.
        force: specific force, m × 3 (m/s²).
        rate: angular rate, m × 3 (rad/s).
        step_s: time from one sample to the next (s).

    Returns:
        How many samples it has taken: all, or those up to where it was levelled, or its way is to be cut.
    """
    sample, other, lost = np.empty(6), np.empty(6), np.empty(6)
    for i in range(len(force)):
        hidden = hidden_peak(boot.clipped, force[i], rate[i], step_s, lost)
        without_biases(boot.held, force[i], rate[i], sample)
        add_sample(boot.stance, sample[:3], sample[3:], boot.known[GRAVITY], step_s)
        if boot.levelling[0] >= 0.0:
            add_levelling_sample(boot, force[i], rate[i], step_s)
            if boot.levelling[0] < 0.0:
                start_free(boot)
                return i + 1
            continue
        without_biases(boot.free, force[i], rate[i], other)
        ahead = propagate(boot.held, sample, boot.known[GRAVITY], FORCE, step_s)
        propagate(boot.free, other, GRAVITY_MPS2, ERRORS, step_s)
        if hidden:
            doubt(boot.held, lost)
            doubt(boot.free, lost)
            note_hidden(boot)
        doubt_force(boot.free, boot.stance[JERKED], step_s)
        apply_zaru(boot, rate[i], step_s)
        boot.comparison[SINCE_S] += step_s
        boot.comparison[BLOWN_M2PS4] = max(boot.comparison[BLOWN_M2PS4], boot.stance[JERKED])
        sigma_mps = apply_zupt(boot, ahead, sample[3:], step_s)
        if not np.isinf(sigma_mps):
            hold_or_release(boot, sigma_mps)
        if due_s(boot.footholds) != NOT_YET:
            return i + 1
    return len(force)
