"""Steps that a unit has reported wrongly: a stumble, a wheel that spins, a standstill that was missed.

No step of the smoothed way need stand out: an error of a metre that no noise of the unit's explains is spread
over a minute of it. What stands out is the smoothed disturbance, ŵ of a step held against what it would vary
by, Q − V (auxiliary residuals: de Jong and Penzer, Diagnosing shocks in time series, JASA 93, 1998).
"""

from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.solve import Problem, Solved
from estimator.smoothing.walks import Motion

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


def unsure(motion: Motion, before: Array, after: Array, ahead: Array) -> Array:
    """V: covariance of the smoothed disturbances w of a walk's steps, k × 6 × 6.

    Args:
        motion: of the walk.
        before: covariance at the beginning of each step, k × 6 × 6.
        after: the same at its end.
        ahead: of the beginning with the end.
    """
    transition = motion.transition
    carried = np.matmul(transition, ahead)
    found = after + np.matmul(np.matmul(transition, before), transition.transpose(0, 2, 1))
    return np.asarray(found - carried - carried.transpose(0, 2, 1))


def gains(motion: Motion, unsure_of: Array) -> tuple[Array, Array]:
    """How much likelier the readings are if a step has slipped, and by how much it then has.

    A jump δ, with u = Q⁻¹ ŵ and M = Q⁻¹ (Q − V) Q⁻¹, is told as M δ = u; a slip is N(0, S).

    Args:
        motion: of a walk.
        unsure_of: V of its steps.

    Returns:
        log p(z | slip) − log p(z | none) of each step, k; δ, k × 2 (m).
    """
    inverse = motion.information
    pulled = np.matmul(inverse, motion.residual[:, :, None])[:, :2]
    told = (inverse - np.matmul(np.matmul(inverse, unsure_of), inverse))[:, :2, :2]
    usual = np.eye(2) / physics.SLIP_M**2
    # Where readings tell nothing of a step, rounding is all that is left.
    felt = np.linalg.eigvalsh(told)[:, 0] > NOTHING
    told = np.where(felt[:, None, None], told, 0.0)
    off = np.linalg.solve(told + usual, pulled)
    size = np.linalg.det(np.eye(2) + physics.SLIP_M**2 * told)
    gain = 0.5 * (pulled * off).sum(axis=(1, 2)) - 0.5 * np.log(size)
    return np.where(felt, gain, -np.inf), off[:, :, 0]


def find_slips(problem: Problem, solved: Solved, found: Array, ahead: Array) -> list[Slip]:
    """The steps of all units that are likelier to have slipped than not.

    Args:
        problem: of a window.
        solved: its solution.
        found: covariance of each walk at each keyframe, k × walks × 6 × 6.
        ahead: of each with itself at the next keyframe, (k − 1) × walks × 6 × 6.
    """
    slips = []
    for i, walk in enumerate(problem.layout.walks):
        motion = solved.motions[i]
        if walk.way is None or not len(motion.noise):
            continue
        now = slice(walk.first, walk.last)
        covariance = unsure(motion, found[now, i], found[walk.first + 1 : walk.last + 1, i], ahead[now, i])
        gain, off = gains(motion, covariance)
        times = problem.layout.times[walk.first : walk.last + 1, i]
        middle = 0.5 * (times[:-1] + times[1:])
        while len(gain) and gain.max() > physics.SLIP_RARE:
            k = int(gain.argmax())
            east, north = off[k].tolist()
            slip = Slip(walk.number, float(middle[k]), (east, north))
            if _agreed(problem, solved, slip, float(gain[k])):
                slips.append(slip)
            gain = np.where(np.abs(middle - middle[k]) < APART_S, -np.inf, gain)
    return slips


def _agreed(problem: Problem, solved: Solved, slip: Slip, gain: float) -> bool:
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


def admit(state: FusionState, slips: list[Slip]) -> None:
    """Let the ledger's steps be as uncertain as slips are, where they have been found.

    Args:
        state: its ledger takes a step without displacement for each.
        slips: of a solved window; whoever solves it again finds them no more.
    """
    for slip in slips:
        up2, given = physics.DISPLACEMENT_FLOOR_M**2, 1.0
        state.ledger.add(
            "steps", slip.t, slip.number, slip.t, *(0.0,) * 3, physics.SLIP_M**2, up2, 0.0, 0.0, 0.0, given
        )
        name = state.owners[slip.number]
        text = f"{name} reported a step wrongly, by {np.hypot(*slip.off_m):.1f} m: it stumbled or slid"
        state.say("outlier", slip.t, name, text)
        state.count("outlier")
