"""All places from which a set of ranges or powers may come: a robust solve from many starts."""

import math
from typing import Literal, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.graph.dense import Array
from estimator.graph.robust import cauchy_cost, mixture_cost
from estimator.graph.triangular import factorised, solved
from estimator.measurements.range import predict_range, range_at
from estimator.measurements.rssi import predict_rssi, rssi_at

ANGLES = 12
AROUND: Array = np.column_stack([f(np.arange(ANGLES) * (2.0 * np.pi / ANGLES)) for f in (np.cos, np.sin)])
STEPS = 25
CAUCHY = 2.0
APART_M = 2.0
RESTING = 1e-4
"""Gain in log likelihood below which a place has been found."""
TOO_SHORT = 3.0
"""Log odds against an odd range being too short: walls and echoes make ranges longer, 19 in 20 of them."""
USED_MAX = 120
LEAST_INFORMATION = 1e-8
"""On a place that no reading tells of: 10 km."""


@njit(cache=True, error_model="numpy")
def costs_of(residual: Array, sigma: Array, noise: Array, ranged: NDArray[np.bool_], alike: Array) -> Array:
    """How much readings are worse than perfect ones, each in log likelihood.

    A wall makes all ranges too long that are measured through it. k of them that may share it are neither k
    witnesses nor one: they count as 2 √k.
    """
    outliers, shift, spread = noise[:, 0], noise[:, 1], noise[:, 2]
    best = mixture_cost(np.zeros(len(sigma)), sigma, outliers, shift, spread)
    cost = mixture_cost(residual, sigma, outliers, shift, spread)
    most = cauchy_cost(residual / sigma, CAUCHY)
    for i in range(len(cost)):
        cost[i] = min(cost[i] - best[i], most[i])
        if ranged[i] and residual[i] > 0.0:
            cost[i] /= np.sqrt(alike[i])
    return cost


@njit(cache=True, error_model="numpy")
def short_costs(residual: Array, sigma: Array) -> Array:
    """What ranges that are too short cost more than those as much too long, in log likelihood, m.

    Args:
        residual: measured less predicted, m (m).
        sigma: standard deviations, m (m).
    """
    odd = (np.minimum(residual, 0.0) / sigma / CAUCHY) ** 2
    return TOO_SHORT * odd / (1.0 + odd)


class UndecidedNode(NamedTuple):
    """What is known of an undecided node.

    Attributes:
        kind: what was measured.
        points: where from, m × 3 (m).
        value: ranges (m) or powers (dBm), m.
        sigma: standard deviations, m.
        up_m: mean of the prior of its height (m).
        up_sigma_m: standard deviation of that prior (m).
        extra: states of the technology, 2.
        extra_covariance: of `extra`, 2 × 2.
    """

    kind: Literal["range", "rssi"]
    points: Array
    value: Array
    sigma: Array
    up_m: float
    up_sigma_m: float
    extra: Array
    extra_covariance: Array


class Mode(NamedTuple):
    """A place that fits.

    Attributes:
        position_m: east, north, up, 3 (m).
        cost: negative log likelihood, up to a constant.
        sigma_m: standard deviation along the worst horizontal direction (m).
        across_m: the same along the best one (m).
        up_sigma_m: standard deviation of the height (m).
        extra: states of the technology there, 2.
        before: what of the cost is not of the readings: how likely the place is without them.
    """

    position_m: Array
    cost: float
    sigma_m: float
    across_m: float
    up_sigma_m: float
    extra: Array
    before: float = 0.0


def residuals_of(sought: UndecidedNode, place_m: Array, extra: Array) -> Array:
    """What was measured less what is predicted if the node is at a place, m.

    Args:
        sought: what was measured.
        place_m: the place, 3 (m).
        extra: states of the technology, 2.
    """
    m = len(sought.value)
    there, states = np.tile(place_m, (m, 1)), (np.full(m, one) for one in extra)
    if sought.kind == "range":
        return sought.value - predict_range(sought.points, there, *states).predicted
    return sought.value - predict_rssi(sought.value, sought.points, there, *states).predicted


