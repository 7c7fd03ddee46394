"""How a boot that stands holds its navigation: its velocity is nearly nil, and floors are flat."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import (
    AXIS,
    AZIMUTH,
    ERRORS,
    FLAT_M,
    FLAT_M2,
    HEADING,
    HELD_S,
    RISE_M,
    STOOD,
    Strapdown,
)
from estimator.inertial.rotations import turned_about
from estimator.inertial.stance import ALIKE_S, stance_sigma

UNHELD_S = 1.0
"""What a boot is moved by while it seems to stand is forgotten in so long: its tilt is not known better."""
STRIDE_S = 0.15
"""What has not stood for longer has made a stride."""
FOOTHOLD = 4
"""So many standstills in a row are a foothold: a tenth of a second."""
LEVEL_M, LEVEL_SIGMA_M = 0.05, 0.005
"""The lowest step of a stair is 10 cm: what has risen by less stands as high as before (paper C's height
correction)."""
RISE_SIGMA_M = 0.015
"""A stride's height is off by a centimetre or two, more than the filter itself believes."""


@njit(cache=True, error_model="numpy")
def hold(boot: Strapdown, ahead: Array, step_s: float) -> None:
    """Hold a boot's velocity against nil where it stands, and its height against that of its last foothold.

    Args:
        boot: changed in place.
        ahead: its acceleration by this sample, 3 (m/s²).
        step_s: time from the last sample to this one (s).
    """
    footing = boot.footing
    footing[HELD_S] += step_s
    sigma = stance_sigma(boot.felt, footing[HELD_S])
    if not np.isinf(sigma):
        footing[STOOD] = 1.0 if footing[HELD_S] > STRIDE_S else footing[STOOD] + 1.0
        footing[HELD_S] = 0.0
        _stand(boot, sigma)
    _follow(boot, ahead, step_s)


@njit(cache=True, error_model="numpy")
def _stand(boot: Strapdown, sigma: float) -> None:
    error = np.zeros(ERRORS)
    # One axis after the other: their errors at a standstill are independent of each other.
    for axis in range(3, 6):
        _correct(boot, error, axis, boot.velocity[axis - 3], sigma)
    if boot.footing[STOOD] == FOOTHOLD:
        _stand_as_high(boot, error)
    for c in range(3):
        boot.place[c] += error[c]
        boot.velocity[c] += error[3 + c]
    boot.footing[RISE_M] += error[2]
    boot.attitude[:] = turned_about(error[6:9], boot.attitude)
    axis = int(boot.known[AXIS])
    azimuth = np.arctan2(boot.attitude[1, axis], boot.attitude[0, axis])
    boot.known[HEADING] = azimuth - boot.known[AZIMUTH]


@njit(cache=True, error_model="numpy")
def _stand_as_high(boot: Strapdown, error: Array) -> None:
    """A foothold is as high as the one before, or a stair's step away; heights count from it from now on."""
    footing, rise_m = boot.footing, boot.footing[RISE_M] + error[2]
    if abs(rise_m) < LEVEL_M:
        boot.covariance[2, 2] += RISE_SIGMA_M**2
        _correct(boot, error, 2, footing[RISE_M], LEVEL_SIGMA_M)
        # Its unit rises with each stride, or the floor does: nothing tells one from the other.
        before_m2 = footing[FLAT_M] ** 2
        footing[FLAT_M] += rise_m
        footing[FLAT_M2] += max(footing[FLAT_M] ** 2 - before_m2, 0.0)
    footing[RISE_M] = -error[2]


@njit(cache=True, error_model="numpy")
def _correct(boot: Strapdown, error: Array, axis: int, value: float, sigma: float) -> None:
    """Take in that a state is nil, but for `sigma`; `error` takes by what all are to be corrected."""
    covariance = boot.covariance
    variance = covariance[axis, axis] + sigma * sigma
    gain = covariance[:, axis] / variance
    missed = -(value + error[axis])
    for r in range(ERRORS):
        error[r] += gain[r] * missed
    for r in range(ERRORS):
        for c in range(ERRORS):
            covariance[r, c] -= gain[r] * gain[c] * variance


@njit(cache=True, error_model="numpy")
def _follow(boot: Strapdown, ahead: Array, step_s: float) -> None:
    """Sum up what a boot that stands is moved by all the same: in a lift, on a stretcher, where it slides."""
    unheld, stands = boot.unheld, boot.footing[HELD_S] <= 2.0 * ALIKE_S
    for c in range(3):
        unheld[c] = unheld[c] * (1.0 - step_s / UNHELD_S) + step_s * ahead[c] if stands else 0.0
        unheld[3 + c] += step_s * unheld[c]
