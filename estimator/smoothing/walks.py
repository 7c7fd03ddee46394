"""The way of each moving node between keyframes, as its own readings tell it."""

from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.free import free_motion
from estimator.graph.dense import Array

LONGEST_S = 600.0
"""Noise stops growing with the time between two reports there: nobody is followed over longer silences."""
FLOOR = np.array([1e-6, 1e-6, 1e-6, 1e-10, 1e-14, 1e-12])
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

    def at(self, t: Array) -> Array:
        """Sums up to epochs `t`, m × 12: displacement 3, its first moment 3, variances 5, length."""
        inside = np.clip(t, self._marks[0], self._marks[-1])
        right = np.clip(np.searchsorted(self._marks, inside, side="right"), 1, len(self._marks) - 1)
        left = right - 1
        if len(self._marks) == 1:
            return np.zeros((len(t), self._sums.shape[1]))
        span = self._marks[right] - self._marks[left]
        share = np.where(span > 0.0, (inside - self._marks[left]) / np.where(span > 0.0, span, 1.0), 1.0)
        return np.asarray(self._sums[left] + share[:, None] * (self._sums[right] - self._sums[left]))

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
        found = self.at(until) - self.at(since)
        found[:, 3:6] -= found[:, :3] * (since - self._begin)[:, None]
        silent = np.clip(until - np.maximum(since, self._marks[-1]), 0.0, LONGEST_S)
        wander = physics.SILENT_M_PER_ROOT_S**2 * silent
        found[:, 6] += wander
        found[:, 7] += 0.1 * wander
        return np.asarray(found)


class Motion(NamedTuple):
    """The motion of one node between its keyframes, linearised.

    Attributes:
        transition: F of each step, k × 6 × 6.
        noise: Q of each step, k × 6 × 6.
        residual: where the next keyframe is, less where the step leads, k × 6.
    """

    transition: Array
    noise: Array
    residual: Array


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
    before = states[:-1]
    led, transition = led_by(before, between[:, :3], between[:, 3:6], durations_s)
    count = len(durations_s)
    noise = np.zeros((count, STATES, STATES))
    variances = np.maximum(between[:, [6, 6, 7, 8, 9, 10]], 0.0) + FLOOR
    noise[:, range(STATES), range(STATES)] = variances
    # The noise is the unit's own: it is scaled with what it reports. Were it not, a smaller scale would
    # always fit better, for it makes every step's error smaller; so the derivative is by the way that was
    # gone.
    scale = 1.0 + before[:, 5]
    noise[:, range(3), range(3)] *= (scale**2)[:, None]
    transition[:, :3, 5] = (states[1:, :3] - before[:, :3]) / scale[:, None]
    lever = transition[:, :2, 3]
    turn = variances[:, 3]
    noise[:, :2, :2] += lever[:, :, None] * lever[:, None, :] * (turn / 3.0)[:, None, None]
    noise[:, :2, 3] += lever * (0.5 * turn)[:, None]
    noise[:, 3, :2] += lever * (0.5 * turn)[:, None]
    return Motion(transition, noise, states[1:] - led)


def led_by(before: Array, delta_m: Array, moment: Array, durations_s: Array) -> tuple[Array, Array]:
    """Where displacements lead from states (m × 6), and the derivatives by these states, m × 6 × 6."""
    psi, bias, scale = before[:, 3], before[:, 4], 1.0 + before[:, 5]
    cosine, sine = np.cos(psi), np.sin(psi)
    bent_e = delta_m[:, 0] - bias * moment[:, 1]
    bent_n = delta_m[:, 1] + bias * moment[:, 0]
    east, north = cosine * bent_e - sine * bent_n, sine * bent_e + cosine * bent_n
    by_bias_e = -cosine * moment[:, 1] - sine * moment[:, 0]
    by_bias_n = -sine * moment[:, 1] + cosine * moment[:, 0]
    after = before.copy()
    after[:, 0] += scale * east
    after[:, 1] += scale * north
    after[:, 2] += scale * delta_m[:, 2]
    after[:, 3] += bias * durations_s
    transition = np.broadcast_to(np.eye(STATES), (len(before), STATES, STATES)).copy()
    transition[:, 0, 3], transition[:, 1, 3] = -scale * north, scale * east
    transition[:, 0, 4], transition[:, 1, 4] = scale * by_bias_e, scale * by_bias_n
    transition[:, 0, 5], transition[:, 1, 5], transition[:, 2, 5] = east, north, delta_m[:, 2]
    transition[:, 3, 4] = durations_s
    return after, transition


def free_motions(role: str, durations_s: Array, states: Array) -> Motion:
    """The motion of a node without PDR: a velocity that is forgotten with time, k steps."""
    known = {d: free_motion(role, d) for d in set(durations_s.tolist())}
    transition = np.array([known[d][0] for d in durations_s.tolist()]).reshape(-1, STATES, STATES)
    noise = np.array([known[d][1] for d in durations_s.tolist()]).reshape(-1, STATES, STATES)
    return Motion(transition, noise, states[1:] - np.einsum("kij,kj->ki", transition, states[:-1]))
