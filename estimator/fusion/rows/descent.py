"""Gauss-Newton on the readings of one tick: robust, relinearised until it rests, compiled as one loop."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.rows.arcs import alike, fallen_back, look_aside
from estimator.fusion.rows.nearness import look_around, off_line
from estimator.fusion.rows.rows import KIND, OUTLIERS, SHIFT, SIGMA, SPREAD, WIDTH, columns_of, linearise
from estimator.graph.dense import Array, Indices
from estimator.graph.filter_kernels import scatter
from estimator.graph.robust import mixture_cost, weigh
from estimator.graph.triangular import factorised, forward_all, solved

BENT = 0.2
"""Curvature left alone: residuals that differ from their linear forecast by less, in standard deviations."""
HALVINGS = 4
SETTLED = 0.2
"""Share of its variance by which a reading's noise changes at most where it is said to rest."""
SOLVED, UNSOLVABLE, INDEFINITE = range(3)
RESIDUAL, PREDICTED, GOOD = range(3)
"""Columns of what is told of each reading once it has been solved, see `Found`."""


class Found(NamedTuple):
    """What a tick's readings have led to.

    Attributes:
        outcome: `SOLVED`; `UNSOLVABLE`: they make no solvable system; `INDEFINITE`: L itself is not positive
            definite.
        matrix: L with the readings, linearised where they were solved last, n × n.
        x: the estimate, n.
        residual: z − h(x) of each, m.
        predicted: variance of each prediction by the state's covariance, m.
        good: probability that each has the good noise, m.
        doubted: following them had made the fit clearly worse, so that the estimate has not gone all the way.
    """

    outcome: int
    matrix: Array
    x: Array
    residual: Array
    predicted: Array
    good: Array
    doubted: bool


@njit(cache=True, error_model="numpy", nogil=True)
def descend(table: Array, prior: Array, pull: Array, start: Array, iterations: int) -> Found:
    """Add readings to a Kirchhoff state (operation 1 of paper A, eq. 18) and solve it (eq. 4).

    Args:
        table: of m readings.
        prior: L, n × n.
        pull: b, n, in deviations from `start`.
        start: x, n.
        iterations: how often to relinearise at most.
    """
    m, n = len(table), len(start)
    sigma, outliers = table[:, SIGMA].copy(), table[:, OUTLIERS].copy()
    shift, spread = table[:, SHIFT].copy(), table[:, SPREAD].copy()
    x, matrix = start.copy(), prior.copy()
    columns, jacobian, residual = columns_of(table), np.empty((m, WIDTH)), np.empty(m)
    ahead, forecast = np.empty((m, WIDTH)), np.empty(m)
    factor, unscale, predicted, good = np.zeros((n, n)), np.empty(n), np.empty(m), np.empty(m)
    wider = np.zeros(m)
    if not factorised(prior, factor, unscale):
        return Found(INDEFINITE, matrix, x, residual, predicted, good, False)
    linearise(table, columns, x, jacobian, residual)
    variances(columns, jacobian, factor, unscale, predicted)
    own = sigma**2
    curved = widen(table, columns, jacobian, residual, x, factor, unscale, wider)
    if curved:
        sigma[:] = np.sqrt(own + wider)
    cost, doubted = misfit(table, sigma, residual, x - start, prior, pull), False
    for _ in range(iterations):
        weighted = weigh(residual, sigma, predicted, outliers, shift, spread)
        good[:] = weighted.good
        matrix[:] = prior
        gradient = pull - np.dot(prior, x - start)
        scatter(matrix, gradient, columns, jacobian, weighted.information, weighted.residual)
        if not np.isfinite(gradient).all() or not factorised(matrix, factor, unscale):
            return Found(UNSOLVABLE, matrix, x, residual, predicted, good, doubted)
        step = solved(factor, unscale, gradient)
        before, forecast[:] = x.copy(), residual
        doubted = False
        for _ in range(HALVINGS):
            # The step is halved while it makes the fit clearly worse.
            x = before + step
            linearise(table, columns, x, ahead, residual)
            reached = misfit(table, sigma, residual, x - start, prior, pull)
            if reached <= cost + 1.0:
                break
            step, doubted = 0.5 * step, True
        if reached > cost + 1.0:
            x = before.copy()
            linearise(table, columns, x, ahead, residual)
            break
        cost, rests = reached, True
        for r in range(m):
            for i in range(WIDTH):
                if columns[r, i] >= 0:
                    forecast[r] -= jacobian[r, i] * (x[columns[r, i]] - before[columns[r, i]])
            most = BENT * np.sqrt(sigma[r] ** 2 + predicted[r])
            rests = rests and abs(residual[r] - forecast[r]) < most
        if curved:
            widen(table, columns, ahead, residual, x, factor, unscale, wider)
            rests = rests and bool((np.abs(own + wider - sigma**2) <= SETTLED * sigma**2).all())
            sigma[:] = np.sqrt(own + wider)
            cost = misfit(table, sigma, residual, x - start, prior, pull)
        if rests:
            break
        jacobian[:] = ahead
        variances(columns, jacobian, factor, unscale, predicted)
    if doubted:
        # What the estimate has not gone to after all must not make it sure of where it stays instead.
        predicted[:] = 0.0
        weighted = weigh(residual, sigma, predicted, outliers, shift, spread)
        good[:] = weighted.good
        matrix[:] = prior
        scatter(matrix, np.zeros(n), columns, ahead, weighted.information, weighted.residual)
        if factorised(matrix, factor, unscale):
            variances(columns, ahead, factor, unscale, predicted)
    outcome = SOLVED if np.isfinite(x).all() else UNSOLVABLE
    return Found(outcome, matrix, x, residual, predicted, good, doubted)


