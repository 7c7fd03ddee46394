"""How noisy each PDR unit is, as its own way through the window tells.

The score of the marginal likelihood by a noise parameter is what the smoothed steps say of it (Fisher's
identity): ½ Σ [E(w wᵀ) − Q] : Q⁻¹ Q_i Q⁻¹, with E(w wᵀ) = ŵ ŵᵀ + V. A few damped steps along it, one with
each solution of the window, find the variance under which unit and radio agree best, and not a smaller one:
what the radio does not see of a step stays in V.
"""

import numpy as np
from msgspec.structs import replace

from estimator.fusion.calibration import narrow_sigma, scale_sigma, uncalibrated
from estimator.fusion.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.slips import admit, find_slips, unsure
from estimator.smoothing.solve import Problem, Solved

SPREAD = 1.0
"""Units differ from the usual one by this much in the logarithm of a variance."""
STEP = 0.3
SEEN = 0.03
"""Share of a step's own noise that readings usually tell apart: what a score is held against."""
LEAST, MOST = 0.03, 20.0


def learn(state: FusionState, problem: Problem, solved: Solved, step: float = STEP) -> Array:
    """Learn from a solved window how noisy each unit is, and which technologies are calibrated.

    Args:
        state: takes what is learned.
        problem: of the window.
        solved: its solution, whose chain is solved here.
        step: farthest that the logarithm of a variance moves at once.

    Returns:
        Covariance of each walk at each keyframe, k × walks × 6 × 6.
    """
    solved.chain.solve()
    found, ahead, border = solved.chain.covariances()
    learn_walks(state, problem, solved, found, ahead, step)
    if solved.rests:
        slips = find_slips(problem, solved, found, ahead)
        admit(state, slips)
        state.due = state.due or bool(slips)
    calibrate(state, problem, solved.x, border)
    return found


def learn_walks(
    state: FusionState, problem: Problem, solved: Solved, found: Array, ahead: Array, most: float = STEP
) -> None:
    """Move each unit's noise factors along their score.

    Args:
        state: its nodes take the factors.
        problem: of the window.
        solved: its solution.
        found: covariance of each walk at each keyframe, k × walks × 6 × 6.
        ahead: of each with itself at the next keyframe, (k − 1) × walks × 6 × 6.
        most: farthest that the logarithm of a variance moves.
    """
    for i, walk in enumerate(problem.layout.walks):
        motion = solved.motions[i]
        if walk.way is None or not len(motion.noise):
            continue
        now = slice(walk.first, walk.last)
        after = found[walk.first + 1 : walk.last + 1, i]
        outer = motion.residual[:, :, None] * motion.residual[:, None, :]
        outer += unsure(motion, found[now, i], after, ahead[now, i])
        inverse = motion.information
        excess = np.matmul(np.matmul(inverse, outer - motion.noise), inverse)
        lever = motion.transition[:, :2, 3]
        turn = motion.noise[:, 3, 3]
        by_turn = np.zeros_like(motion.noise)
        by_turn[:, 3, 3] = turn
        by_turn[:, :2, :2] = lever[:, :, None] * lever[:, None, :] * (turn / 3.0)[:, None, None]
        by_turn[:, :2, 3] = by_turn[:, 3, :2] = lever * (0.5 * turn)[:, None]
        by_place = np.zeros_like(motion.noise)
        across = np.diagonal(motion.noise - by_turn, axis1=1, axis2=2)
        by_place[:, range(3), range(3)] = across[:, :3]
        node = state.nodes[walk.node.node]
        factors = []
        for factor, part in zip(node.walk_factors, (by_place, by_turn), strict=True):
            score = 0.5 * float((excess * part).sum())
            off = np.log(factor)
            told = np.matmul(inverse, part)
            known = 0.5 * float(np.einsum("kij,kji->", told, told)) * SEEN + abs(score) + 1.0 / SPREAD**2
            step = np.clip(2.0 * (score - off / SPREAD**2) / known, -most, most)
            factors.append(float(np.clip(factor * np.exp(step), LEAST, MOST)))
        state.nodes[node.node] = replace(node, walk_factors=(factors[0], factors[1]))


def calibrate(state: FusionState, problem: Problem, x: Array, border: Array) -> None:
    """Judge anew which technologies are calibrated, as long as their prior is the window's own.

    Only odometry tells a scale (estimation.md, point 3): a velocity that may be anything shrinks or grows
    with it.
    """
    size = problem.layout.length * problem.layout.width
    known = set() if problem.prior is None else set(problem.prior.keys)
    for key, start in problem.layout.technologies.items():
        if key[0] == "range" and key not in known and problem.rows.by_units(key[1]):
            name = state.sources[key[1]]
            narrow = narrow_sigma(state.outliers(name))
            sigma = scale_sigma(state.uncalibrated.get(name, 0.0), narrow)
            told = uncalibrated(sigma, float(x[size + start]), float(border[start, start]), narrow)
            state.uncalibrated[name] = told
            # Another prior bends everything: what follows from it is not left for later.
            state.due = state.due or scale_sigma(told, narrow) != sigma
