"""Every residual's Jacobian against central differences: a wrong one still converges, to the wrong place."""

from collections.abc import Callable
from functools import partial

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.measurements.bearing import predict_bearing, wrap
from estimator.measurements.displacement import move
from estimator.measurements.range import PairJacobian, predict_range
from estimator.measurements.rssi import predict_rssi

STEP = 1e-6
seeds = st.integers(0, 10_000)


def differences(function: Callable[[Array], Array], at: Array) -> Array:
    """Derivatives of a vector function by central differences, outputs × inputs."""
    columns = []
    for i in range(len(at)):
        nudge = np.zeros(len(at))
        nudge[i] = STEP
        columns.append((function(at + nudge) - function(at - nudge)) / (2.0 * STEP))
    return np.column_stack(columns)


def check_pair(predict: Callable[[Array], PairJacobian], at: Array) -> None:
    got = predict(at)
    analytic = np.concatenate([got.by_a[0], got.by_b[0], got.by_extra[0]])
    numeric = differences(lambda x: predict(x).predicted, at)[0]
    assert np.abs(analytic - numeric).max() < 1e-5 * (1.0 + np.abs(numeric).max())


@given(seeds)
def test_ranges(seed: int) -> None:
    at = np.random.default_rng(seed).normal(0.0, 5.0, 8) * np.r_[np.ones(6), 0.02, 0.1]
    check_pair(lambda x: predict_range(x[None, :3], x[None, 3:6], x[6:7], x[7:8]), at)


@given(seeds)
def test_rssi(seed: int) -> None:
    chance = np.random.default_rng(seed)
    at = chance.normal(0.0, 5.0, 8) + np.r_[np.zeros(6), -45.0, 10.0]
    # Both as far as the law holds and where radios lie on each other, above all that it has.
    for heard_dbm in (chance.uniform(-95.0, -45.0, 1), chance.uniform(40.0, 100.0, 1) + at[6:7]):
        check_pair(partial(rssi_from, heard_dbm), at)


def rssi_from(heard_dbm: Array, x: Array) -> PairJacobian:
    return predict_rssi(heard_dbm, x[None, :3], x[None, 3:6], x[6:7], x[7:8])


@given(seeds)
def test_bearings(seed: int) -> None:
    at = np.random.default_rng(seed).normal(0.0, 5.0, 8)
    base = predict_bearing(at[None, :3], at[None, 3:6], at[6:7]).predicted

    def predict(x: Array) -> PairJacobian:
        got = predict_bearing(x[None, :3], x[None, 3:6], x[6:7])
        return got._replace(predicted=wrap(got.predicted - base))

    near = np.hypot(*(at[:2] - at[3:5]))
    if near > 2.0:  # nearer, the Jacobian is damped on purpose
        got = predict(at)
        damped = near**2 / (near**2 + 0.3**2)
        numeric = differences(lambda x: predict(x).predicted, at)[0]
        assert np.abs(got.by_b[0] - damped * numeric[3:6]).max() < 1e-5
        assert np.abs(got.by_extra[0] - numeric[6:]).max() < 1e-5


@given(seeds)
def test_displacements(seed: int) -> None:
    chance = np.random.default_rng(seed)
    state = chance.normal(0.0, 1.0, 6) * np.array([10.0, 10.0, 3.0, 2.0, 0.01, 0.05])
    # Columns of a table, as the filter hands them.
    steps = np.column_stack([chance.normal(0.0, 2.0, (2, 3)), chance.uniform(0.0, 5.0, 2)])
    delta, duration = steps[:, :3], steps[:, 3]
    numeric = differences(lambda x: move(x[None], delta, duration).state[0], state)
    assert np.abs(move(state[None], delta, duration).transition[0] - numeric).max() < 1e-6


def test_at_distance_nought_every_prediction_and_jacobian_is_finite() -> None:
    at, one = np.zeros((1, 3)), np.ones(1)
    for got in (
        predict_range(at, at, one, one),
        predict_rssi(one, at, at, one, one),
        predict_bearing(at, at, one),
    ):
        assert all(np.isfinite(part).all() for part in got)
