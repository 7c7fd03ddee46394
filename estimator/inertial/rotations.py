"""Rotations in three dimensions, compiled: by an angle, and level with gravity."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array

SMALL_RAD = 1e-6
UPRIGHT = 1e-3
"""An axis with less of it in the horizontal plane has no direction there."""


@njit(cache=True, error_model="numpy")
def turn_by(angle: Array, attitude: Array, found: Array) -> None:
    """`attitude` after a turn about the axes that it turns from: A exp([φ]×), by Rodrigues' formula.

    Args:
        angle: φ, 3 (rad).
        attitude: A, 3 × 3.
        found: takes it, another 3 × 3.
    """
    x, y, z = angle[0], angle[1], angle[2]
    squared = x * x + y * y + z * z
    turned = np.sqrt(squared)
    if turned > SMALL_RAD:
        first, second = np.sin(turned) / turned, (1.0 - np.cos(turned)) / squared
    else:
        first, second = 1.0, 0.5
    for r in range(3):
        e, n, u = attitude[r, 0], attitude[r, 1], attitude[r, 2]
        along = second * (e * x + n * y + u * z)
        same = 1.0 - second * squared
        found[r, 0] = same * e + first * (n * z - u * y) + along * x
        found[r, 1] = same * n + first * (u * x - e * z) + along * y
        found[r, 2] = same * u + first * (e * y - n * x) + along * z


@njit(cache=True, error_model="numpy")
def turned_about(angle: Array, attitude: Array) -> Array:
    """`attitude` after a turn about the axes that it turns to: exp([φ]×) A, 3 × 3."""
    found = np.empty((3, 3))
    turn_by(-angle, attitude.T.copy(), found)
    return found.T.copy()


@njit(cache=True, error_model="numpy")
def azimuth_rad(attitude: Array, axis: int) -> float:
    """What an axis of the sensor faces, seen from above, from east (rad).

    Args:
        attitude: 3 × 3.
        axis: 0: the x axis; 1: the y axis.
    """
    return float(np.arctan2(attitude[1, axis], attitude[0, axis]))


@njit(cache=True, error_model="numpy")
def level(up: Array, axis: int, facing_rad: float) -> Array:
    """The attitude in which `up` points up, and the x or y axis, seen from above, faces somewhere.

    An axis that points straight up or down faces nothing; then the other one takes its place, a quarter turn
    away.

    Args:
        up: what is felt of gravity at rest, in the sensor's axes, 3 (m/s²).
        axis: 0: the x axis; 1: the y axis.
        facing_rad: direction of that axis in the horizontal plane, from east.

    Returns:
        3 × 3: its product with a vector in the sensor's axes is the same in east, north, up.
    """
    found, along = np.empty((3, 3)), np.zeros(3)
    found[2] = up / max(np.sqrt(np.dot(up, up)), 1e-12)
    lying = found[2, axis] ** 2 < 1.0 - UPRIGHT**2
    along[axis if lying else 1 - axis] = 1.0
    ahead = along - found[2] * np.dot(found[2], along)
    ahead /= np.sqrt(np.dot(ahead, ahead))
    aside = np.cross(found[2], ahead)
    quarter = 0.0 if lying else (0.5 if axis == 0 else -0.5) * np.pi
    cosine, sine = np.cos(facing_rad + quarter), np.sin(facing_rad + quarter)
    found[0] = cosine * ahead - sine * aside
    found[1] = sine * ahead + cosine * aside
    return found
