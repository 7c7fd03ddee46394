"""A velocity that is forgotten with time (Singer's model, for velocity): Ornstein and Uhlenbeck 1930."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array


@njit(cache=True)
def ornstein_uhlenbeck(
    memory_s: float, across_mps: float, upwards_mps: float, duration_s: float
) -> tuple[Array, Array]:
    """Transition and noise of position and velocity, 6 × 6 each, where a usual speed is forgotten."""
    x = duration_s / memory_s
    kept, lost = np.exp(-x), -np.expm1(-x)
    both_lost = -np.expm1(-2.0 * x)
    position = 2.0 * x - 4.0 * lost + both_lost if x > 1e-2 else 2.0 / 3.0 * x**3
    transition, noise = np.eye(6), np.zeros((6, 6))
    for axis in range(3):
        speed = across_mps if axis < 2 else upwards_mps
        transition[axis, axis + 3], transition[axis + 3, axis + 3] = memory_s * lost, kept
        noise[axis, axis] = (speed * memory_s) ** 2 * position + 1e-6
        noise[axis, axis + 3] = noise[axis + 3, axis] = speed**2 * memory_s * lost**2
        noise[axis + 3, axis + 3] = speed**2 * both_lost + 1e-6
    return transition, noise
