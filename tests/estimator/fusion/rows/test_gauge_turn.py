"""Readings between nodes do not turn the map, however they are linearised; readings of north do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.learned.link_correlation import NEW
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.rows.gauss_newton import SOLVED
from estimator.fusion.rows.rival_kernels import units_from
from estimator.fusion.rows.rows import FIELDS, Row, Single, table_from, table_of
from estimator.fusion.update import ask_and_take_in
from estimator.graph.dense import Array
from estimator.graph.gauge import turn_about
from estimator.graph.kirchhoff import Kirchhoff
from estimator.graph.variable import Variable

seeds = st.integers(0, 10_000)
HEADING_SIGMA_RAD, RANGE_SIGMA_M, OFF_M = 0.1, 0.5, 1.0
FF, UNIT, RADIO = Variable("position", "ff"), Variable("unit", "ff"), Variable("range", "uwb")
BEACONS = [Variable("position", f"b{number}") for number in range(3)]
BASE_M = np.zeros(2)
ENGINE = Variable("position", "engine")
STILL = frozenset({"engine"})


def mapped(chance: np.random.Generator, known_m: float = 0.5) -> Kirchhoff:
    """A unit and three beacons, known to each other; all may be turned about the base as a heading may."""
    graph = Kirchhoff()
    for variable in (FF, *BEACONS):
        graph.add_node(variable, [*chance.uniform(15.0, 40.0, 2) * chance.choice([-1, 1], 2), 0.0], [1e3] * 3)
    graph.add_node(UNIT, (0.0, 0.0, 0.0), (1e3, 0.01, 0.02))
    graph.add_node(RADIO, (0.0, 0.0, 0.0), (0.01, 0.1, 0.02))
    turn = turn_about(graph.reference, graph.turning(), BASE_M)
    rows = chance.normal(0.0, 1.0 / known_m, (4 * graph.size, graph.size))
    rows -= np.outer(rows @ turn, turn) / (turn @ turn)
    heading = np.zeros((1, graph.size))
    heading[0, graph.rows(UNIT).start] = 1.0
    told = np.concatenate([rows, heading / HEADING_SIGMA_RAD])
    graph.add_measurements(
        np.tile(np.arange(graph.size), (len(told), 1)), told, np.ones(len(told)), np.zeros(len(told))
    )
    return graph


def ranges(graph: Kirchhoff, chance: np.random.Generator, moment_m: float) -> Array:
    """To each beacon, from where he stood a moment ago, each off by two sigmas or so."""
    me, rows = graph.value(FF), []
    for beacon in BEACONS:
        moment = [*chance.uniform(-moment_m, moment_m, 2).tolist(), 0.0]
        range_m = float(np.linalg.norm(me + moment - graph.value(beacon))) + chance.normal(0.0, OFF_M)
        ends, states = (graph.rows(FF).start, graph.rows(beacon).start), graph.rows(RADIO).start
        noise = (0.0, 0.0, 1.0)
        rows.append(
            Row(
                RANGE,
                ends[0],
                range_m,
                RANGE_SIGMA_M,
                *noise,
                RANGE_SIGMA_M,
                ends[1],
                states,
                0.0,
                0,
                -1,
                *moment,
            )
        )
    return table_from(rows, FIELDS)


def taken_in(graph: Kirchhoff, table: Array) -> None:
    told, sums, nobody = np.empty((len(table), 3)), np.zeros((1, 6)), units_from([], [])
    newest, epochs, changed = np.array([NEW]), np.zeros(len(table)), graph.turning(STILL)
    found, _ = ask_and_take_in(
        table, epochs, nobody, *graph.storage(), graph.size, changed, BASE_M, newest, told, sums, 6
    )
    assert found[0] == SOLVED


def known_of_north(graph: Kirchhoff) -> float:
    """What is known of a turn about the base of all but the engine (1/rad²)."""
    turn = turn_about(graph.reference, graph.turning(STILL), BASE_M)
    return float(turn @ graph.information @ turn)


@given(seeds, st.floats(0.0, 1.0))
def test_nobody_learns_from_ranges_where_north_is(seed: int, moment_m: float) -> None:
    """Though the places move by metres as they are taken in, and he stood elsewhere when he was ranged."""
    chance = np.random.default_rng(seed)
    graph = mapped(chance)
    before = known_of_north(graph)
    for _ in range(5):
        taken_in(graph, ranges(graph, chance, moment_m))
    assert before == pytest.approx(HEADING_SIGMA_RAD**-2, rel=1e-3)
    assert known_of_north(graph) == pytest.approx(before, rel=0.1)


@given(seeds, st.floats(0.0, 1.0))
def test_nor_from_an_engine_in_the_street_that_nobody_ranges(seed: int, moment_m: float) -> None:
    """It stands where it was told to: the map is turned about the base, and not about it or in between."""
    chance = np.random.default_rng(seed)
    graph = mapped(chance)
    graph.add_node(ENGINE, (60.0, -20.0, 0.0), (0.2, 0.2, 0.2))
    before = known_of_north(graph)
    for _ in range(5):
        taken_in(graph, ranges(graph, chance, moment_m))
    assert before == pytest.approx(HEADING_SIGMA_RAD**-2, rel=1e-3)
    assert known_of_north(graph) == pytest.approx(before, rel=0.1)
    assert graph.value(ENGINE)[:2] == pytest.approx([60.0, -20.0], abs=1e-6)


@given(seeds, st.floats(0.0, 1.0))
def test_ranges_do_not_turn_the_map(seed: int, moment_m: float) -> None:
    """They move him and the map by metres, and are linearised several times on the way."""
    chance = np.random.default_rng(seed)
    graph = mapped(chance)
    matrix, was = graph.information.copy(), graph.reference.copy()
    turn = turn_about(was, graph.turning(), BASE_M)
    taken_in(graph, ranges(graph, chance, moment_m))
    turned_rad = float(turn @ matrix @ (graph.reference - was)) * HEADING_SIGMA_RAD**2
    assert abs(turned_rad) < 0.05 * HEADING_SIGMA_RAD


@given(seeds)
def test_fixes_lead_him_and_the_map_to_where_least_squares_do(seed: int) -> None:
    """They tell where north is: nothing of that is taken back."""
    chance = np.random.default_rng(seed)
    graph = mapped(chance)
    fix_m = graph.value(FF)[:2] + chance.normal(0.0, 3.0, 2)
    singles = [
        Single(FF, axis, float(fix_m[axis]), 1.0, physics.FIX_NOISE._replace(outliers=0.0)) for axis in (0, 1)
    ]
    table = table_of(graph.starts, singles, np.empty((0, FIELDS)))
    pick = np.zeros((2, graph.size))
    pick[[0, 1], np.arange(2) + graph.rows(FF).start] = 1.0
    off_m = fix_m - pick @ graph.reference
    plain = graph.reference + np.linalg.solve(graph.information + pick.T @ pick, pick.T @ off_m)
    taken_in(graph, table)
    assert graph.reference == pytest.approx(plain, abs=1e-6)
