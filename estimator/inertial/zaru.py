"""What a boot at rest tells of its gyros: what they report there is their bias (ZARU)."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import BIAS_RADPS, CHANGED, ERRORS, RATE, RATES, RESTED_S, SECONDS, SQUARES, Boot
from estimator.inertial.strapdown import RATE_WALK, remove_errors, update_state
from estimator.inertial.zero_velocity import QUIET

REST_S = 2.0
"""So long a rest tells a bias; a longer one tells it again."""
TURNING_RADPS = 0.1
"""Who turns so fast does not rest: no gyro is off by 6 degrees a second."""
TREMBLES = 0.3
"""What is left of a tremble in its mean over a second, as a share."""
RESTED_RADPS, UNRESTED_RADPS = 1e-3, 0.05
"""How well a bias is known where the first half second was a rest, for half a milliradian is no turn; and
before any rest: small gyros are off by 1 to 3 degrees a second (data sheets of LSM6DSO, BMI160)."""
SPREADS_RADPS2 = np.geomspace(1e-3, UNRESTED_RADPS, 6) ** 2
"""Gyros of one make are off by a milliradian a second, of another by fifty (data sheets of 3DM-GX5, BMI160):
nobody knows which a unit has, so each is as likely."""
SETTLES_RADPS = 0.01
"""A boot that seems to rest settles by a degree in two seconds."""
ANEW_RAD2PS2 = 0.1**2
"""After a rest that has told another bias, that of a heading has little to do with what it was before."""
TOLD_AFTER_S = 4.5
"""A bias counts from one keyframe to the next, which are two seconds apart: the new one is told when it has
begun for certain."""
KNOWN_RADPS = 5e-3
"""Of a bias that is known so well, a slow turn is more likely than another one."""


@njit(cache=True, error_model="numpy")
def apply_zaru(boot: Boot, rate: Array, step_s: float) -> None:
    """Add a sample to the running rest; after each `REST_S` of it, its mean rate updates the biases.

    Args:
        boot: changed in place.
        rate: angular rate as its gyros report it, 3 (rad/s).
        step_s: time from one sample to the next (s).
    """
    gyros = boot.gyros
    if gyros[RESTED_S] > 0.0:
        gyros[RESTED_S] += step_s
    gyros[BIAS_RADPS] = np.sqrt(gyros[BIAS_RADPS] ** 2 + RATE_WALK**2 * step_s)
    if boot.stance[QUIET] == 0.0:
        gyros[:BIAS_RADPS] = 0.0
        return
    gyros[SECONDS] += step_s
    for c in range(3):
        gyros[RATES + c] += step_s * rate[c]
        gyros[SQUARES] += step_s * rate[c] ** 2
    if gyros[SECONDS] < REST_S:
        return
    mean = gyros[RATES : RATES + 3] / gyros[SECONDS]
    tremble = max(gyros[SQUARES] / gyros[SECONDS] - np.dot(mean, mean), 0.0)
    gyros[:BIAS_RADPS] = 0.0
    if gyros[BIAS_RADPS] > KNOWN_RADPS and np.dot(mean, mean) < TURNING_RADPS**2:
        _correct_biases(boot, mean, np.sqrt(SETTLES_RADPS**2 + TREMBLES**2 * tremble), step_s)


@njit(cache=True, error_model="numpy")
def bias_share(turning: Array, told2: float) -> tuple[float, float]:
    """The share of the mean rates in a first rest that is bias, over all makes of gyro (`SPREADS_RADPS2`).

    Args:
        turning: mean rates, 3 (rad/s).
        told2: how far from the biases they may be along each axis, squared ((rad/s)²).

    Returns:
        The share of them that is bias, and the variance of what is left of each ((rad/s)²).
    """
    squared = np.dot(turning, turning)
    total = mean = square = left = 0.0
    for spread in SPREADS_RADPS2:
        variance = spread + told2
        weight = np.exp(-0.5 * squared / variance) * (SPREADS_RADPS2[0] / variance) ** 1.5
        share = spread / variance
        total += weight
        mean += weight * share
        square += weight * share**2
        left += weight * share * told2
    mean, square, left = mean / total, square / total, left / total
    return mean, left + max(square - mean**2, 0.0) * squared


@njit(cache=True, error_model="numpy")
def _correct_biases(boot: Boot, bias: Array, sigma_radps: float, step_s: float) -> None:
    """Update the gyro biases of both navigations by a measurement of them, 3, with its sigma (rad/s)."""
    gyros, error = boot.gyros, np.zeros(ERRORS)
    known2, told2 = gyros[BIAS_RADPS] ** 2, sigma_radps**2
    changed2 = 0.0
    for c in range(3):
        change = (bias[c] - boot.held.sensors[6 + c]) * known2 / (known2 + told2)
        boot.held.sensors[6 + c] += change
        changed2 += change * change
        update_state(boot.free.covariance, error, RATE + c, bias[c] - boot.free.sensors[6 + c], sigma_radps)
    remove_errors(boot.free, error)
    gyros[BIAS_RADPS] = np.sqrt(known2 * told2 / (known2 + told2))
    if changed2 > RESTED_RADPS**2:
        gyros[CHANGED] = ANEW_RAD2PS2
        gyros[RESTED_S] = step_s
