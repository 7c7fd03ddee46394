"""What a Kirchhoff state foretells of ranges before it takes them in."""

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.learned import rival
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.rows.predicted_pairs import PredictedPairs, predict_pairs
from estimator.fusion.rows.prediction import predict
from estimator.fusion.rows.rows import WIDTH, Row, columns_of, linearise, table_of
from estimator.graph.dense import Array, Indices

UNIT, BREADCRUMB, OTHER_UNIT, TECHNOLOGY = 0, 3, 6, 9
X = np.array([1.0, 2.0, 0.0, 8.0, -3.0, 0.5, 20.0, 0.0, 0.0, 0.2, 0.01])

NONE, ALL = np.array([False]), np.array([True])
"""Of which units powers are asked."""

WITH_LOSS = np.append(X[:TECHNOLOGY], [3.0, 2.5])
"""The same, but that what a technology adds is a power (dB) and an exponent."""


def ranged(a: int, b: int, link: int = 0) -> Row:
    return Row(RANGE, a, 9.0, 0.2, 0.1, 1.5, 3.0, 0.3, b, TECHNOLOGY, link=link, b_e=5.0)


def heard(dbm: float = -70.0) -> Row:
    return Row(RSSI, UNIT, dbm, 40.0, 0.05, -8.0, 12.0, 6.0, BREADCRUMB, TECHNOLOGY, constant=-45.0, link=0)


def table(*rows: Row) -> Array:
    return table_of({}, [], np.array(rows, dtype=np.float64))


def information() -> Array:
    half = np.random.default_rng(5).normal(0.0, 1.0, (len(X), len(X)))
    return half @ half.T + np.eye(len(X))


def foretold(
    rows: Array, epochs: Array, units: Indices, powers: NDArray[np.bool_], x: Array = X
) -> PredictedPairs:
    seen = predict(rows, information(), np.zeros(len(x)), x)
    return predict_pairs(rows, epochs, units, powers, seen, x)


def test_variances_are_those_of_the_covariance() -> None:
    rows, covariance = table(ranged(UNIT, BREADCRUMB)), np.linalg.inv(information())
    told, own = foretold(rows, np.array([7.0]), np.array([UNIT]), NONE)
    columns, jacobian, residual = columns_of(rows), np.empty((1, WIDTH)), np.empty(1)
    linearise(rows, columns, X, jacobian, residual)
    slope = np.zeros(len(X))
    there = columns[0] >= 0
    slope[columns[0, there]] = jacobian[0, there]
    np.testing.assert_allclose(told[0, rival.UNSURE], slope @ covariance @ slope)
    np.testing.assert_allclose(told[0, rival.OFF], residual[0])
    slope[:3] = 0.0
    np.testing.assert_allclose(told[0, rival.REST], slope @ covariance @ slope)
    np.testing.assert_allclose(own[0], covariance[:2, :2])


def test_it_is_told_from_the_other_end_whichever_that_is() -> None:
    for row in (ranged(UNIT, BREADCRUMB)._replace(b_e=0.0), ranged(BREADCRUMB, UNIT)._replace(b_e=0.0)):
        told, _ = foretold(table(row), np.array([7.0]), np.array([UNIT]), NONE)
        np.testing.assert_allclose(told[0, [rival.EAST, rival.NORTH, rival.UP]], [8.0, -3.0, -0.5])


def test_of_ranges_between_two_units_and_of_none_nothing_is_told() -> None:
    rows = table(ranged(UNIT, OTHER_UNIT), ranged(-1, BREADCRUMB), ranged(UNIT, BREADCRUMB, link=-1))
    told, _ = foretold(rows, np.arange(3.0), np.array([UNIT, OTHER_UNIT]), np.repeat(NONE, 2))
    assert not len(told)


def test_ranges_come_in_order_of_epoch_each_with_its_unit() -> None:
    rows = table(ranged(UNIT, BREADCRUMB, 1), ranged(BREADCRUMB, OTHER_UNIT, 2), ranged(UNIT, -1, 3))
    told, _ = foretold(rows, np.array([3.0, 1.0, 2.0]), np.array([UNIT, OTHER_UNIT]), np.repeat(NONE, 2))
    assert told[:, rival.LINK].tolist() == [2.0, 3.0, 1.0]
    assert told[:, rival.UNIT].tolist() == [1.0, 0.0, 0.0]


def test_of_powers_it_is_told_only_where_they_are_asked() -> None:
    rows = table(heard(), ranged(UNIT, BREADCRUMB, 1))
    asked, _ = foretold(rows, np.zeros(2), np.array([UNIT]), ALL, WITH_LOSS)
    others, _ = foretold(rows, np.zeros(2), np.array([UNIT]), NONE, WITH_LOSS)
    assert asked[:, rival.EXPONENT].tolist() == [2.5, 0.0]
    assert others[:, rival.EXPONENT].tolist() == [0.0]


def test_a_power_is_what_its_way_makes_of_it_without_what_was_sent() -> None:
    told, _ = foretold(table(heard()), np.zeros(1), np.array([UNIT]), ALL, WITH_LOSS)
    sent_dbm = -45.0 + WITH_LOSS[TECHNOLOGY]
    np.testing.assert_allclose(told[0, rival.READ], -70.0 - sent_dbm)


def test_a_power_is_as_noisy_as_was_assumed_however_alike_a_bad_unit_has_made_them() -> None:
    told, _ = foretold(table(heard()), np.zeros(1), np.array([UNIT]), ALL, WITH_LOSS)
    assert told[0, rival.SIGMA] == 6.0
