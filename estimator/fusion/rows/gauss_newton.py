"""Gauss-Newton on the readings of one tick: robust, relinearised until it rests, compiled as one loop."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.rows.joint_covariance import joint, variances
from estimator.fusion.rows.power_curvature import logarithm_error, sight_offsets
from estimator.fusion.rows.prediction import Prediction
from estimator.fusion.rows.range_curvature import arc_share, ranges_alike, sight_turns
from estimator.fusion.rows.rows import KIND, OUTLIERS, SHIFT, SIGMA, SPREAD, WIDTH, linearise
from estimator.graph.dense import Array, Indices
from estimator.graph.filter_kernels import scatter
from estimator.graph.robust import mixture_cost, weigh
from estimator.graph.triangular import factorised, solved

BENT = 0.2
"""Curvature left alone: residuals that differ from their linear forecast by less, in standard deviations."""
HALVINGS = 4
SETTLED = 0.2
"""Share of its variance by which a reading's noise changes at most where it is said to rest."""
SOLVED, UNSOLVABLE, INDEFINITE = range(3)
RESIDUAL, PREDICTED, GOOD = range(3)
"""Columns of what is told of each reading once it has been solved, see `Minimum`."""


class Minimum(NamedTuple):
    """What a tick's readings have led to.

    Attributes:
        outcome: `SOLVED`; `UNSOLVABLE`: they make no solvable system; `INDEFINITE`: L itself is not positive
            definite.
        x: the estimate of the numbers that they depend on, k.
        before: where they were linearised last, k.
        jacobian: derivatives by which they were solved last, m × 9.
        information: what each has told by these, m.
        residual: z − h(x) of each, m.
        predicted: variance of each prediction by the state's covariance, m.
        good: probability that each has the good noise, m.
        doubted: following them had made the fit clearly worse, so that the estimate has not gone all the way.
    """

    outcome: int
    x: Array
    before: Array
    jacobian: Array
    information: Array
    residual: Array
    predicted: Array
    good: Array
    doubted: bool


@njit(cache=True, error_model="numpy", nogil=True)
def minimise(table: Array, seen: Prediction, iterations: int) -> Minimum:
    """Add readings to a Kirchhoff state (operation 1 of paper A, eq. 18) and solve it (eq. 4).

    Args:
        table: of m readings.
        seen: what is known of them before.
        iterations: how often to relinearise at most.
    """
    m, k, prior, pull, start = len(table), len(seen.x), seen.prior, seen.pull, seen.x
    sigma, outliers = table[:, SIGMA].copy(), table[:, OUTLIERS].copy()
    shift, spread = table[:, SHIFT].copy(), table[:, SPREAD].copy()
    x, before, matrix, held = start.copy(), start.copy(), np.empty((k, k)), np.zeros(k)
    moved = np.zeros(k)
    columns, jacobian, residual = seen.numbers.at, seen.jacobian.copy(), seen.residual.copy()
    ahead, forecast, own = np.empty((m, WIDTH)), np.empty(m), seen.own.copy()
    factor, unscale, predicted, good = np.empty((k, k)), np.empty(k), seen.predicted.copy(), np.empty(m)
    wider, information = np.zeros(m), np.zeros(m)
    if not seen.solvable:
        return Minimum(INDEFINITE, x, start, jacobian, information, residual, predicted, good, False)
    curved = widen(table, columns, jacobian, residual, x, own, wider)
    if curved:
        widened(table, wider, sigma)
    cost, doubted = misfit(table, sigma, residual, moved, held, pull), False
    for iteration in range(iterations):
        if iteration > 0:
            jacobian[:] = ahead
        weighted = weigh(residual, sigma, predicted, outliers, shift, spread)
        good[:], information[:] = weighted.good, weighted.information
        matrix[:] = prior
        gradient = pull - held
        scatter(matrix, gradient, columns, jacobian, information, weighted.residual)
        if not all_finite(gradient) or not factorised(matrix, factor, unscale):
            return Minimum(UNSOLVABLE, x, before, jacobian, information, residual, predicted, good, doubted)
        step = solved(factor, unscale, gradient)
        before, forecast[:] = x.copy(), residual
        doubted = False
        for _ in range(HALVINGS):
            # The step is halved while it makes the fit clearly worse.
            x = before + step
            linearise(table, columns, x, ahead, residual)
            moved = x - start
            held = np.dot(prior, moved)
            reached = misfit(table, sigma, residual, moved, held, pull)
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
        if curved or not rests:
            joint(factor, unscale, seen.numbers, own)
        if curved:
            widen(table, columns, ahead, residual, x, own, wider)
            rests = widened(table, wider, sigma) and rests
            cost = misfit(table, sigma, residual, moved, held, pull)
        if rests:
            break
        variances(own, ahead, predicted)
    if doubted:
        # What the estimate has not gone to after all must not make it sure of where it stays instead.
        predicted[:] = 0.0
        weighted = weigh(residual, sigma, predicted, outliers, shift, spread)
        good[:], information[:], jacobian[:] = weighted.good, weighted.information, ahead
        before = x.copy()
        matrix[:] = prior
        scatter(matrix, np.zeros(k), columns, jacobian, information, weighted.residual)
        if factorised(matrix, factor, unscale):
            joint(factor, unscale, seen.numbers, own)
            variances(own, jacobian, predicted)
    outcome = SOLVED if all_finite(x) else UNSOLVABLE
    return Minimum(outcome, x, before, jacobian, information, residual, predicted, good, doubted)


