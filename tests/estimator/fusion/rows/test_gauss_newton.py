"""The compiled robust step against the same written with whole arrays."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.memory.ledger import BEARING, RANGE, RSSI
from estimator.fusion.rows.gauss_newton import (
    BENT,
    HALVINGS,
    INDEFINITE,
    SETTLED,
    SOLVED,
    UNSOLVABLE,
    Minimum,
    minimise,
)
from estimator.fusion.rows.prediction import follow, predict
from estimator.fusion.rows.rows import (
    A_E,
    AHEAD,
    B_E,
    CONSTANT,
    FIELDS,
    KIND,
    ONE,
    OUTLIERS,
    SHIFT,
    SIGMA,
    SPREAD,
    VALUE,
    B,
    Row,
    Single,
    columns_of,
    table_from,
    table_of,
)
from estimator.graph.dense import Array, Indices
from estimator.graph.filter_kernels import scatter
from estimator.graph.robust import FARTHER, WILD, weigh
from estimator.graph.variable import Variable
from estimator.measurements.bearing import predict_bearing, wrap
from estimator.measurements.range import predict_range
from estimator.measurements.rssi import predict_rssi

N = 14
"""Two positions, the states of two technologies, and those of a unit, which has only two here."""


def some_table(chance: np.random.Generator, m: int) -> Array:
    """m readings of all kinds, some of them to a fixed end."""
    pairs, singles = [], []
    for _ in range(m):
        kind = int(chance.integers(ONE, BEARING + 1))
        if kind == ONE:
            value = float(chance.normal(0.0, 4.0))
            node = Variable("position", str(chance.integers(0, 2)))
            singles.append(Single(node, int(chance.integers(0, 3)), value, 1.0, physics.FIX_NOISE))
            continue
        extra, value, sigma, noise = {
            RANGE: (6, float(chance.uniform(0.0, 12.0)), 0.3, physics.RANGE_NOISE),
            RSSI: (9, float(chance.uniform(-80.0, -40.0)), 6.0, physics.RSSI_NOISE),
            BEARING: (12, float(chance.uniform(-3.0, 3.0)), 0.2, physics.BEARING_NOISE),
        }[kind]
        b = int(chance.choice([-1, 3]))
        pairs.append(
            Row(
                kind,
                0,
                value,
                sigma,
                *noise,
                sigma,
                b,
                extra,
                0.5,
                0,
                0,
                *chance.normal(0.0, 2.0, 6).tolist(),
            )._replace(ahead=0.0 if kind == BEARING else float(chance.uniform(-1.0, 1.0)))
        )
    told = table_from(sorted(pairs), FIELDS)
    return table_of({Variable("position", "0"): 0, Variable("position", "1"): 3}, singles, told)


def some_state(chance: np.random.Generator) -> tuple[Array, Array, Array]:
    start = np.concatenate([chance.normal(0.0, 5.0, 6), [0.0, 0.1, 0.2, -45.0, 2.2, 3.0, 0.1, 0.0]])
    half = chance.normal(0.0, 1.0, (N, 2 * N))
    return half @ half.T / 20.0, chance.normal(0.0, 0.3, N), start


def linearise_plainly(table: Array, columns: Indices, x: Array) -> tuple[Array, Array]:
    used = (columns >= 0).astype(float)
    here = x[np.maximum(columns, 0)] * used
    a, b = here[:, :3] + table[:, A_E : A_E + 3], here[:, 3:6] + table[:, B_E : B_E + 3]
    first, second, value = here[:, 6] + table[:, CONSTANT], here[:, 7].copy(), table[:, VALUE].copy()
    body, ahead = table[:, AHEAD] * here[:, 8], table[:, AHEAD, None]
    jacobian, residual = np.zeros((len(table), 9)), value - here[:, 0]
    jacobian[:, 0] = 1.0
    for kind, got in (
        (RANGE, predict_range(a, b, first, second)),
        (RSSI, predict_rssi(value, a, b, first, second)),
        (BEARING, predict_bearing(a, b, first)),
    ):
        mine = table[:, KIND] == kind
        off = value - got.predicted - body
        residual[mine] = (wrap(off) if kind == BEARING else off)[mine]
        jacobian[mine] = np.concatenate([got.by_a, got.by_b, got.by_extra, ahead], axis=1)[mine]
    return jacobian * used, residual


class Reached(NamedTuple):
    """What readings have led to, and the estimate and the information of all numbers with them."""

    found: Minimum
    x: Array
    matrix: Array


def reach(table: Array, prior: Array, pull: Array, start: Array) -> Reached:
    seen, x, matrix = predict(table, prior, pull, start), start.copy(), prior.copy()
    found = minimise(table, seen, 6)
    follow(seen, found.x, x)
    scatter(matrix, np.zeros(len(x)), seen.columns, found.jacobian, found.information, found.residual)
    return Reached(found, x, matrix)


def descend_plainly(table: Array, prior: Array, pull: Array, start: Array, iterations: int) -> Array:
    """Gauss-Newton of `minimise`, in dense matrices and without its short cuts."""
    columns = columns_of(table)
    own, outliers, shift, spread = (table[:, c].copy() for c in (SIGMA, OUTLIERS, SHIFT, SPREAD))
    ranged = table[:, KIND] == RANGE
    # Places of fixed ends are at random here: only ranges between both nodes share a line.
    alike = np.where(ranged & (table[:, B] >= 0.0), (ranged & (table[:, B] >= 0.0)).sum(), 1)
    heard = table[:, KIND] == RSSI
    heard_alike = np.where(heard & (table[:, B] >= 0.0), (heard & (table[:, B] >= 0.0)).sum(), 1)

    def dense(x: Array) -> tuple[Array, Array]:
        jacobian, residual = linearise_plainly(table, columns, x)
        whole = np.zeros((len(table), N))
        np.add.at(whole, (np.arange(len(table))[:, None], columns), jacobian)
        return whole, residual

    def arcs(jacobian: Array, residual: Array, information: Array) -> Array:
        lever = np.where(ranged, (table[:, VALUE] - residual) * (jacobian[:, :2] ** 2).sum(axis=1), 0.0)
        # States at random make lengths below nil, too.
        lever = np.maximum(lever, 0.0)
        far = lever > 0.0
        east, north = jacobian[far, 0] / lever[far], jacobian[far, 1] / lever[far]
        aside = np.zeros((len(table), N))
        aside[far, 0], aside[far, 1] = -north, east
        both = table[far, B] >= 0.0
        aside[far, 3], aside[far, 4] = both * north, both * -east
        v = np.einsum("mi,ij,mj->m", aside, np.linalg.inv(information), aside)
        found = alike * lever**2 * (1.5 - 2.0 * np.exp(-0.5 * v) + 0.5 * np.exp(-2.0 * v))
        return found if (found > (BENT * own) ** 2).any() else np.zeros(len(table))

    def logarithms(jacobian: Array, x: Array, information: Array) -> Array:
        covariance, found = np.linalg.inv(information), np.zeros(len(table))
        for r in np.flatnonzero(heard & (jacobian[:, 6] != 0.0)):
            by_place, slope_db = jacobian[r, :3], 10.0 / np.log(10.0) * max(x[10], 0.5)
            across = np.array([-by_place[1], by_place[0], 0.0]) / np.hypot(*by_place[:2])
            aside, farther = np.zeros(N), np.zeros(N)
            aside[:3], farther[:3] = across * np.linalg.norm(by_place) / slope_db, by_place / slope_db
            if table[r, B] >= 0.0:
                aside[3:6], farther[3:6] = -aside[:3], -farther[:3]
            psi, rho = aside @ covariance @ aside, farther @ covariance @ farther
            off = np.log(1.0 + 3.0**0.5 * psi) ** 2 / 4.0 + rho**2 / (1.0 + rho)
            found[r] = heard_alike[r] * slope_db**2 * off
        return found if (found > (BENT * own) ** 2).any() else np.zeros(len(table))

    def misfit(sigma: Array, residual: Array, moved: Array) -> float:
        good, bad, wild = sigma**2, sigma**2 + spread**2, sigma**2 + (FARTHER * spread) ** 2
        off = (residual - shift) ** 2
        likely = np.log1p(-outliers) - 0.5 * (np.log(good) + residual**2 / good)
        for share, variance in ((1.0 - WILD, bad), (WILD, wild)):
            other = np.log(share * outliers) - 0.5 * (np.log(variance) + off / variance)
            likely = np.logaddexp(likely, other)
        return float(0.5 * moved @ prior @ moved - pull @ moved - likely.sum())

    x, matrix = start.copy(), prior
    # What no reading depends on goes beforehand to where the rest lets it rest.
    others = np.setdiff1d(np.arange(N), columns)
    x[others] += np.linalg.solve(prior[np.ix_(others, others)], pull[others])
    whole, residual = dense(x)
    told = linearise_plainly(table, columns, x)[0]
    wider = arcs(told, residual, prior) + logarithms(told, x, prior)
    curved, sigma = wider.any(), np.sqrt(own**2 + wider)
    predicted = np.einsum("mi,ij,mj->m", whole, np.linalg.inv(prior), whole)
    cost = misfit(sigma, residual, x - start)
    for _ in range(iterations):
        weighted = weigh(residual, sigma, predicted, outliers, shift, spread)
        matrix = prior + whole.T @ (whole * weighted.information[:, None])
        gradient = pull - prior @ (x - start) + whole.T @ (weighted.information * weighted.residual)
        step, before, linear = np.linalg.solve(matrix, gradient), x, residual
        for _ in range(HALVINGS):
            x = before + step
            ahead, residual = dense(x)
            reached = misfit(sigma, residual, x - start)
            if reached <= cost + 1.0:
                break
            step = 0.5 * step
        if reached > cost + 1.0:
            return before
        cost = reached
        forecast = linear - whole @ (x - before)
        rests = (np.abs(residual - forecast) < BENT * np.sqrt(sigma**2 + predicted)).all()
        if curved:
            was = sigma**2
            told = linearise_plainly(table, columns, x)[0]
            wider = arcs(told, residual, matrix) + logarithms(told, x, matrix)
            sigma = np.sqrt(own**2 + wider)
            rests = rests and (np.abs(sigma**2 - was) <= SETTLED * was).all()
            cost = misfit(sigma, residual, x - start)
        if rests:
            break
        whole = ahead
        predicted = np.einsum("mi,ij,mj->m", whole, np.linalg.inv(matrix), whole)
    return x


@given(st.integers(0, 10_000), st.integers(1, 12))
def test_the_compiled_descent_finds_what_whole_arrays_find(seed: int, m: int) -> None:
    chance = np.random.default_rng(seed)
    table, (prior, pull, start) = some_table(chance, m), some_state(chance)
    found, x, _ = reach(table, prior, pull, start)
    assert found.outcome == SOLVED
    assert x == pytest.approx(descend_plainly(table, prior, pull, start, 6), abs=1e-6)


def test_an_information_matrix_that_is_not_positive_definite_is_told_apart() -> None:
    chance = np.random.default_rng(1)
    table, (prior, pull, start) = some_table(chance, 3), some_state(chance)
    assert reach(table, -prior, pull, start).found.outcome == INDEFINITE
    assert reach(table, prior, np.full(N, np.nan), start).found.outcome == UNSOLVABLE


def test_a_state_is_told_what_readings_were_solved_by_however_soon_it_is_left() -> None:
    """Two ranges beside their radios turn their lines of sight with the first step."""
    beside = [Row(RANGE, 0, 4.0, 0.3, *physics.RANGE_NOISE, 0.3, b_e=east) for east in (1.0, 6.0)]
    table, known, nowhere = table_from(beside, FIELDS), np.eye(3) / 4.0, np.zeros(3)
    seen = predict(table, known, nowhere, np.array([0.0, 1.0, 0.0]))
    found = minimise(table, seen, 1)
    assert not found.doubted
    assert np.linalg.norm(found.x - seen.x) > 0.5
    assert (found.jacobian == seen.jacobian).all()
    assert not (minimise(table, seen, 6).jacobian == seen.jacobian).all()


def test_nobody_is_surer_of_where_he_stays_by_a_fix_that_he_does_not_follow() -> None:
    """Who is known to half a metre along one line is told to be three metres along it: it is an outlier."""
    along, across = np.array([1.0, 1.0, 0.0]) / np.sqrt(2.0), np.array([1.0, -1.0, 0.0]) / np.sqrt(2.0)
    known = np.outer(along, along) / 0.5**2 + np.outer(across, across) / 5.0**2 + np.diag([0.0, 0.0, 1.0])
    node, noise = Variable("position", "0"), physics.FIX_NOISE
    fix = [Single(node, axis, float(4.0 * along[axis]), 0.05, noise) for axis in range(3)]
    table = table_of({node: 0}, fix, np.empty((0, FIELDS)))
    found, x, matrix = reach(table, known, np.zeros(3), np.zeros(3))
    sure = np.linalg.inv(matrix)
    assert np.linalg.norm(x - 4.0 * along) > 3.0
    assert along @ sure @ along > 0.9 * 0.5**2
    assert (found.good[:2] < 0.5).all()


def test_a_range_does_not_tell_where_on_its_arc_somebody_is() -> None:
    """He is known to centimetres along a line of sight from before, which was turned by a few degrees."""
    far_m, aside_m = 70.0, 8.0
    was = np.array([far_m, -3.0]) / math.hypot(far_m, 3.0)
    across = np.array([-was[1], was[0]])
    known = np.diag([0.0, 0.0, 1.0])
    known[:2, :2] = np.outer(was, was) / 0.05**2 + np.outer(across, across) / aside_m**2
    start = np.array([far_m, 0.0, 0.0])
    table = table_from([Row(RANGE, 0, far_m + 0.1, 0.1, *physics.RANGE_NOISE, 0.1)], FIELDS)
    found = reach(table, known, np.zeros(3), start)
    assert np.linalg.norm(found.x - start) < 1.0
    assert np.sqrt(np.linalg.inv(found.matrix)[1, 1]) > 0.8 * aside_m
    # Where another radio tells how far aside he is, both tell all that they know.
    second = Row(RANGE, 0, 50.0, 0.1, *physics.RANGE_NOISE, 0.1, b_e=far_m, b_n=-50.0)
    both = reach(table_from([*table.tolist(), second], FIELDS), known, np.zeros(3), start)
    assert (np.sqrt(np.diag(np.linalg.inv(both.matrix)))[:2] < 0.15).all()
