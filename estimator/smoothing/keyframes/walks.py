"""The way of each moving node between keyframes, as its own readings tell it."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.learned.gait import kept
from estimator.fusion.motion.constant_velocity import free_motion
from estimator.graph.chain_kernels import half_inverse
from estimator.graph.dense import Array

FLOOR = np.array([1e-6, 1e-6, 1e-6, 1e-10, 1e-14, 1e-12])
VARIANCES = np.array([6, 6, 7, 8, 9, 10])
"""Which sums of a way are the variances of which states."""
STATES, PLACES = 6, 3
"""Numbers of a state, and how many of them in front are its place."""
HEADING, BIAS, SCALE = 3, 4, 5
"""Which of a unit's state's numbers are the heading, its gyro's bias, and its scale − 1."""


class Motion(NamedTuple):
    """The motion of one node between its keyframes, linearised.

    Attributes:
        transition: F of each step, k × 6 × 6.
        noise: Q of each step, k × 6 × 6.
        residual: where the next keyframe is, less where the step leads, k × 6.
        information: Q⁻¹ of each step, k × 6 × 6.
    """

    transition: Array
    noise: Array
    residual: Array
    information: Array


class DisplacementJacobian(NamedTuple):
    """A displacement in the map's frame (m), and its derivatives by heading, bias and scale."""

    east: float
    north: float
    up: float
    by_heading_e: float
    by_heading_n: float
    by_bias_e: float
    by_bias_n: float
    by_scale_e: float
    by_scale_n: float


@njit(cache=True)
def rotate_displacement(
    cosine: float, sine: float, bias: float, scale: float, delta_m: Array, moment: Array
) -> DisplacementJacobian:
    """S Rz(ψ) (Δ + β J M) of one displacement Δ (3) with its first moment M (3), and its derivatives.

    Heights are not scaled: see `measurements.displacement.move`.
    """
    bent_e, bent_n = delta_m[0] - bias * moment[1], delta_m[1] + bias * moment[0]
    east, north = cosine * bent_e - sine * bent_n, sine * bent_e + cosine * bent_n
    return DisplacementJacobian(
        scale * east,
        scale * north,
        delta_m[2],
        -scale * north,
        scale * east,
        -scale * (cosine * moment[1] + sine * moment[0]),
        scale * (cosine * moment[0] - sine * moment[1]),
        east,
        north,
    )


@njit(cache=True)
def dead_reckon(before: Array, delta_m: Array, moment: Array, durations_s: Array) -> tuple[Array, Array]:
    """States after displacements from states (m × 6), and their derivatives by these, m × 6 × 6."""
    count = len(before)
    after, transition = before.copy(), np.zeros((count, STATES, STATES))
    for i in range(count):
        cosine, sine = np.cos(before[i, 3]), np.sin(before[i, 3])
        led = rotate_displacement(cosine, sine, before[i, 4], 1.0 + before[i, 5], delta_m[i], moment[i])
        after[i, 0] += led.east
        after[i, 1] += led.north
        after[i, 2] += led.up
        after[i, 3] += before[i, 4] * durations_s[i]
        for c in range(STATES):
            transition[i, c, c] = 1.0
        transition[i, 0, 3], transition[i, 1, 3] = led.by_heading_e, led.by_heading_n
        transition[i, 0, 4], transition[i, 1, 4] = led.by_bias_e, led.by_bias_n
        transition[i, 0, 5], transition[i, 1, 5] = led.by_scale_e, led.by_scale_n
        transition[i, 3, 4] = durations_s[i]
    return after, transition


@njit(cache=True)
def reckon(states: Array, between: Array, durations_s: Array, known: int) -> None:
    """Put the keyframes after a known one where a unit's own way leads to.

    Args:
        states: position, ψ, β, s − 1 at k + 1 keyframes; those after `known` are changed.
        between: sums of each step, k × 12 (see `Way.between`).
        durations_s: of each step, k.
        known: the last keyframe that is known.
    """
    for k in range(known, len(durations_s)):
        cosine, sine = np.cos(states[k, 3]), np.sin(states[k, 3])
        led = rotate_displacement(
            cosine, sine, states[k, 4], 1.0 + states[k, 5], between[k, :3], between[k, 3:6]
        )
        states[k + 1] = states[k]
        states[k + 1, SCALE] *= kept(between[k, VARIANCES[SCALE]])
        states[k + 1, 0] += led.east
        states[k + 1, 1] += led.north
        states[k + 1, 2] += led.up
        states[k + 1, 3] += states[k, 4] * durations_s[k]


@njit(cache=True)
def inverses(matrices: Array) -> Array:
    """Inverses of symmetric positive definite matrices, m × n × n, exactly symmetric."""
    count, n, _ = matrices.shape
    found, half = np.empty((count, n, n)), np.empty((n, n))
    for i in range(count):
        half[:] = matrices[i]
        if not half_inverse(half):
            raise ValueError("a motion's noise is not positive definite")
        for r in range(n):
            for c in range(r + 1):
                total = 0.0
                for j in range(r, n):
                    total += half[j, r] * half[j, c]
                found[i, r, c] = found[i, c, r] = total
    return found