@njit(cache=True, error_model="numpy")
def all_finite(numbers: Array) -> bool:
    """Whether none of some numbers is infinite, or none at all."""
    found = True
    for i in range(len(numbers)):
        found = found and bool(np.isfinite(numbers[i]))
    return found


@njit(cache=True, error_model="numpy")
def widened(table: Array, wider: Array, sigma: Array) -> bool:
    """Standard deviations of readings with what `widen` adds.

    Args:
        table: of m readings.
        wider: the variances that are added, m.
        sigma: takes the standard deviations, m.

    Returns:
        Whether they rest: none has changed by much.
    """
    rests = True
    for r in range(len(table)):
        variance = table[r, SIGMA] ** 2 + wider[r]
        rests = rests and abs(variance - sigma[r] ** 2) <= SETTLED * sigma[r] ** 2
        sigma[r] = np.sqrt(variance)
    return rests


@njit(cache=True, error_model="numpy")
def widen(
    table: Array,
    columns: Indices,
    jacobian: Array,
    residual: Array,
    x: Array,
    covariance: Array,
    wider: Array,
) -> bool:
    """Variances added to readings whose h is curved over the state's uncertainty.

    See `range_curvature` and `power_curvature`.

    Args:
        table: of m readings, those of one kind one after the other.
        columns: which numbers each depends on, m × 9.
        jacobian: its derivatives by them, m × 9.
        residual: z − h(x) of each, m.
        x: the estimate, n.
        covariance: of these, m × 9 × 9, see `joint`.
        wider: takes the variances, m; 0 for other kinds, and for a kind where all are negligible.

    Returns:
        Whether any is.
    """
    first, found = 0, False
    wider[:] = 0.0
    while first < len(table):
        kind, last = table[first, KIND], first + 1
        while last < len(table) and table[last, KIND] == kind:
            last += 1
        if kind in (RANGE, RSSI):
            own, each = slice(first, last), wider[first:last]
            if kind == RANGE:
                bent_ranges(table[own], columns[own], jacobian[own], residual[own], covariance[own], each)
            else:
                bent_powers(columns[own], jacobian[own], x, covariance[own], each)
            if minded(table[own], each, float(last - first)):
                each *= ranges_alike(table[own])
            if minded(table[own], each, 1.0):
                found = True
            else:
                each[:] = 0.0
        first = last
    return found


@njit(cache=True, error_model="numpy")
def minded(table: Array, wider: Array, times: float) -> bool:
    """Whether any variance that is added to readings would show, were it so many times as large."""
    found = False
    for r in range(len(table)):
        found = found or times * wider[r] > (BENT * table[r, SIGMA]) ** 2
    return found


@njit(cache=True, error_model="numpy")
def bent_ranges(
    table: Array, columns: Indices, jacobian: Array, residual: Array, covariance: Array, wider: Array
) -> None:
    """What each of m ranges alone is widened by, see `widen`."""
    m = len(table)
    aside, levers_m, turned = np.empty((m, WIDTH)), np.empty(m), np.empty(m)
    sight_turns(table, columns, jacobian, residual, aside, levers_m)
    variances(covariance, aside, turned)
    for r in range(m):
        wider[r] = levers_m[r] ** 2 * arc_share(turned[r])


@njit(cache=True, error_model="numpy")
def bent_powers(columns: Indices, jacobian: Array, x: Array, covariance: Array, wider: Array) -> None:
    """The same of m powers."""
    m = len(columns)
    aside, along, slopes_db = np.empty((m, WIDTH)), np.empty((m, WIDTH)), np.empty(m)
    turned, farther = np.empty(m), np.empty(m)
    sight_offsets(columns, jacobian, x, aside, along, slopes_db)
    variances(covariance, aside, turned)
    variances(covariance, along, farther)
    for r in range(m):
        wider[r] = slopes_db[r] ** 2 * logarithm_error(turned[r], farther[r])


@njit(cache=True, error_model="numpy")
def misfit(table: Array, sigma: Array, residual: Array, moved: Array, held: Array, pull: Array) -> float:
    """Negative log likelihood of the mixture noise and the prior, up to a constant.

    Args:
        table: of m readings.
        sigma: standard deviations of their good noise, m.
        residual: z − h(x), m.
        moved: how far x is from where the prior is linearised, n.
        held: L of the prior times that, n.
        pull: its b, n.
    """
    total = 0.5 * np.dot(moved, held) - np.dot(pull, moved)
    noise = table[:, OUTLIERS], table[:, SHIFT], table[:, SPREAD]
    return float(total + mixture_cost(residual, sigma, *noise).sum())
