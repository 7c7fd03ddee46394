"""Steps that a unit has reported wrongly: a stumble, a wheel that spins, a standstill that was missed.

No step of the smoothed way need stand out: an error of a metre that no noise of the unit's explains is spread
over a minute of it. What stands out is the smoothed disturbance, ŵ of a step held against what it would vary
by, Q − V (auxiliary residuals: de Jong and Penzer, Diagnosing shocks in time series, JASA 93, 1998).
"""

from collections.abc import Callable

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.walks import Motion
from estimator.smoothing.learning.slip_judgement import APART_S, judged
from estimator.smoothing.learning.slips import Slip
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

Doubts = dict[int, Array]
"""V of the steps of each walk that has a unit, by the walk's place in the window."""

NOTHING = 1e-9
"""Share of a step's information below which readings tell nothing of it (m⁻²)."""


@njit(cache=True)
def disturbance_covariance(motion: Motion, found: Array, ahead: Array, walk: int, first: int) -> Array:
    """V: covariance of the smoothed disturbances w of a walk's steps, k × 6 × 6.

    Args:
        motion: of the walk.
        found: covariance of each walk at each keyframe, keyframes × walks × 6 × 6.
        ahead: of each with itself at the next keyframe.
        walk: which of them.
        first: keyframe that its first step leaves from.
    """
    count, size = motion.residual.shape
    covariance = np.empty((count, size, size))
    carried, across = np.empty((size, size)), np.empty((size, size))
    for i in range(count):
        way, at = motion.transition[i], first + i
        before, after, between = found[at, walk], found[at + 1, walk], ahead[at, walk]
        for r in range(size):
            for c in range(size):
                carried[r, c] = across[r, c] = 0.0
            for j in range(size):
                share = way[r, j]
                if share != 0.0:  # most of F is
                    for c in range(size):
                        carried[r, c] += share * before[j, c]
                        across[r, c] += share * between[j, c]
        for r in range(size):
            for c in range(size):
                covariance[i, r, c] = after[r, c] - across[r, c] - across[c, r]
        for r in range(size):
            for j in range(size):
                share = way[r, j]
                if share != 0.0:
                    for c in range(size):
                        covariance[i, c, r] += carried[c, j] * share
    return covariance


def doubts_of(problem: Problem, solved: Solution, found: Array, ahead: Array) -> Doubts:
    """How unsure the smoothed disturbances of all units are.

    Args:
        problem: of a window.
        solved: its solution.
        found: covariance of each walk at each keyframe, k × walks × 6 × 6.
        ahead: of each with itself at the next keyframe, (k − 1) × walks × 6 × 6.
    """
    return {
        i: disturbance_covariance(solved.motions[i], found, ahead, i, walk.first)
        for i, walk in enumerate(problem.layout.walks)
        if walk.way is not None and len(solved.motions[i].noise)
    }


@njit(cache=True)
def gains(motion: Motion, unsure_of: Array) -> tuple[Array, Array]:
    """How much likelier the readings are if a step has slipped, and by how much it then has.

    A jump δ, with u = Q⁻¹ ŵ and M = Q⁻¹ (Q − V) Q⁻¹, is told as M δ = u; a slip is N(0, S).

    Args:
        motion: of a walk.
        unsure_of: V of its steps.

    Returns:
        log p(z | slip) − log p(z | none) of each step, k; δ, k × 2 (m).
    """
    count, size = motion.residual.shape
    gain, off, pulled, told = np.empty(count), np.empty((count, 2)), np.empty(2), np.empty((2, 2))
    usual = 1.0 / physics.SLIP_M**2
    for i in range(count):
        known, doubt = motion.information[i], unsure_of[i]
        for r in range(2):
            pulled[r] = 0.0
            for j in range(size):
                pulled[r] += known[r, j] * motion.residual[i, j]
            for c in range(r + 1):
                told[r, c] = known[r, c]
                for j in range(size):
                    for k in range(size):
                        told[r, c] -= known[r, j] * doubt[j, k] * known[k, c]
        mean, half, both = 0.5 * (told[0, 0] + told[1, 1]), 0.5 * (told[0, 0] - told[1, 1]), told[1, 0]
        # Where readings tell nothing of a step, rounding is all that is left.
        felt = mean - np.sqrt(half * half + both * both) > NOTHING
        east, north = (told[0, 0] + usual, told[1, 1] + usual) if felt else (usual, usual)
        both = both if felt else 0.0
        size_of = east * north - both * both
        off[i, 0] = (north * pulled[0] - both * pulled[1]) / size_of
        off[i, 1] = (east * pulled[1] - both * pulled[0]) / size_of
        gain[i] = 0.5 * (pulled[0] * off[i, 0] + pulled[1] * off[i, 1]) - 0.5 * np.log(size_of / usual**2)
        if not felt:
            gain[i] = -np.inf
    return gain, off


def find_slips(
    problem: Problem, solved: Solution, doubts: Doubts, build: Callable[[FusionState], Problem]
) -> list[Slip]:
    """The steps of all units that are likelier to have slipped than not.

    Args:
        problem: of a window.
        solved: its solution.
        doubts: see `doubts_of`.
        build: builds the same problem of a fusion.
    """
    slips = []
    for i, doubt in doubts.items():
        walk = problem.layout.walks[i]
        gain, off = gains(solved.motions[i], doubt)
        times = problem.layout.times[walk.first : walk.last + 1, i]
        middle = 0.5 * (times[:-1] + times[1:])
        while len(gain) and gain.max() > physics.SLIP_RARE:
            k = int(gain.argmax())
            east, north = off[k].tolist()
            slip = Slip(walk.number, float(middle[k]), (east, north))
            found = judged(problem, solved, slip, float(gain[k]), build)
            slips += [] if found is None else [found]
            # Steps near a slip stand out because of it.
            gain = np.where(np.abs(middle - middle[k]) < APART_S, -np.inf, gain)
    return slips