@njit(cache=True)
def unit_motion(between: Array, durations_s: Array, states: Array) -> Motion:
    """A unit's motion, with what its heading's random walk does on the way.

    p' = p + s Rz(ψ) (Δ + β J M), ψ' = ψ + β Δt: M is the displacements' first moment in time, exact to second
    order in β Δt however the way turns in between. A heading that walks randomly by variance v along a chord
    of length l moves its end sideways by v l² / 3, correlated with the heading by v l / 2.

    The derivative by the heading is by the way that was gone, J (p' − p), not by the one that was reported:
    turned as a whole, a way fits as it did. Otherwise each step whose ends do not quite fit would tell of
    where north is, and in two hours all of them together four times what anybody knows.

    Where its bearer begins to crawl, or to walk again, its scale is another one (`fusion.learned.gait`).

    Args:
        between: sums of each step, k × 12 (see `Way.between`).
        durations_s: of each step, k.
        states: position, ψ, β, s − 1 at k + 1 keyframes.
    """
    count = len(durations_s)
    led, transition = dead_reckon(states[:count], between[:, :3], between[:, 3:6], durations_s)
    noise, information = np.zeros((count, STATES, STATES)), np.zeros((count, STATES, STATES))
    residual = np.empty((count, STATES))
    for i in range(count):
        scale = 1.0 + states[i, 5]
        for c in range(STATES):
            noise[i, c, c] = max(between[i, VARIANCES[c]], 0.0) + FLOOR[c]
            residual[i, c] = states[i + 1, c] - led[i, c]
        transition[i, SCALE, SCALE] = share = kept(noise[i, SCALE, SCALE])
        residual[i, SCALE] = states[i + 1, SCALE] - share * states[i, SCALE]
        # The noise is the unit's own: it is scaled with what it reports. Were it not, a smaller scale would
        # always fit better, for it makes every step's error smaller; so the derivative is by the way that
        # was gone.
        for r in range(2):
            noise[i, r, r] *= scale**2
            transition[i, r, 5] = (states[i + 1, r] - states[i, r]) / scale
        for c in range(STATES):
            information[i, c, c] = 1.0 / noise[i, c, c]
        add_heading_walk(transition[i, 0, 3], transition[i, 1, 3], noise[i], information[i])
        transition[i, 0, 3] = states[i, 1] - states[i + 1, 1]
        transition[i, 1, 3] = states[i + 1, 0] - states[i, 0]
    return Motion(transition, noise, residual, information)


@njit(cache=True)
def add_heading_walk(lever_e: float, lever_n: float, noise: Array, information: Array) -> None:
    """Add the noise that a heading's random walk gives the end of a step, in closed form.

    Given where the heading ends, its walk still moves the end of a lever l sideways by v l² / 12: with the
    step's own variances that is a sum, so that nothing cancels.

    Args:
        lever_e: derivative of the end's place by the heading, east (m).
        lever_n: the same, north (m).
        noise: Q, 6 × 6, so far only its diagonal; changed.
        information: Q⁻¹, 6 × 6, the same.
    """
    turn, east, north = noise[3, 3], noise[0, 0], noise[1, 1]
    half_e, half_n, rest = 0.5 * lever_e, 0.5 * lever_n, turn / 12.0
    noise[0, 0] += lever_e * lever_e * turn / 3.0
    noise[1, 1] += lever_n * lever_n * turn / 3.0
    noise[0, 1] = noise[1, 0] = lever_e * lever_n * turn / 3.0
    noise[0, 3] = noise[3, 0] = half_e * turn
    noise[1, 3] = noise[3, 1] = half_n * turn
    unscale = 1.0 / (east * north + rest * (east * lever_n * lever_n + north * lever_e * lever_e))
    by_e = (north + rest * lever_n * lever_n) * unscale
    by_n = (east + rest * lever_e * lever_e) * unscale
    by_both = -rest * lever_e * lever_n * unscale
    pulled_e, pulled_n = by_e * half_e + by_both * half_n, by_both * half_e + by_n * half_n
    information[0, 0], information[1, 1] = by_e, by_n
    information[0, 1] = information[1, 0] = by_both
    information[0, 3] = information[3, 0] = -pulled_e
    information[1, 3] = information[3, 1] = -pulled_n
    information[3, 3] += half_e * pulled_e + half_n * pulled_n


class Free(NamedTuple):
    """A free motion, which is linear: F, Q and Q⁻¹ of each step, k × 6 × 6."""

    transition: Array
    noise: Array
    information: Array

    def first(self, steps: int) -> "Free":
        """So many steps of it, the first ones."""
        return Free(self.transition[:steps], self.noise[:steps], self.information[:steps])

    def motion(self, states: Array) -> Motion:
        """The motion with states of k + 1 keyframes."""
        residual = states[1:] - np.einsum("kij,kj->ki", self.transition, states[:-1])
        return Motion(self.transition, self.noise, residual, self.information)


def free_motions(role: str, durations_s: Array) -> Free:
    """The motion of a node without PDR: a velocity that is forgotten with time, k steps."""
    known = {d: free_motion(role, d) for d in set(durations_s.tolist())}
    transition = np.array([known[d][0] for d in durations_s.tolist()]).reshape(-1, STATES, STATES)
    noise = np.array([known[d][1] for d in durations_s.tolist()]).reshape(-1, STATES, STATES)
    return Free(transition, noise, inverses(noise))


@njit(cache=True)
def misfit(motion: Motion) -> float:
    """½ Σ rᵀ Q⁻¹ r of a node's motion."""
    total = 0.0
    count, size = motion.residual.shape
    for i in range(count):
        for r in range(size):
            pulled = 0.0
            for c in range(size):
                pulled += motion.information[i, r, c] * motion.residual[i, c]
            total += motion.residual[i, r] * pulled
    return 0.5 * total
