"""Noise with outliers: two-component mixtures, as weights for the next least-squares step (IRLS, EM).

A redescending loss lets an outlier lose its pull (estimation.md, point 5: 0.87 m with Huber, 0.30 m with
Cauchy). The mixture is such a loss with a meaning: each component says how often it happens, how wide it
is and where it is centred, so an obstructed range may be too long but hardly too short.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices

MOST = 1e300
"""What a reading costs at most, in log likelihood: of two infinite costs none would be the lower one."""


class Mixture(NamedTuple):
    """Good noise N(0, σ²), or with probability `outliers` bad noise N(shift, spread² + σ²).

    Attributes:
        outliers: how often the bad noise happens, 0 to 1.
        shift: mean of the bad noise, in the reading's unit.
        spread: its standard deviation beyond the good one, in the reading's unit.
    """

    outliers: float
    shift: float
    spread: float


class Weighted(NamedTuple):
    """One least-squares step's view of m readings.

    Attributes:
        information: P⁻¹ of each, m.
        residual: the residual to be used with it, m.
        good: probability that the reading has the good noise, m.
    """

    information: Array
    residual: Array
    good: Array


@njit(cache=True, error_model="numpy")
def weigh(
    residual: Array, sigma: Array, predicted: Array, outliers: Array, shift: Array, spread: Array
) -> Weighted:
    """E-step: the probability of each component, and the Gaussian edge that both together pull with.

    The probabilities come from the residual with the state's own uncertainty added, so that an uncertain
    state does not make outliers of good readings.

    Args:
        residual: z − h(x), m.
        sigma: standard deviation of the good noise, m.
        predicted: variance of h(x) by the state's covariance, m.
        outliers: see `Mixture`, m.
        shift: see `Mixture`, m.
        spread: see `Mixture`, m.
    """
    m = len(residual)
    information, pulled, good = np.empty(m), np.empty(m), np.empty(m)
    for i in range(m):
        good_variance = sigma[i] ** 2
        bad_variance = good_variance + spread[i] ** 2
        good_total, bad_total = good_variance + predicted[i], bad_variance + predicted[i]
        lead = 0.5 * (residual[i] ** 2 / good_total - (residual[i] - shift[i]) ** 2 / bad_total)
        odds = outliers[i] / (1.0 - outliers[i]) * np.sqrt(good_total / bad_total)
        good[i] = 1.0 / (1.0 + odds * np.exp(min(max(lead, -700.0), 700.0)))
        from_good, from_bad = good[i] / good_variance, (1.0 - good[i]) / bad_variance
        information[i] = from_good + from_bad
        pulled[i] = residual[i] - shift[i] * from_bad / information[i]
    return Weighted(information, pulled, good)


@njit(cache=True, error_model="numpy")
def mixture_cost(residual: Array, sigma: Array, outliers: Array, shift: Array, spread: Array) -> Array:
    """Negative log likelihood of each reading up to a constant: what `weigh` descends, m.

    Args:
        residual: z − h(x), m.
        sigma: standard deviation of the good noise, m.
        outliers: see `Mixture`, m.
        shift: see `Mixture`, m.
        spread: see `Mixture`, m.
    """
    cost = np.empty(len(residual))
    for i in range(len(residual)):
        bad_variance = sigma[i] ** 2 + spread[i] ** 2
        usual, rare = (1.0 - outliers[i]) / sigma[i], outliers[i] / np.sqrt(bad_variance)
        by_good = min(0.5 * (residual[i] / sigma[i]) ** 2, MOST)
        by_bad = min(0.5 * (residual[i] - shift[i]) ** 2 / bad_variance, MOST)
        # One exponential and one logarithm take all of the time: the likelier way to be so far off is put
        # before the sum, so that the sum is never nil.
        if by_good < by_bad or rare == 0.0:
            cost[i] = by_good - np.log(usual + rare * np.exp(min(by_good - by_bad, 0.0)))
        else:
            cost[i] = by_bad - np.log(rare + usual * np.exp(by_bad - by_good))
    return cost


@njit(cache=True, error_model="numpy")
def total_cost(
    left_out: Indices, residual: Array, sigma: Array, outliers: Array, shift: Array, spread: Array
) -> float:
    """The sum of `mixture_cost`, but for those readings that are left out."""
    cost = mixture_cost(residual, sigma, outliers, shift, spread)
    for i in left_out:
        cost[i] = 0.0
    return float(cost.sum())


@njit(cache=True)
def prior_cost(x: Array, at: Indices, mean: Array, information: Array) -> float:
    """Negative log likelihood of independent priors of some numbers of an estimate, up to a constant.

    Args:
        x: the estimate.
        at: which numbers, n.
        mean: of each, n.
        information: one over the variance of each, n.
    """
    total = 0.0
    for i in range(len(at)):
        total += information[i] * (x[at[i]] - mean[i]) ** 2
    return 0.5 * total


@njit(cache=True)
def cauchy_cost(residual: Array, scale: float) -> Array:
    """Cauchy loss c²/2 log(1 + (r / c)²) of whitened residuals (m), c = `scale`."""
    cost: Array = 0.5 * scale**2 * np.log1p((residual / scale) ** 2)
    return cost
