"""Steps that a unit has reported wrongly: a stumble, a wheel that spins, a standstill that was missed.

No step of the smoothed way need stand out: an error of a metre that no noise of the unit's explains is spread
over a minute of it. What stands out is the smoothed disturbance, ŵ of a step held against what it would vary
by, Q − V (auxiliary residuals: de Jong and Penzer, Diagnosing shocks in time series, JASA 93, 1998).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.fusion.memory.ledger import CLAIMED
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.walks import Motion
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

Doubts = dict[int, Array]
"""V of the steps of each walk that has a unit, by the walk's place in the window."""

SLIP_M = physics.SLIP_M
APART_S = 30.0
"""Steps as near as this to a slip stand out because of it."""
ELSE = 1.0
"""Log odds of a slip, before how rare it is, that must be left without the radio that tells most of it."""
NOTHING = 1e-9
"""Share of a step's information below which readings tell nothing of it (m⁻²)."""


class Slip(NamedTuple):
    """A step that was reported wrongly.

    Attributes:
        number: of the unit's node in the ledger.
        t: middle of the step's time (s).
        off_m: what is missing of it, or too much: east, north (m).
    """

    number: int
    t: float
    off_m: tuple[float, float]


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
    usual = 1.0 / SLIP_M**2
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


def find_slips(problem: Problem, solved: Solution, doubts: Doubts) -> list[Slip]:
    """The steps of all units that are likelier to have slipped than not.

    Args:
        problem: of a window.
        solved: its solution.
        doubts: see `doubts_of`.
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
            if _confirmed(problem, solved, slip, float(gain[k])):
                slips.append(slip)
            gain = np.where(np.abs(middle - middle[k]) < APART_S, -np.inf, gain)
    return slips


def _confirmed(problem: Problem, solved: Solution, slip: Slip, gain: float) -> bool:
    """Whether a slip would be found without the radio that pulls most at the ways before and after it.

    A wall that comes between two radios, or a breadcrumb that was kicked, changes what one of them says.
    """
    pairs, m = problem.rows.pairs, len(problem.rows.pairs)
    force = (solved.weighted.information * solved.weighted.residual)[:m]
    since = problem.rows.t[:m] - slip.t
    pull = np.zeros(len(problem.layout.state.owners))
    for own, other, columns in ((2, 3, slice(0, 2)), (3, 2, slice(6, 8))):
        near = np.flatnonzero((pairs[:, own] == slip.number) & (np.abs(since) < APART_S))
        along = solved.linear.jacobian[near, columns] @ np.array(slip.off_m)
        np.add.at(pull, pairs[near, other].astype(np.int64), along * force[near] * np.sign(since[near]))
    rest = pull.sum() - pull.max()
    return bool(rest > 0.0 and gain * (rest / pull.sum()) ** 2 > ELSE)


def withdraw(state: FusionState) -> None:
    """Take back all slips: whoever knows more is to judge them again.

    Args:
        state: its ledger loses the steps without displacement or time that stand for them.
    """
    steps = state.ledger.table("steps")
    slipped = (steps[:, 0] == steps[:, 2]) & (steps[:, 6] == physics.SLIP_M**2)
    state.ledger.replace("steps", steps[~slipped])


def widen_steps(state: FusionState, slips: list[Slip]) -> None:
    """Let the ledger's steps be as uncertain as slips are, where they have been found.

    Args:
        state: its ledger takes a step without displacement for each.
        slips: of a solved window; whoever solves it again finds them no more.
    """
    for slip in slips:
        up2, given = physics.DISPLACEMENT_FLOOR_M**2, CLAIMED
        state.ledger.add(
            "steps", slip.t, slip.number, slip.t, *(0.0,) * 3, physics.SLIP_M**2, up2, 0.0, 0.0, 0.0, given
        )
        name = state.owners[slip.number]
        text = f"{name} reported a step wrongly, by {np.hypot(*slip.off_m):.1f} m: it stumbled or slid"
        state.say("outlier", slip.t, name, text)
        state.count("outlier")