def find_modes(sought: UndecidedNode, unsure_m: float = math.inf) -> list[Mode]:
    """Places that fit, best first, each apart from the better ones (`APART_M`, or three sigma).

    Levenberg-Marquardt with the Cauchy loss from rings around the first, middle and last place. The states of
    the technology are solved along, so that an unknown scale does not spoil the fit.

    Args:
        sought: what was measured.
        unsure_m: where the best place has a larger standard deviation, it is the only one that is told (m).
    """
    sought = _thinned(sought)
    prior, mean = _prior_of(sought)
    ranged = sought.kind == "range"
    told = np.ascontiguousarray(sought.points), np.ascontiguousarray(sought.value), sought.sigma
    state, normal, cost = _descend(ranged, *told, _starts(sought), prior, mean)
    modes: list[Mode] = []
    left = np.argsort(cost, kind="stable")
    while len(left):
        i = left[0]
        modes.append(_mode(state[i], normal[i], float(cost[i])))
        spread = modes[-1].sigma_m
        if len(modes) == 1 and spread > unsure_m:
            break
        # Most starts lead to the same few places.
        off = state[left, :2] - state[i, :2]
        apart = np.hypot(off[:, 0], off[:, 1]) > max(APART_M, 3.0 * spread)
        left = left[1:][apart[1:]]
    return modes


def mode_at(sought: UndecidedNode, place_m: Array, sigma_m: float) -> Mode:
    """What fits best about a place that is likely without any reading.

    Args:
        sought: what was measured.
        place_m: the place: east, north (m).
        sigma_m: how far from it, along each axis (m).
    """
    sought = _thinned(sought)
    prior, mean = _prior_of(sought)
    prior[0, 0] = prior[1, 1] = sigma_m**-2
    mean[:2] = place_m
    told = np.ascontiguousarray(sought.points), np.ascontiguousarray(sought.value), sought.sigma
    starts = np.tile(mean, (ANGLES, 1))
    # At the place itself there may be a radio, from which all ways are alike.
    starts[:, :2] += sigma_m * AROUND
    state, normal, cost = _descend(sought.kind == "range", *told, starts, prior, mean)
    best = int(np.argmin(cost))
    off_m = state[best, :2] - place_m
    found = _mode(state[best], normal[best], float(cost[best]))
    return found._replace(before=0.5 * float(off_m @ off_m) / sigma_m**2)


def _mode(state: Array, normal: Array, cost: float) -> Mode:
    """A place from a state, 5, and the normal matrix there, 5 × 5."""
    covariance = np.linalg.inv(normal)[:3, :3]
    across_m, spread_m = np.sqrt(np.linalg.eigvalsh(covariance[:2, :2])).tolist()
    return Mode(
        state[:3].copy(), cost, spread_m, across_m, float(np.sqrt(covariance[2, 2])), state[3:].copy()
    )


def _prior_of(sought: UndecidedNode) -> tuple[Array, Array]:
    """What is known beforehand of height and technology: its information, 5 × 5, and its mean, 5."""
    prior = np.zeros((5, 5))
    prior[2, 2] = sought.up_sigma_m**-2
    prior[3:, 3:] = np.linalg.inv(sought.extra_covariance)
    return prior, np.array([0.0, 0.0, sought.up_m, *sought.extra])


def _thinned(sought: UndecidedNode) -> UndecidedNode:
    m = len(sought.value)
    if m <= USED_MAX:
        return sought
    kept = np.linspace(0, m - 1, USED_MAX).astype(np.intp)
    return sought._replace(points=sought.points[kept], value=sought.value[kept], sigma=sought.sigma[kept])


