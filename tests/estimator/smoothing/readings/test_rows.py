"""What readings in a window are worth together."""

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.learned.noise import LearnedNoise
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node, Role
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from tests.estimator.smoothing.windows import entered, fused, problem_of


def stood(role: Role, seconds: int = 200) -> list[AnyReading]:
    """A responder stands 8 m from a known node and ranges to it each second."""
    chance = np.random.default_rng(5)
    readings: list[AnyReading] = [
        Node(t=0.0, node="other", role=role, position_m=(8.0, 0.0, 0.0), sigma_m=0.05),
        entered(),
    ]
    for second in range(1, seconds + 1):
        readings.append(
            Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(0.0, 0.0, 0.0))
        )
        range_m = 8.0 + float(chance.normal(0.0, 0.1))
        readings.append(Range(t=float(second), a="ff1", b="other", range_m=range_m, technology="uwb"))
    return readings


def worth_m(role: Role, *, walls: bool = True) -> float:
    """Standard deviation of all ranges to a node of a role together (m)."""
    problem = problem_of(fused(stood(role)))
    problem.rows.learn(problem.layout.state.noise, walls=walls)
    told = problem.rows.sigma[: len(problem.rows.pairs)]
    return float((told**-2).sum() ** -0.5)


def test_inside_ranges_of_a_link_are_worth_no_more_than_what_stays_while_nobody_moves() -> None:
    assert worth_m("breadcrumb") == pytest.approx(physics.WALL_M, rel=0.2)


def test_nothing_stays_between_a_responder_and_a_surveyed_anchor() -> None:
    assert worth_m("anchor") < 0.5 * physics.WALL_M


def test_without_what_is_assumed_of_walls_they_are_worth_what_has_been_learned_of_them() -> None:
    assert worth_m("breadcrumb", walls=False) == pytest.approx(worth_m("anchor"), rel=0.01)


def beside_db(seconds: int) -> tuple[float, float]:
    """What all that a responder hears of a breadcrumb that he stands on is worth together (dB).

    Returns:
        As an encounter; and had he not been so near.
    """
    chance = np.random.default_rng(7)
    readings: list[AnyReading] = [
        Node(t=0.0, node="other", role="breadcrumb", position_m=(0.0, 0.0, 0.0), sigma_m=0.05),
        entered(),
    ]
    for second in range(1, seconds + 1):
        readings.append(
            Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(0.0, 0.0, 0.0))
        )
        dbm = -30.0 + float(chance.normal(0.0, 5.0))
        readings.append(Rssi(t=float(second), a="ff1", b="other", dbm=round(dbm, 1)))
    state = fused(readings)
    problem = problem_of(state)
    problem.rows.learn({name: LearnedNoise(products=0.6 * physics.NOISE_PRIOR) for name in state.sources})
    heard, afar = slice(len(problem.rows.pairs)), problem.rows.sigma.copy()
    x = problem.layout.start()
    problem.rows.widen(x, problem.linearise(x).jacobian)
    met_db, afar_db = (float((sigma[heard] ** -2).sum() ** -0.5) for sigma in (problem.rows.sigma, afar))
    return met_db, afar_db


def test_who_stands_on_a_breadcrumb_meets_it_once_however_often_he_hears_it() -> None:
    for seconds in (60, 240):
        met_db, afar_db = beside_db(seconds)
        assert 3.0 < met_db < afar_db


def test_who_ranges_once_a_second_is_asked_of_all_of_it_as_it_is() -> None:
    rows = problem_of(fused(stood("breadcrumb"))).rows
    chosen, asked = rows.rarer()
    assert len(chosen) == len(rows.pairs)
    assert asked.alike == pytest.approx(rows.alike)
    assert asked.sigma == pytest.approx(rows.sigma)
    assert (asked.noise == rows.noise).all()


def test_floors_that_are_held_widen_as_those_that_an_estimate_has() -> None:
    """A crumb three storeys up is heard through floors; held on one storey, it is not."""
    readings: list[AnyReading] = [
        Node(t=0.0, node="other", role="breadcrumb", position_m=(1.0, 0.0, 9.0), sigma_m=0.05),
        entered(),
        *[Rssi(t=float(second), a="ff1", b="other", dbm=-70.0) for second in range(1, 9)],
    ]
    problem = problem_of(fused(readings))
    rows, x = problem.rows, problem.layout.start()
    jacobian, usual = problem.linearise(x).jacobian, rows.sigma.copy()
    rows.widen(x, jacobian)
    told = rows.sigma.copy()
    rows.floors = rows.through(x)
    assert rows.floors.all()
    assert len(rows.floors) == 8
    rows.widen(x, jacobian)
    assert (rows.sigma == told).all()
    assert (told[:8] > usual[:8]).all()
    rows.floors = np.zeros(8, dtype=np.bool_)
    rows.widen(x, jacobian)
    assert (rows.sigma[:8] < told[:8]).all()
