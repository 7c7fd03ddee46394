"""How a boot that stands holds its navigation: its velocity is known, and floors are flat."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import (
    AXIS,
    AZIMUTH,
    ERRORS,
    FARTHEST_RAD,
    FLAT_M,
    FLAT_M2,
    FOOTHOLD_M,
    HEADING,
    HELD_S,
    STOOD,
    TURNED_RAD,
    TURNED_RAD2,
    VELOCITY,
    Boot,
)
from estimator.inertial.footholds import FOOTHOLD, HIDDEN_M2PS2, NOW_S, STRIDE_S, note_standstill
from estimator.inertial.rotations import azimuth_rad
from estimator.inertial.strapdown import remove_errors, update_state, zero_velocity_update
from estimator.inertial.zero_velocity import ALIKE_S, rolling_mps, stance_sigma

DISAGREES = 11.3
"""A boot that stands disagrees so much with its navigation once in a hundred times (χ² of three)."""
DOUBTED = 3.0
"""Held by what seems to be a standstill each time, a navigation believes more of itself than is true."""
CLEAR_MPS = 0.05
"""A boot that swings turns by half a radian a second at least: slower than this it stands, whatever its
navigation made of a blow."""
SWINGS_MOST_S = 1.0
"""Whoever walks sets each boot down more often: after that its navigation is no witness any more."""
UNHELD_S = 1.0
"""What a boot is moved by while it seems to stand is forgotten in so long: its tilt is not known better."""
LEVEL_M, LEVEL_SIGMA_M = 0.05, 0.005
"""The lowest step of a stair is 10 cm: what has risen by less stands as high as before (paper C's height
correction)."""
GYRO_SCALE_SIGMA = 0.005
"""Of small gyros: 0.5 to 1 % (data sheets of ICM-42688, LSM6DSO). Ten storeys down a stairwell are as many
turns, all the same way."""
RISE_SIGMA_M = 0.015
"""A stride's height is off by a centimetre or two, more than the filter itself believes."""


@njit(cache=True, error_model="numpy")
def apply_zupt(boot: Boot, ahead: Array, rate: Array, step_s: float) -> float:
    """Hold a boot that stands: its velocity against how it rolls, its height against its last foothold's.

    Args:
        boot: changed in place.
        ahead: its acceleration by this sample, 3 (m/s²).
        rate: its angular rate by this sample, without its bias, in the sensor's axes, 3 (rad/s).
        step_s: time from the last sample to this one (s).

    Returns:
        How far from that its velocity may be along each axis (m/s); infinite where it does not stand.
    """
    footing = boot.footing
    footing[HELD_S] += step_s
    boot.footholds[NOW_S] += step_s
    sigma, rolling = stance_sigma(boot.stance, footing[HELD_S]), rolling_mps(boot.held.attitude, rate)
    if not np.isinf(sigma) and _swings(boot, rolling, sigma):
        sigma = np.inf
    if not np.isinf(sigma):
        footing[STOOD] = 1.0 if footing[HELD_S] > STRIDE_S else footing[STOOD] + 1.0
        footing[HELD_S] = 0.0
        error = np.zeros(ERRORS)
        zero_velocity_update(boot.held, error, rolling, sigma)
        remove_errors(boot.held, error)
        if footing[STOOD] == FOOTHOLD:
            hold_level(boot)
        note_heading(boot)
        note_standstill(boot.footholds, boot.held.place)
    _sum_unheld(boot, ahead, step_s)
    return sigma


@njit(cache=True, error_model="numpy")
def _swings(boot: Boot, rolling: Array, sigma_mps: float) -> bool:
    """Whether a boot that seems to stand swings: its navigation knows that it goes faster than it may.

    What was held just now has not begun to swing. A navigation that says so for longer than a swing takes is
    wrong, and doubted.

    Args:
        boot: changed in place where its velocity is doubted.
        rolling: the velocity of a boot that stands, 3 (m/s).
        sigma_mps: how far from that it may be along each axis (m/s).
    """
    held, off_mps, squared = boot.held, rolling - boot.held.velocity, 0.0
    if sigma_mps < CLEAR_MPS or boot.footing[HELD_S] < STRIDE_S:
        return False
    for c in range(3):
        known = DOUBTED**2 * held.covariance[VELOCITY + c, VELOCITY + c]
        squared += off_mps[c] ** 2 / (known + sigma_mps**2)
    if squared < DISAGREES:
        return False
    if boot.footing[HELD_S] < SWINGS_MOST_S:
        return True
    for c in range(3):
        held.covariance[VELOCITY + c, VELOCITY + c] += off_mps[c] ** 2
        boot.footholds[HIDDEN_M2PS2] = max(boot.footholds[HIDDEN_M2PS2], off_mps[c] ** 2)
    return False


@njit(cache=True, error_model="numpy")
def _sum_unheld(boot: Boot, ahead: Array, step_s: float) -> None:
    """Integrate a standing boot's acceleration without ZUPT: a lift, a stretcher or a slide shows there."""
    unheld, stands = boot.unheld, boot.footing[HELD_S] <= 2.0 * ALIKE_S
    for c in range(3):
        unheld[c] = unheld[c] * (1.0 - step_s / UNHELD_S) + step_s * ahead[c] if stands else 0.0
        unheld[3 + c] += step_s * unheld[c]


@njit(cache=True, error_model="numpy")
def note_heading(boot: Boot) -> None:
    """Store the heading of a standing boot, how far it has turned in all, and the variance that adds."""
    known = boot.known
    heading_rad = azimuth_rad(boot.held.attitude, int(known[AXIS])) - known[AZIMUTH]
    known[TURNED_RAD] += (heading_rad - known[HEADING] + np.pi) % (2.0 * np.pi) - np.pi
    known[HEADING] = heading_rad
    farthest_rad = max(known[FARTHEST_RAD], abs(known[TURNED_RAD]))
    known[TURNED_RAD2] += GYRO_SCALE_SIGMA**2 * (farthest_rad**2 - known[FARTHEST_RAD] ** 2)
    known[FARTHEST_RAD] = farthest_rad


@njit(cache=True, error_model="numpy")
def hold_level(boot: Boot) -> None:
    """A foothold is as high as the one before, or a stair's step away; heights count from it from now on."""
    held, footing = boot.held, boot.footing
    rise_m = held.place[2] - footing[FOOTHOLD_M]
    if abs(rise_m) < LEVEL_M:
        error = np.zeros(ERRORS)
        held.covariance[2, 2] += RISE_SIGMA_M**2
        update_state(held.covariance, error, 2, -rise_m, LEVEL_SIGMA_M)
        remove_errors(held, error)
        # Its unit rises with each stride, or the floor does: nothing tells one from the other.
        before_m2 = footing[FLAT_M] ** 2
        footing[FLAT_M] += rise_m
        footing[FLAT_M2] += max(footing[FLAT_M] ** 2 - before_m2, 0.0)
    footing[FOOTHOLD_M] = held.place[2]
