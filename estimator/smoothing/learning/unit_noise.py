"""What a solved window tells of units and technologies: how noisy, how well calibrated.

The score of the marginal likelihood by a noise parameter is what the smoothed steps say of it (Fisher's
identity): ½ Σ [E(w wᵀ) − Q] : Q⁻¹ Q_i Q⁻¹, with E(w wᵀ) = ŵ ŵᵀ + V. A few damped steps along it, one with
each solution of the window, find the variance under which unit and radio agree best, and not a smaller one:
what the radio does not see of a step stays in V.
"""

import math
from collections.abc import Callable

import numpy as np
from msgspec.structs import replace
from numba import njit
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.learned.calibration import Calibration, body_sigmas, told_of, uncalibrated
from estimator.fusion.memory.prior import Key
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.variable import BODY
from estimator.smoothing.keyframes.walks import BIAS, STATES, Motion
from estimator.smoothing.learning.alike_units import pulled
from estimator.smoothing.learning.delays import doubt_delays
from estimator.smoothing.learning.range_noise import learn_ranging
from estimator.smoothing.learning.slips import widen_steps
from estimator.smoothing.learning.trusted_radios import trust_regained
from estimator.smoothing.learning.wrong_steps import Doubts, doubts_of, find_slips
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

STEP, DOUBTED = 0.3, 3.0
"""Farthest that the logarithm of a variance moves in one solution; and so many times as far towards more
noise: while a unit far worse than assumed is trusted, its bearer is led astray."""
SEEN = 0.03
"""Share of a step's own noise that readings usually tell apart: what a score is held against."""
LEAST, MOST = 0.03, 400.0
"""The worst unit is off by 0.7 m in each metre: it tells nothing any more."""
ROUNDING_S = 1e-6
PARTS = 4
"""Numbers of a state that its noise is learned of: place and heading."""
FARTHEST = 3.0
"""So many of its standard deviations bodies do at most."""


def learn(
    state: FusionState,
    problem: Problem,
    solved: Solution,
    build: Callable[[FusionState], Problem],
    step: float = STEP,
    kinds: bool = True,
    other: float = -math.inf,
) -> Array:
    """Learn from a solved window how noisy each unit is, and which technologies are calibrated.

    Args:
        state: takes what is learned.
        problem: of the window.
        solved: its solution, whose chain is eliminated here.
        build: builds the same problem of a fusion.
        step: farthest that the logarithm of a variance moves at once.
        kinds: technologies are judged as well.
        other: see `delays.doubt_delays`.

    Returns:
        Covariance of each walk at each keyframe, k × walks × 6 × 6.
    """
    solved.chain.reduce()
    found, ahead, border = solved.chain.covariances()
    doubts = doubts_of(problem, solved, found, ahead)
    learn_walks(state, problem, solved, doubts, step)
    if solved.rests:
        slips = find_slips(problem, solved, doubts, build)
        widen_steps(state, slips)
        state.due = state.due or bool(slips)
    if kinds:
        calibrate(state, problem, solved.x, border)
        if solved.rests:
            doubt_delays(state, problem, solved, other)
            trust_regained(state, problem, solved.x, border)
            state.due = learn_ranging(state, problem, solved) or state.due
    learn_biases(state, problem, solved.x, found)
    return found


def learn_walks(state: FusionState, problem: Problem, solved: Solution, doubts: Doubts, most: float) -> None:
    """Move each unit's noise factors along their score.

    Args:
        state: its nodes take the factors.
        problem: of the window.
        solved: its solution.
        doubts: see `wrong_steps.doubts_of`.
        most: see `STEP`.
    """
    scores = dict[int, Array]()
    for i, doubt in doubts.items():
        reported = _reported(problem, i)
        if reported.any():
            scores[i] = noise_scores(solved.motions[i], doubt, reported)
    nodes = [state.life(problem.layout.walks[i].number) for i in scores]
    if not nodes:
        return
    off, told = np.log([node.walk_factors for node in nodes]), np.array(list(scores.values()))
    score, sure = told[:, :, 0], told[:, :, 1] * SEEN + np.abs(told[:, :, 0])
    steps = np.empty_like(off)
    raw = np.array([node.raw for node in nodes])
    for i in range(len(nodes)):
        # How far a bearer goes is his own: he may crawl, or be carried.
        steps[i, :1] = pulled(off[i, :1], score[i, :1], sure[i, :1])
    for alike in (raw, ~raw):
        if alike.any():
            steps[alike, 1] = pulled(off[alike, 1], score[alike, 1], sure[alike, 1])
    led = np.exp(off + np.clip(2.0 * steps, -most, DOUBTED * most))
    for node, (by_place, by_turn) in zip(nodes, np.clip(led, LEAST, MOST).tolist(), strict=True):
        state.keep(replace(node, walk_factors=(by_place, by_turn)))


def _reported(problem: Problem, index: int) -> NDArray[np.bool_]:
    """Between which keyframes a unit has told all of its way, k: how else he goes is not its noise."""
    walk = problem.layout.walks[index]
    if walk.way is None:
        return np.zeros(walk.last - walk.first, dtype=np.bool_)
    unseen_s = np.diff(walk.way.unseen_s(problem.layout.times[walk.first : walk.last + 1, index]))
    return np.asarray(unseen_s < ROUNDING_S)


