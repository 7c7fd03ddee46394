"""The way of each moving node between keyframes, as its own readings tell it."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.fusion.free import free_motion
from estimator.graph.dense import Array
from estimator.graph.kernels import half_inverse

LONGEST_S = 600.0
"""Noise stops growing with the time between two reports there: nobody is followed over longer silences."""
FLOOR = np.array([1e-6, 1e-6, 1e-6, 1e-10, 1e-14, 1e-12])
VARIANCES = np.array([6, 6, 7, 8, 9, 10])
"""Which sums of a way are the variances of which states."""
STATES = 6
LONG_STEP_S = 4.0
"""Nobody's way over a longer time is a straight line."""


class Way:
    """Displacements of one PDR unit summed up along its time, with the variances that they add.

    Args:
        begin_t: epoch at which it begins (s).
        steps: its rows of the ledger's `steps`, in order of epoch.
        factors: learned variances over the assumed ones: of position, of heading.
    """

    def __init__(self, begin_t: float, steps: Array, factors: tuple[float, float]) -> None:
        t, start, delta = steps[:, 0], steps[:, 2], steps[:, 3:6]
        assumed = steps[:, 11] == 0.0
        across = steps[:, 6] * np.where(assumed, factors[0], 1.0)
        upwards = steps[:, 7] * np.where(assumed, factors[0], 1.0)
        middle = 0.5 * (start + t) - begin_t
        parts = [
            delta,
            delta * middle[:, None],
            across[:, None],
            upwards[:, None],
            steps[:, 8:9] * factors[1],
            steps[:, 9:11],
            np.linalg.norm(delta[:, :2], axis=1)[:, None],
        ]
        each = np.concatenate(parts, axis=1)
        self._begin = begin_t
        self._marks = np.concatenate([[begin_t], t])
        self._sums = np.concatenate([np.zeros((1, each.shape[1])), np.cumsum(each, axis=0)])

    def bridged(self, t: Array) -> Array:
        """Variance of where it was at `t`, m (m²), inside a displacement over a long time.

        Only its two ends are known: between them the bearer may have walked anywhere, a Brownian bridge.
        """
        right = np.clip(np.searchsorted(self._marks, t, side="left"), 1, max(len(self._marks) - 1, 1))
        if len(self._marks) == 1:
            return np.zeros(len(t))
        before, after = self._marks[right - 1], self._marks[right]
        span = after - before
        inside = (span > LONG_STEP_S) & (t > before) & (t < after)
        return np.where(
            inside, physics.SILENT_M_PER_ROOT_S**2 * (t - before) * (after - t) / np.maximum(span, 1e-9), 0.0
        )

    def between(self, since: Array, until: Array) -> Array:
        """What lies between epochs, m × 12, moments from `since` on; silence adds a random walk."""
        since, until = np.ascontiguousarray(since), np.ascontiguousarray(until)
        found = sums_between(self._begin, self._marks, self._sums, since, until)
        silent = np.clip(until - np.maximum(since, self._marks[-1]), 0.0, LONGEST_S)
        wander = physics.SILENT_M_PER_ROOT_S**2 * silent
        found[:, 6] += wander
        found[:, 7] += 0.1 * wander
        return np.asarray(found)


@njit(cache=True)
def sum_up_to(marks: Array, sums: Array, t: float, found: Array) -> None:
    """Sums of a way up to one epoch, 12: displacement 3, its first moment 3, variances 5, length.

    Args:
        marks: epochs at which displacements end, ascending; before them that at which the first one began.
        sums: up to each of them.
        t: the epoch.
        found: takes the sums.
    """
    inside, last = min(max(t, marks[0]), marks[-1]), len(marks) - 1
    right = min(max(np.searchsorted(marks, inside, side="right"), 1), last)
    if last == 0:
        found[:] = 0.0
        return
    span = marks[right] - marks[right - 1]
    share = (inside - marks[right - 1]) / span if span > 0.0 else 1.0
    for c in range(len(found)):
        found[c] = sums[right - 1, c] + share * (sums[right, c] - sums[right - 1, c])


