"""P0 and n found anew by powers that another way foretells, compiled."""

from typing import NamedTuple

from numba import njit

from estimator.graph.dense import Array, Indices
from estimator.smoothing.units.heard_powers import EXPONENT, MOST, OFF_DB, SINCE_T, VARIANCE, T, cost_of


class PowerLaw(NamedTuple):
    """Cost of P0 and n being more than the solution has them by δ, a parabola: cost − gᵀδ + ½ δᵀHδ.

    Attributes:
        pp: H of P0 (dB⁻²).
        pn: of P0 and n (dB⁻¹).
        nn: of n.
        p: g of P0 (dB⁻¹).
        n: of n.
        cost: where both are as the solution has them (log likelihood).
    """

    pp: float
    pn: float
    nn: float
    p: float
    n: float
    cost: float


class Foretold(NamedTuple):
    """What is foretold of each power by another way.

    Attributes:
        fall_db: by how much n = 1 lets it fall over its distance, m.
        off_db: what is left of it, m.
        variance: of its noise, and by how little the way is known, m (dB²).
    """

    fall_db: Array
    off_db: Array
    variance: Array


@njit(cache=True, error_model="numpy")
def law_before(heard: Array, fall_db: Array, t: float, usual: PowerLaw) -> PowerLaw:
    """What is told of P0 and n by powers that a turn at an epoch does not change, beside what is usual."""
    pp, pn, nn, p, n, cost = usual
    for i in range(len(heard)):
        row = heard[i]
        changed = row[T] > t and row[SINCE_T] <= t
        if row[EXPONENT] > 0.0 and not changed and cost_of(row[OFF_DB], row[VARIANCE]) < MOST:
            weight = 1.0 / row[VARIANCE]
            pp, pn, nn = pp + weight, pn - weight * fall_db[i], nn + weight * fall_db[i] ** 2
            p, n = p + weight * row[OFF_DB], n - weight * fall_db[i] * row[OFF_DB]
    return PowerLaw(pp, pn, nn, p, n, cost)


@njit(cache=True, error_model="numpy")
def fit_law(since: Indices, before: PowerLaw, other: Foretold) -> float:
    """Find P0 and n anew by powers of another way, which are then off by less; what that costs the law."""
    fall_db, off_db, variance = other
    pp, pn, nn, p, n, cost = before
    for i in since:
        weight = 1.0 / variance[i]
        if 0.5 * off_db[i] ** 2 * weight < MOST:
            pp, pn, nn = pp + weight, pn - weight * fall_db[i], nn + weight * fall_db[i] ** 2
            p, n = p + weight * off_db[i], n - weight * fall_db[i] * off_db[i]
    size = pp * nn - pn * pn
    power, steeper = (nn * p - pn * n) / size, (pp * n - pn * p) / size
    for i in since:
        off_db[i] = off_db[i] - power + steeper * fall_db[i]
    cost = cost - before.p * power - before.n * steeper
    bend = before.pp * power**2 + 2.0 * before.pn * power * steeper + before.nn * steeper**2
    return cost + 0.5 * bend