def _starts(sought: UndecidedNode) -> Array:
    m = len(sought.value)
    if sought.kind == "range":
        distance = sought.value
    else:
        decades = (sought.extra[0] - sought.value) / (10.0 * max(sought.extra[1], 1.0))
        distance = 10.0 ** np.clip(decades, -1.0, 2.5)
    centres = sorted({0, m // 2, m - 1, int(np.argmin(distance))})
    rings = [sought.points[i, :2] + AROUND * max(distance[i], 0.5) for i in centres]
    horizontal = np.concatenate(rings)
    rest = np.broadcast_to([sought.up_m, *sought.extra], (len(horizontal), 3))
    return np.column_stack([horizontal, rest])


@njit(cache=True, error_model="numpy")
def _descend(
    ranged: bool, points: Array, value: Array, sigma: Array, starts: Array, prior: Array, mean: Array
) -> tuple[Array, Array, Array]:
    """States s × 5, normal matrices s × 5 × 5 and costs s that Levenberg-Marquardt comes to from each start.

    Args:
        ranged: the values are ranges, not powers.
        points: see `UndecidedNode`, m × 3 (m).
        value: see `UndecidedNode`, m.
        sigma: see `UndecidedNode`, m.
        starts: position and states of the technology, s × 5.
        prior: information on them, 5 × 5.
        mean: of that prior, 5.
    """
    found = starts.copy()
    normals, costs = np.empty((len(starts), 5, 5)), np.empty(len(starts))
    damped, factor, unscale = np.empty((5, 5)), np.zeros((5, 5)), np.empty(5)
    for i in range(len(starts)):
        state, damping = starts[i].copy(), 1e-3
        normal, gradient, cost = _linearise(ranged, points, value, sigma, state, prior, mean)
        for _ in range(STEPS):
            damped[:] = normal
            for r in range(5):
                damped[r, r] *= 1.0 + damping
            if not factorised(damped, factor, unscale):
                damping = min(damping * 8.0, 1e9)
                continue
            there = state + solved(factor, unscale, gradient)
            normal_there, gradient_there, cost_there = _linearise(
                ranged, points, value, sigma, there, prior, mean
            )
            if cost_there < cost:
                gained = cost - cost_there
                state, normal, gradient, cost = there, normal_there, gradient_there, cost_there
                damping = max(damping * 0.3, 1e-9)
                if gained < RESTING:
                    break
            else:
                damping = min(damping * 8.0, 1e9)
        found[i], normals[i], costs[i] = state, normal, cost
        if ranged:
            costs[i] += short_costs(_residuals(points, value, state), sigma).sum()
    return found, normals, costs


@njit(cache=True, error_model="numpy")
def _residuals(points: Array, value: Array, state: Array) -> Array:
    """Of ranges at a state, 5: measured less predicted, m (m)."""
    found = np.empty(len(value))
    for i in range(len(value)):
        e, n, u = points[i, 0] - state[0], points[i, 1] - state[1], points[i, 2] - state[2]
        found[i] = value[i] - range_at(e * e + n * n + u * u, state[3], state[4]).predicted
    return found


@njit(cache=True, error_model="numpy")
def _linearise(
    ranged: bool, points: Array, value: Array, sigma: Array, state: Array, prior: Array, mean: Array
) -> tuple[Array, Array, float]:
    """Normal matrix 5 × 5, gradient 5 and cost at a state, 5."""
    off = mean - state
    gradient = prior @ off
    cost = 0.5 * np.dot(off, gradient)
    normal, row = prior.copy(), np.empty(5)
    normal[0, 0] += LEAST_INFORMATION
    normal[1, 1] += LEAST_INFORMATION
    for i in range(len(value)):
        e, n, u = points[i, 0] - state[0], points[i, 1] - state[1], points[i, 2] - state[2]
        squared = e * e + n * n + u * u
        if ranged:
            got = range_at(squared, state[3], state[4])
        else:
            got = rssi_at(value[i], squared, state[3], state[4])
        residual = (value[i] - got.predicted) / sigma[i]
        loss = 1.0 + (residual / CAUCHY) ** 2
        cost += 0.5 * CAUCHY**2 * np.log(loss)
        row[0], row[1], row[2] = -e * got.by_a / sigma[i], -n * got.by_a / sigma[i], -u * got.by_a / sigma[i]
        row[3], row[4] = got.by_first / sigma[i], got.by_second / sigma[i]
        for r in range(5):
            pulled = row[r] / loss
            gradient[r] += pulled * residual
            for c in range(r, 5):
                normal[r, c] += pulled * row[c]
    for r in range(5):
        for c in range(r):
            normal[r, c] = normal[c, r]
    return normal, gradient, cost