@njit(cache=True)
def sums_between(begin_t: float, marks: Array, sums: Array, since: Array, until: Array) -> Array:
    """What a way's displacements say of it between epochs, m × 12, moments from `since` on."""
    m, size = len(since), sums.shape[1]
    found, before = np.empty((m, size)), np.empty(size)
    for i in range(m):
        sum_up_to(marks, sums, since[i], before)
        sum_up_to(marks, sums, until[i], found[i])
        for c in range(size):
            found[i, c] -= before[c]
        for c in range(3):
            found[i, 3 + c] -= found[i, c] * (since[i] - begin_t)
    return found


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


class Led(NamedTuple):
    """Where a displacement leads to, less where from (m), and its derivatives by heading, bias and scale."""

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
def lead(psi: float, bias: float, scale: float, delta_m: Array, moment: Array) -> Led:
    """What is s Rz(ψ) (Δ + β J M) of one displacement Δ (3) with its first moment M (3), and its slopes.

    Heights are not scaled: see `measurements.displacement.move`.
    """
    cosine, sine = np.cos(psi), np.sin(psi)
    bent_e, bent_n = delta_m[0] - bias * moment[1], delta_m[1] + bias * moment[0]
    east, north = cosine * bent_e - sine * bent_n, sine * bent_e + cosine * bent_n
    return Led(
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
def led_by(before: Array, delta_m: Array, moment: Array, durations_s: Array) -> tuple[Array, Array]:
    """Where displacements lead from states (m × 6), and the derivatives by these states, m × 6 × 6."""
    count = len(before)
    after, transition = before.copy(), np.zeros((count, STATES, STATES))
    for i in range(count):
        led = lead(before[i, 3], before[i, 4], 1.0 + before[i, 5], delta_m[i], moment[i])
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
        led = lead(states[k, 3], states[k, 4], 1.0 + states[k, 5], between[k, :3], between[k, 3:6])
        states[k + 1] = states[k]
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
    """A unit's motion (estimation.md, point 1), with what its heading's random walk does on the way.

    p' = p + s Rz(ψ) (Δ + β J M), ψ' = ψ + β Δt: M is the displacements' first moment in time, exact to second
    order in β Δt however the way turns in between. A heading that walks randomly by variance v along a chord
    of length l moves its end sideways by v l² / 3, correlated with the heading by v l / 2.

    Args:
        between: sums of each step, k × 12 (see `Way.between`).
        durations_s: of each step, k.
        states: position, ψ, β, s − 1 at k + 1 keyframes.
    """
    count = len(durations_s)
    led, transition = led_by(states[:count], between[:, :3], between[:, 3:6], durations_s)
    noise, residual = np.zeros((count, STATES, STATES)), np.empty((count, STATES))
    for i in range(count):
        scale = 1.0 + states[i, 5]
        for c in range(STATES):
            noise[i, c, c] = max(between[i, VARIANCES[c]], 0.0) + FLOOR[c]
            residual[i, c] = states[i + 1, c] - led[i, c]
        turn = noise[i, 3, 3]
        # The noise is the unit's own: it is scaled with what it reports. Were it not, a smaller scale would
        # always fit better, for it makes every step's error smaller; so the derivative is by the way that
        # was gone.
        for r in range(2):
            noise[i, r, r] *= scale**2
            transition[i, r, 5] = (states[i + 1, r] - states[i, r]) / scale
        for r in range(2):
            lever = transition[i, r, 3]
            for c in range(2):
                noise[i, r, c] += lever * transition[i, c, 3] * turn / 3.0
            noise[i, r, 3] += lever * 0.5 * turn
            noise[i, 3, r] += lever * 0.5 * turn
    return Motion(transition, noise, residual, inverses(noise))


class Free(NamedTuple):
    """What is the same of a free motion wherever it is: F, Q and Q⁻¹ of each step, k × 6 × 6."""

    transition: Array
    noise: Array
    information: Array

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
