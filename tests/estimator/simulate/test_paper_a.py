"""Paper A's experiment as simulated: its walk, its drops, its radios, and how far off dead reckoning ends."""

import numpy as np
import pytest

from estimator.measurements import Displacement, Drop, Rssi
from estimator.simulate import Scenario, scenario

SEEDS = range(30)


@pytest.fixture(scope="module")
def played() -> Scenario:
    return scenario("paper-a", seed=3)


def reckoned_error_m(played: Scenario) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    own = [reading for reading in played.readings if isinstance(reading, Displacement)]
    place = np.cumsum([reading.delta_m for reading in own], axis=0)
    truth = played.truth["ff1"].at(np.array([reading.t for reading in own]))
    error: np.ndarray[tuple[int], np.dtype[np.float64]] = np.linalg.norm((place - truth)[:, :2], axis=1)
    return error


def test_dead_reckoning_alone_is_9_m_off_after_a_lap_and_30_m_at_the_end() -> None:
    errors = np.array([reckoned_error_m(scenario("paper-a", seed)) for seed in SEEDS])
    assert errors.shape == (30, 400)
    assert errors[:, 99].mean() == pytest.approx(9.0, abs=2.0)
    assert errors[:, -1].mean() == pytest.approx(30.0, abs=5.0)


def test_four_hundred_metres_are_walked_at_one_metre_a_second(played: Scenario) -> None:
    track = played.truth["ff1"]
    assert track.distance_m == pytest.approx(400.0, abs=0.01)
    assert np.allclose(
        track.at(np.array([30.0, 50.0, 80.0, 100.0])), [(30, 0, 0), (30, 20, 0), (0, 20, 0), (0, 0, 0)]
    )


def test_breadcrumbs_are_dropped_on_the_first_lap_beside_the_foot(played: Scenario) -> None:
    drops = [reading for reading in played.readings if isinstance(reading, Drop)]
    assert [drop.t for drop in drops] == [14.0, 28.0, 42.0, 57.0, 71.0, 85.0]
    for drop in drops:
        foot = played.truth["ff1"].at(np.array([drop.t]))[0]
        assert np.linalg.norm(played.truth[drop.node].position_m[0] - foot) == pytest.approx(0.3)


def test_every_node_within_25_m_is_heard_once_a_second_and_none_beyond(played: Scenario) -> None:
    heard = {(r.b, r.t) for r in played.readings if isinstance(r, Rssi)}
    for node in ("base", "b1", "b4"):
        for t in range(100, 401):
            gap = played.truth["ff1"].at(np.array([float(t)]))[0] - played.truth[node].position_m[0]
            assert ((node, float(t)) in heard) == (np.linalg.norm(gap) <= 25.0)


def test_signal_strength_is_gaussian_in_db_with_the_stated_spread() -> None:
    far: list[float] = []
    near: list[float] = []
    for seed in range(10):
        played = scenario("paper-a", seed)
        for reading in played.readings:
            if isinstance(reading, Rssi):
                gap = played.truth["ff1"].at(np.array([reading.t]))[0] - played.truth[reading.b].position_m[0]
                distance = float(np.linalg.norm(gap))
                if distance > 0.1:
                    residual = reading.dbm - (-40.0 - 25.0 * np.log10(distance))
                    (near if distance < 1.5 else far).append(residual)
    assert np.mean(far) == pytest.approx(0.0, abs=0.2)
    assert np.std(far) == pytest.approx(5.0, rel=0.03)
    assert np.std(near) == pytest.approx(1.5, rel=0.1)
