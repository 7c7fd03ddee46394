"""Noise with outliers: two-component mixtures, as weights for the next least-squares step (IRLS, EM).

A redescending loss lets an outlier lose its pull, which a convex one such as Huber's does not. The mixture is
such a loss with a meaning: each component says how often it happens, how wide it is and where it is centred,
so an obstructed range may be too long but hardly too short.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array, Indices

MOST = 1e300
"""What a reading costs at most, in log likelihood: of two infinite costs none would be the lower one."""
NEGLIGIBLE = 700.0
"""Of a sum of likelihoods what is less likely by so much, in log likelihood, is nothing."""
GOOD = 0.5
"""A reading that is less likely to have the good noise is an outlier."""
WILD, FARTHER = 0.1, 10.0
"""How many of the bad readings are wild: so many times as far off as the others. An echo off a steel door, a
glitch: one range of 60 m must not take somebody there of whom nothing was heard for twenty seconds."""


class Mixture(NamedTuple):
    """Good noise N(0, σ²), or with probability `outliers` bad noise N(shift, spread² + σ²); see `WILD`.

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


@njit(cache=True, forceinline=True)
def likelier(least: float, cost: float) -> float:
    """A likelihood over the largest one of a sum, from both costs; it is nothing where it is far smaller."""
    return 0.0 if cost - least > NEGLIGIBLE else float(np.exp(min(least - cost, 0.0)))


@njit(cache=True, forceinline=True, error_model="numpy")
def weigh_one(
    residual: float, sigma: float, predicted: float, outliers: float, shift: float, spread: float
) -> tuple[float, float, float]:
    """One reading's information, residual and probability of the good noise: see `weigh`."""
    good_variance = sigma**2
    bad_variance = good_variance + spread**2
    wild_variance = good_variance + (FARTHER * spread) ** 2
    good_total, bad_total = good_variance + predicted, bad_variance + predicted
    wild_total, off = wild_variance + predicted, (residual - shift) ** 2
    by_good = 0.5 * residual**2 / good_total
    by_bad, by_wild = 0.5 * off / bad_total, 0.5 * off / wild_total
    # The likeliest one is put before the sum, so that the sum is never nil.
    least = by_good if outliers == 0.0 else min(by_good, by_bad, by_wild)
    usual = (1.0 - outliers) / np.sqrt(good_total) * likelier(least, by_good)
    bad = (1.0 - WILD) * outliers / np.sqrt(bad_total) * likelier(least, by_bad)
    wild = WILD * outliers / np.sqrt(wild_total) * likelier(least, by_wild)
    total = usual + bad + wild
    from_good = usual / total / good_variance
    from_bad = (bad / bad_variance + wild / wild_variance) / total
    information = from_good + from_bad
    return information, residual - shift * from_bad / information, usual / total


@njit(cache=True, nogil=True, error_model="numpy")
def weigh(
    residual: Array, sigma: Array, predicted: Array, outliers: Array, shift: Array, spread: Array
) -> Weighted:
    """E-step: the probability of each component, and the Gaussian edge that all together pull with.

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
        noise = sigma[i], predicted[i], outliers[i], shift[i], spread[i]
        information[i], pulled[i], good[i] = weigh_one(residual[i], *noise)
    return Weighted(information, pulled, good)


@njit(cache=True, nogil=True, error_model="numpy")
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
        variance, off = sigma[i] ** 2, (residual[i] - shift[i]) ** 2
        bad_variance, wild_variance = variance + spread[i] ** 2, variance + (FARTHER * spread[i]) ** 2
        by_good = min(0.5 * (residual[i] / sigma[i]) ** 2, MOST)
        by_bad, by_wild = min(0.5 * off / bad_variance, MOST), min(0.5 * off / wild_variance, MOST)
        least = by_good if outliers[i] == 0.0 else min(by_good, by_bad, by_wild)
        total = (1.0 - outliers[i]) / sigma[i] * likelier(least, by_good)
        total += (1.0 - WILD) * outliers[i] / np.sqrt(bad_variance) * likelier(least, by_bad)
        total += WILD * outliers[i] / np.sqrt(wild_variance) * likelier(least, by_wild)
        cost[i] = least - np.log(total)
    return cost


@njit(cache=True)
def total_cost(left_out: Indices, cost: Array) -> float:
    """The sum of what readings cost, but for those that are left out, whose cost becomes nil."""
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
