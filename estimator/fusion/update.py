"""One tick's readings, all at once, into the Kirchhoff state: robust, relinearised until it rests."""

import numpy as np
from msgspec.structs import replace

from estimator.fusion.rows import Rows, Stack
from estimator.fusion.state import FusionState
from estimator.graph.dense import Array, Cholesky, factorise, half_solve, inverse, solve
from estimator.graph.kirchhoff import Kirchhoff, scatter
from estimator.graph.robust import Weighted, weigh

LEVER_M = 20.0
"""A heading's error at the far end of a room's way."""
BENT = 0.2
"""Curvature left alone: residuals that differ from their linear forecast by less, in standard deviations."""
HALVINGS = 4
SAME_PLACE = 0.5


def update(state: FusionState, stack: Stack, iterations: int = 6) -> Weighted | None:
    """Add measurements (operation 1 of paper A, eq. 18) and solve (eq. 4), relinearised where h is curved.

    Args:
        state: the fusion; its graph is solved and rests at the new estimate afterwards.
        stack: the readings.
        iterations: how often to relinearise at most.

    Returns:
        How each reading was weighed; None where they made no solvable system and were left out.
    """
    graph = state.graph
    if len(stack) == 0:
        return None
    cholesky = graph.factorise()
    prior, start, pull = graph.information.copy(), graph.reference.copy(), graph.vector.copy()
    x = start.copy()
    rows = stack.linearise(x)
    predicted = variances(rows, cholesky)
    cost = _cost(stack, rows, x - start, prior, pull)
    for _ in range(iterations):
        weighted = weigh(rows.residual, stack.sigma, predicted, stack.outliers, stack.shift, stack.spread)
        matrix = prior.copy()
        scatter(matrix, rows.columns, rows.jacobian, weighted.information)
        gradient = pull - prior @ (x - start)
        pulls = rows.jacobian * (weighted.information * weighted.residual)[:, None]
        np.add.at(gradient, rows.columns.ravel(), pulls.ravel())
        if not np.isfinite(gradient).all():
            return None
        try:
            cholesky = factorise(matrix)
        except ValueError:
            return None
        before, linear = x, rows
        x, rows, cost = _descend(stack, x, solve(cholesky, gradient), start, prior, pull, cost)
        forecast = linear.residual - np.einsum("mk,mk->m", linear.jacobian, (x - before)[linear.columns])
        if (np.abs(rows.residual - forecast) < BENT * np.sqrt(stack.sigma**2 + predicted)).all():
            break
        predicted = variances(rows, cholesky)
    if not np.isfinite(x).all():
        return None
    state.bent_m += bend_m(graph, x - start)
    graph.settle(matrix, x)
    _learn(state, stack, rows.residual, predicted, weighted)
    return weighted


def bend_m(graph: Kirchhoff, moved: Array) -> float:
    """How far an update has bent what is linearised: the largest turn of a unit, at arm's length (m)."""
    farthest = 0.0
    for variable, row in graph.starts.items():
        if variable.kind == "unit":
            farthest = max(farthest, LEVER_M * abs(float(moved[row])))
    return farthest


def variances(rows: Rows, cholesky: Cholesky) -> Array:
    """Variance of each prediction by the state's covariance, H Σ Hᵀ, m, from the factor of L."""
    m, n = len(rows.residual), len(cholesky.scale)
    if m < n // 2:
        dense = np.zeros((n, m))
        np.add.at(dense, (rows.columns, np.arange(m)[:, None]), rows.jacobian)
        half = half_solve(cholesky, dense)
        return np.asarray(np.einsum("nm,nm->m", half, half))
    blocks = inverse(cholesky)[rows.columns[:, :, None], rows.columns[:, None, :]]
    return np.asarray(np.maximum(np.einsum("mi,mij,mj->m", rows.jacobian, blocks, rows.jacobian), 0.0))


def _descend(
    stack: Stack, x: Array, step: Array, start: Array, prior: Array, pull: Array, cost: float
) -> tuple[Array, Rows, float]:
    """The step, halved while it makes the fit clearly worse."""
    for _ in range(HALVINGS):
        there = x + step
        rows = stack.linearise(there)
        reached = _cost(stack, rows, there - start, prior, pull)
        if reached <= cost + 1.0:
            break
        step = 0.5 * step
    return there, rows, reached


def _cost(stack: Stack, rows: Rows, moved: Array, prior: Array, pull: Array) -> float:
    """Negative log likelihood of the mixture noise and the prior, up to a constant."""
    residual, good = rows.residual, stack.sigma**2
    bad = good + stack.spread**2
    from_good = np.log1p(-stack.outliers) - 0.5 * (np.log(good) + residual**2 / good)
    from_bad = np.log(stack.outliers) - 0.5 * (np.log(bad) + (residual - stack.shift) ** 2 / bad)
    return float(0.5 * moved @ (prior @ moved) - pull @ moved - np.logaddexp(from_good, from_bad).sum())


def _learn(state: FusionState, stack: Stack, residual: Array, predicted: Array, weighted: Weighted) -> None:
    """M-step for the noise of each technology: what good readings are off, and how unsure that is itself."""
    sums: dict[str, list[float]] = {}
    variance = stack.sigma**2
    unsure = (predicted * variance / (predicted + variance)).tolist()
    good, off = weighted.good.tolist(), residual.tolist()
    for i, source in enumerate(stack.sources):
        if not source:
            continue
        known = sums.setdefault(source, [0.0, 0.0, 0.0, 0.0, 0.0])
        known[4] += 1.0
        assumed = stack.nominal[i] ** 2
        known[0] += good[i]
        known[1] += good[i] * (off[i] ** 2 + unsure[i]) / assumed
        link = state.links.get(stack.links[i])
        if link is None:
            continue
        error = off[i] / stack.nominal[i]
        if link.error is not None and link.kept > SAME_PLACE:
            known[2] += good[i]
            known[3] += good[i] * (error * link.error - unsure[i] / assumed)
        state.links[stack.links[i]] = replace(link, error=error if good[i] > SAME_PLACE else None)
    for source, (count, squares, pairs, products, seen) in sums.items():
        state.noise[source] = state.learned(source).with_errors(count, squares, pairs, products, seen)
    state.count("outlier", int((weighted.good < 0.5).sum()))
