"""What a state knows of readings before it takes them in, against the whole of it."""

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.rows.prediction import Prediction, follow, predict
from estimator.fusion.rows.rows import FIELDS, Row, table_from
from estimator.graph.dense import Array

N, USED, OTHERS = 14, [3, 4, 5, 9, 10, 11, 12, 13], [0, 1, 2, 6, 7, 8]
TABLE = table_from([Row(RANGE, 9, 7.0, 0.2, *physics.RANGE_NOISE, 0.2, 3, 12)], FIELDS)
"""A range between two nodes, and two others of whom nothing is heard."""
CHANCE = np.random.default_rng(8)
HALF, PULL, X = CHANCE.normal(0.0, 1.0, (N, N)), CHANCE.normal(0.0, 1.0, N), CHANCE.normal(0.0, 5.0, N)
INFORMATION = HALF @ HALF.T + np.eye(N)


def seen(matrix: Array = INFORMATION, pull: Array = PULL) -> Prediction:
    return predict(TABLE, matrix, pull, X)


def test_others_are_summed_out() -> None:
    covariance, mean = np.linalg.inv(INFORMATION)[np.ix_(USED, USED)], np.linalg.solve(INFORMATION, PULL)
    found = seen()
    assert found.prior @ covariance == pytest.approx(np.eye(len(USED)), abs=1e-9)
    assert np.linalg.solve(found.prior, found.pull) == pytest.approx(mean[USED])


def test_a_prediction_is_as_unsure_as_the_covariance_says() -> None:
    found, slope = seen(), np.zeros(N)
    there = found.columns[0] >= 0
    slope[found.columns[0, there]] = found.jacobian[0, there]
    assert found.predicted[0] == pytest.approx(slope @ np.linalg.inv(INFORMATION) @ slope)


def test_others_go_along_with_what_readings_have_moved() -> None:
    moved = X[USED] + np.linspace(-1.0, 1.0, len(USED))
    x, rest = X.copy(), INFORMATION[np.ix_(OTHERS, OTHERS)]
    follow(seen(), moved, x)
    pulled = PULL[OTHERS] - INFORMATION[np.ix_(OTHERS, USED)] @ (moved - X[USED])
    assert x[USED] == pytest.approx(moved)
    assert x[OTHERS] == pytest.approx(X[OTHERS] + np.linalg.solve(rest, pulled))


def test_who_rests_stays_where_nothing_has_moved() -> None:
    x = X.copy()
    follow(seen(pull=np.zeros(N)), X[USED], x)
    assert (x == X).all()


@pytest.mark.parametrize("row", [USED[0], OTHERS[0]])
def test_an_indefinite_state_is_told_wherever_it_is_so(row: int) -> None:
    broken = INFORMATION.copy()
    broken[row, row] = -1.0
    assert seen().solvable
    assert not seen(broken).solvable