@njit(cache=True)
def noise_scores(motion: Motion, unsure_of: Array, reported: NDArray[np.bool_]) -> Array:
    """Score by the logarithm of a variance, ½ Σ [w wᵀ + V − Q] : Q⁻¹ Q_i Q⁻¹, and ½ Σ (Q⁻¹ Q_i) : (Q_i Q⁻¹).

    Args:
        motion: of a walk.
        unsure_of: V of its steps, k × 6 × 6.
        reported: which of them its unit has told all of, k; others say nothing of it.

    Returns:
        A row for the variances of places and one for those of headings, 2 × 2.
    """
    found = np.zeros((2, 2))
    size = motion.residual.shape[1]
    # Of each noise, and of what follows from it, only the first four rows and columns are ever needed.
    part, excess, told = np.zeros((2, PARTS, PARTS)), np.empty((PARTS, PARTS)), np.empty((PARTS, PARTS))
    half = np.empty((PARTS, size))
    for i in range(len(motion.residual)):
        if not reported[i]:
            continue
        known, noise, off, doubt = motion.information[i], motion.noise[i], motion.residual[i], unsure_of[i]
        turn = noise[3, 3]
        east, north = 2.0 * noise[0, 3] / turn, 2.0 * noise[1, 3] / turn
        by_place, by_turn = part[0], part[1]
        by_turn[0, 0], by_turn[1, 1] = east * east * turn / 3.0, north * north * turn / 3.0
        by_turn[0, 1] = by_turn[1, 0] = east * north * turn / 3.0
        by_turn[0, 3] = by_turn[3, 0] = 0.5 * east * turn
        by_turn[1, 3] = by_turn[3, 1] = 0.5 * north * turn
        by_turn[3, 3] = turn
        for c in range(2):
            by_place[c, c] = noise[c, c] - by_turn[c, c]
        for r in range(PARTS):
            half[r] = 0.0
            for j in range(size):
                for c in range(size):
                    half[r, c] += known[r, j] * (off[j] * off[c] + doubt[j, c] - noise[j, c])
            for c in range(PARTS):
                excess[r, c] = 0.0
                for j in range(size):
                    excess[r, c] += half[r, j] * known[j, c]
        for which in range(2):
            for r in range(PARTS):
                for c in range(PARTS):
                    found[which, 0] += 0.5 * excess[r, c] * part[which, r, c]
                    told[r, c] = 0.0
                    for j in range(PARTS):
                        told[r, c] += known[r, j] * part[which, j, c]
            for r in range(PARTS):
                for c in range(PARTS):
                    found[which, 1] += 0.5 * told[r, c] * told[c, r]
    return found


def calibrate(state: FusionState, problem: Problem, x: Array, border: Array) -> None:
    """Judge anew which technologies are calibrated, as long as their prior is the window's own.

    Only odometry tells a scale (decision 0021): a velocity that may be anything shrinks or grows with it.
    """
    size = problem.layout.length * problem.layout.width
    known = set() if problem.prior is None else set(problem.prior.keys)
    for key, start in problem.layout.technologies.items():
        if key[0] == "range" and key not in known and problem.rows.by_units(key[1]):
            name = state.sources[key[1]]
            narrow = state.narrow_sigma(name)
            sigma = state.range_scale_sigma(name)
            told = uncalibrated(sigma, float(x[size + start]), float(border[start, start]), narrow)
            thought = state.calibrations.get(name, Calibration()).judged(told, narrow, sigma)
            state.calibrations[name] = thought
            # Another prior bends everything: what follows from it is not left for later.
            state.due = state.due or thought.scale_sigma(narrow) != sigma
        if key[0] in ("range", "rssi") and key not in known and problem.rows.by_units(key[1]):
            judge_bodies(state, key, float(x[size + start + BODY]), float(border[start + BODY, start + BODY]))


def judge_bodies(state: FusionState, key: Key, estimate: float, variance: float) -> None:
    """Judge anew whether bearers' bodies are seen in the readings of a technology.

    Args:
        state: takes what is thought of it.
        key: the technology.
        estimate: of what they do (m or dB).
        variance: of the estimate, the prior included.
    """
    name, powers = state.sources[key[1]], key[0] == "rssi"
    sigma = state.body_sigma(name, powers)
    narrow, wide = body_sigmas(name, powers)
    told = uncalibrated(sigma, estimate, variance, narrow, wide, physics.BODIES)
    information, product = told_of(sigma, estimate, variance)
    if product**2 > (FARTHEST * information) ** 2 * wide**2 + FARTHEST**2 * information:
        # Clearly more than any body does: it is a clock, or something else that looks like one.
        told = 0.0
    state.bodies[name] = Calibration(told, narrow, sigma, wide)
    state.due = state.due or state.body_sigma(name, powers) != sigma


def learn_biases(state: FusionState, problem: Problem, x: Array, found: Array) -> None:
    """Note what the window says of each gyro's bias, as long as its prior is the window's own.

    Of one that navigates raw samples a rest has told already what a crew's others would tell.

    Args:
        state: its nodes take it.
        problem: of the window.
        x: its solution, flat.
        found: covariance of each walk at each keyframe, k × walks × 6 × 6.
    """
    layout = problem.layout
    known = set() if problem.prior is None else set(problem.prior.keys)
    told = {}
    for i, walk in enumerate(layout.walks):
        if walk.way is None or ("walk", walk.number) in known:
            continue
        if walk.node.raw:
            continue
        at = walk.first * layout.width + STATES * i + BIAS
        variance = float(found[walk.first, i, BIAS, BIAS])
        told[walk.number] = told_of(state.bias_sigma_radps(walk.node), float(x[at]), variance)
    for number, one in told.items():
        state.keep(replace(state.life(number), bias_told=one))
