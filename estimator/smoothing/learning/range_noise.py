"""Ranges that fit a whole solution far better than the filter thinks: what it has added is not their noise.

Between two solutions the filter holds each reading against a state that its tangents have spread. Where
anchors stand close together and are heard rarely, what arcs are off by weakens every range, the place spreads
along its arc, and what is left of the readings looks like noise of their technology, more and more of it. A
solution is linearised at one estimate: its residuals, and what its unknowns have taken up of them, tell the
variance (REML, Patterson, Thompson 1971; in adjustment: Förstner 1979).
"""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array, Indices
from estimator.smoothing.learning.delay_scores import PROBES, lag_one_correlation, probe
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

MISLED = 0.5
"""Share of the learned sigma below which a solution's is believed. Errors that readings share for seconds its
unknowns take up, so that it may be too small, as the filter's may be too large: where both agree to a factor
of two the filter's stays."""


def learn_ranging(state: FusionState, problem: Problem, solved: Solution) -> bool:
    """Believe a solution's noise of a ranging technology where it is far below what the filter has learned.

    Args:
        state: takes it.
        problem: of a window, or of the whole incident.
        solved: its solution, whose chain has been reduced.

    Returns:
        Whether any has been changed: the solution has weighed its readings by another one.
    """
    rows, m = problem.rows, len(problem.rows.pairs)
    ranges = rows.pairs[:, 1] == RANGE
    if not ranges.any():
        return False
    ranges &= ~rows.through(solved.x)
    changed = False
    for source in np.unique(rows.source[:m][ranges]).tolist():
        name = state.sources[source]
        at, known = np.flatnonzero(ranges & (rows.source[:m] == source)), state.learned(name)
        factor = max(_factor(problem, solved, at, MISLED * known.factor), known.least)
        if factor < MISLED * known.factor:
            state.noise[name] = _told(known, factor)
            changed = True
    return changed


def _told(known: LearnedNoise, factor: float) -> LearnedNoise:
    """What is known of a technology with another factor, as if from as many readings as are remembered."""
    count, shared = physics.NOISE_MEMORY, known.shared
    squares = count * factor**2
    return replace(known, count=count, squares=squares, pairs=count, products=shared * squares)


def _factor(problem: Problem, solved: Solution, at: Indices, least: float) -> float:
    """Standard deviation of some ranges over the assumed one; `least` or more: no need to know it better.

    Args:
        problem: of the solution.
        solved: the solution, whose chain has been reduced.
        at: which rows, m.
        least: from which on it does not matter.
    """
    rows, prior = problem.rows, physics.NOISE_PRIOR
    sigma, good = rows.sigma[at], solved.weighted.good[at]
    # Of what a way between two keyframes or a floor adds the residual is no witness.
    own = np.minimum(rows.told[at] / sigma, 1.0) ** 2
    off = np.sqrt(good) * own * solved.linear.residual[at]
    squares, count = float(((off / rows.nominal[at]) ** 2).sum()) + prior, float((good * own).sum())
    if squares >= (count + prior) * least**2:
        return least
    alike = lag_one_correlation(rows.pairs[at, 9].astype(np.int64), off)
    # So many independent readings are worth as much as these whose errors follow on from each other.
    worth = count * (1.0 - alike) / (1.0 + alike)
    left = max(1.0 - explained_count(problem, solved, at, np.sqrt(good * own) / sigma) / max(worth, 1.0), 0.0)
    return math.sqrt(squares / (count * left + prior))


def explained_count(problem: Problem, solved: Solution, at: Indices, root: Array) -> float:
    """Degrees of freedom that the unknowns take of some readings, Σ w J L⁻¹ Jᵀ (Hutchinson 1990).

    Args:
        problem: of the solution.
        solved: the solution, whose chain has been reduced.
        at: which rows, m.
        root: √w of each, m.
    """
    layout, rows = problem.layout, problem.rows
    size = layout.length * layout.width
    right = np.zeros((size + layout.border, PROBES))
    probe(right, layout.width, size, rows.columns[at], rows.slab[at], solved.linear.jacobian[at], root)
    of_keyframes = right[:size].reshape(layout.length, layout.width, right.shape[1])
    explained = solved.chain.explained(of_keyframes, right[size:])
    return float(np.trace(explained.information)) / PROBES