@njit(cache=True, error_model="numpy")
def variances(columns: Indices, jacobian: Array, factor: Array, unscale: Array, predicted: Array) -> None:
    """Variance of each prediction by the state's covariance, H Σ Hᵀ, m, from the factor of L."""
    m, n = len(jacobian), len(unscale)
    first = np.full(m, n)
    for r in range(m):
        for i in range(WIDTH):
            if columns[r, i] >= 0 and jacobian[r, i] != 0.0:
                first[r] = min(first[r], columns[r, i])
    order = np.argsort(first)
    halves = np.zeros((n, m))
    for k in range(m):
        r = order[k]
        for i in range(WIDTH):
            column = columns[r, i]
            if column >= 0 and jacobian[r, i] != 0.0:
                halves[column, k] += jacobian[r, i] * unscale[column]
    forward_all(factor, halves, first[order])
    squares = np.zeros(m)
    for i in range(n):
        own = halves[i]
        for k in range(m):
            squares[k] += own[k] * own[k]
    predicted[order] = squares


@njit(cache=True, error_model="numpy")
def widen(
    table: Array,
    columns: Indices,
    jacobian: Array,
    residual: Array,
    x: Array,
    factor: Array,
    unscale: Array,
    wider: Array,
) -> bool:
    """What is added to the noise of readings for the state leaves so much open; see `arcs` and `nearness`.

    Args:
        table: of m readings, those of one kind one after the other.
        columns: which numbers each depends on, m × 8.
        jacobian: its derivatives by them, m × 8.
        residual: z − h(x) of each, m.
        x: the estimate, n.
        factor: of L, as `factorised` leaves it.
        unscale: the same.
        wider: takes the variances, m; nil of other kinds, and of a kind where none is worth minding.

    Returns:
        Whether any is.
    """
    wider[:] = 0.0
    found = False
    for kind in (RANGE, RSSI):
        among = table[:, KIND] == kind
        m = int(among.sum())
        if m == 0:
            continue
        first = int(np.argmax(among))
        own = slice(first, first + m)
        aside, scales, turned = np.empty((m, WIDTH)), np.empty(m), np.empty(m)
        if kind == RANGE:
            look_aside(table[own], columns[own], jacobian[own], residual[own], aside, scales)
            variances(columns[own], aside, factor, unscale, turned)
            each = scales**2 * fallen_back(turned)
        else:
            along, farther = np.empty((m, WIDTH)), np.empty(m)
            look_around(columns[own], jacobian[own], x, aside, along, scales)
            variances(columns[own], aside, factor, unscale, turned)
            variances(columns[own], along, factor, unscale, farther)
            each = scales**2 * off_line(turned, farther)
        minded = (BENT * table[own, SIGMA]) ** 2
        if (m * each > minded).any():
            each *= alike(table[own])
            if (each > minded).any():
                wider[own], found = each, True
    return found


@njit(cache=True, error_model="numpy")
def misfit(table: Array, sigma: Array, residual: Array, moved: Array, prior: Array, pull: Array) -> float:
    """Negative log likelihood of the mixture noise and the prior, up to a constant."""
    total = 0.5 * np.dot(moved, np.dot(prior, moved)) - np.dot(pull, moved)
    noise = table[:, OUTLIERS], table[:, SHIFT], table[:, SPREAD]
    return float(total + mixture_cost(residual, sigma, *noise).sum())
