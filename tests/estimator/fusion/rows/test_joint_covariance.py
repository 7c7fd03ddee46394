"""The joint covariance of the numbers of readings against the inverse of the whole matrix."""

import numpy as np
import pytest

from estimator.fusion.rows.joint_covariance import joint, numbers_of, variances
from estimator.fusion.rows.rows import WIDTH
from estimator.graph.dense import Array, Indices
from estimator.graph.triangular import factorised

N = 26
BREADCRUMBS, UNITS, TECHNOLOGY = (0, 3, 6), (12, 18), 24
"""Where their numbers start; those from 9 on are of nobody who is heard."""


def heard(a: int, b: int) -> list[int]:
    """The numbers of a reading between two places; −1: an end that is fixed."""
    ends = [start + i if start >= 0 else -1 for start in (a, b) for i in range(3)]
    return [*ends, TECHNOLOGY, TECHNOLOGY + 1, -1]


COLUMNS: Indices = np.array(
    [
        *[heard(unit, crumb) for unit in UNITS for crumb in BREADCRUMBS],
        heard(BREADCRUMBS[1], UNITS[0]),
        heard(UNITS[0], UNITS[1]),
        heard(-1, BREADCRUMBS[2]),
        [UNITS[1] + 2, -1, -1, -1, -1, -1, TECHNOLOGY, -1, -1],
    ]
)


def information() -> Array:
    half = np.random.default_rng(3).normal(0.0, 1.0, (N, N))
    return half @ half.T + np.eye(N)


def covariances() -> Array:
    """Of the numbers of each reading, from the information about those that are used alone."""
    numbers = numbers_of(COLUMNS, N)
    whole = np.linalg.inv(information())[np.ix_(numbers.used, numbers.used)]
    k, own = len(numbers.used), np.zeros((len(COLUMNS), WIDTH, WIDTH))
    factor, unscale = np.zeros((k, k)), np.empty(k)
    assert factorised(np.linalg.inv(whole), factor, unscale)
    joint(factor, unscale, numbers, own)
    return own


def test_numbers_that_no_reading_depends_on_are_told_apart() -> None:
    numbers = numbers_of(COLUMNS, N)
    assert sorted([*numbers.used, *numbers.others]) == list(range(N))
    assert numbers.others.tolist() == [9, 10, 11, 15, 16, 17, 21, 22, 23]
    assert (numbers.used[numbers.at[COLUMNS >= 0]] == COLUMNS[COLUMNS >= 0]).all()
    assert (numbers.at[COLUMNS < 0] < 0).all()


def test_few_who_hear_many_stand_for_all_that_they_hear() -> None:
    numbers = numbers_of(COLUMNS, N)
    hubs = set(numbers.used[numbers.hubs].tolist())
    assert hubs.isdisjoint(range(9))
    assert {12, 13, 14, 18, 19, 20, 24, 25} == hubs


def test_each_reading_has_its_share_of_the_covariance_of_all() -> None:
    whole = np.linalg.inv(information())
    for own, columns in zip(covariances(), COLUMNS, strict=True):
        there = np.flatnonzero(columns >= 0)
        expected = whole[np.ix_(columns[there], columns[there])]
        np.testing.assert_allclose(own[np.ix_(there, there)], expected, rtol=1e-9)


def test_variances_are_forms_of_these() -> None:
    jacobian = np.random.default_rng(4).normal(0.0, 1.0, COLUMNS.shape) * (COLUMNS >= 0)
    own, found = covariances(), np.empty(len(COLUMNS))
    variances(own, jacobian, found)
    assert found == pytest.approx(np.einsum("mi,mij,mj->m", jacobian, own, jacobian))
    variances(-own, jacobian, found)
    assert (found == 0.0).all()
