"""Readings between two nodes, as rows for the ledger and for the graph."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.introduce import attach_unit, introduce
from estimator.fusion.learned.noise import LearnedNoise, link_sigma
from estimator.fusion.memory.ledger import BEARING, BODY_BEARING, COLUMNS, RANGE, RSSI
from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.pairs import AnyPair, Pairs
from estimator.fusion.rows import rows
from estimator.graph.dense import Array
from estimator.measurements.bearing import Bearing
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi

T = 10.0


def crew() -> FusionState:
    """A base, a breadcrumb, a responder with a unit, a UAV without, and one that nobody has placed."""
    state = FusionState()
    introduce(state, Node(t=0.0, node="base", role="base", position_m=(1.0, 2.0, 0.5)))
    introduce(state, Node(t=0.0, node="crumb", role="breadcrumb", position_m=(5.0, 0.0, 0.0)))
    introduce(state, Node(t=0.0, node="up", role="breadcrumb", position_m=(5.0, 0.0, 4.0)))
    introduce(state, Node(t=0.0, node="lost", role="breadcrumb"))
    introduce(state, Node(t=0.0, node="ff", role="responder", position_m=(0.0, 0.0, 0.0)))
    introduce(state, Node(t=0.0, node="uav", role="uav", position_m=(0.0, 0.0, 0.0)))
    attach_unit(state, state.nodes["ff"], None)
    trail = ((T - 2.0, 0.0, 0.0, 0.0), (T, 2.0, 0.0, 0.5))
    state.nodes["ff"] = replace(state.nodes["ff"], pose_t=T, trail=trail, unit_heading_rad=0.3, way_m=7.0)
    state.nodes["uav"] = replace(state.nodes["uav"], pose_t=T)
    x = state.graph.reference.copy()
    x[state.graph.starts[state.nodes["ff"].unit]] = 0.5 * math.pi
    x[state.graph.starts[state.nodes["uav"].velocity]] = 3.0
    state.graph.rebase(x)
    return state


def held(state: FusionState, *readings: AnyPair) -> Array:
    pairs = Pairs(state)
    pairs.take(readings)
    return pairs.enter()


def column(state: FusionState, name: str) -> list[float]:
    found: list[float] = state.ledger.table("pairs")[:, COLUMNS["pairs"].index(name)].tolist()
    return found


def test_ends_are_where_they_stood_at_the_readings_epoch() -> None:
    state = crew()
    first, second = held(
        state,
        Rssi(t=T - 1.0, a="ff", b="base", dbm=-60.0),
        Rssi(t=T - 1.0, a="crumb", b="uav", dbm=-60.0),
    )
    starts = state.graph.starts
    assert first[rows.A] == starts[state.nodes["ff"].position]
    assert first[rows.B] == -1.0
    assert first[rows.A_E : rows.A_E + 3] == pytest.approx([0.0, -1.0, -0.25])
    assert first[rows.B_E : rows.B_E + 3] == pytest.approx([1.0, 2.0, 0.5])
    assert second[rows.A_E : rows.A_E + 3] == pytest.approx([0.0, 0.0, 0.0])
    assert second[rows.B_E : rows.B_E + 3] == pytest.approx([-3.0, 0.0, 0.0])


def test_rows_of_one_kind_come_together_and_the_ledger_keeps_the_order_of_epochs() -> None:
    state = crew()
    state.noise["uwb"] = LearnedNoise(20.0, 40.0, 20.0, 20.0)
    readings = (
        Bearing(t=T, a="ff", b="crumb", bearing_rad=0.2, frame="body"),
        Rssi(t=T, a="ff", b="crumb", dbm=-60.0, tx_dbm=4.0),
        Range(t=T, a="ff", b="crumb", range_m=4.0, technology="uwb", sigma_m=0.2),
        Bearing(t=T, a="ff", b="crumb", bearing_rad=0.4),
        Range(t=T, a="crumb", b="ff", range_m=4.5, technology="uwb"),
    )
    before = state.counts["fused"]
    table = held(state, *readings)
    assert state.counts["fused"] == before + 5
    assert column(state, "kind") == [BODY_BEARING, RSSI, RANGE, BEARING, RANGE]
    assert column(state, "constant") == [0.3, 4.0, 0.0, 0.0, 0.0]
    assert column(state, "link") == [-1.0, 0.0, 1.0, -1.0, 1.0]
    assert column(state, "alike") == [1.0, 1.0, 1.0, 1.0, 2.0]
    assert table[:, rows.KIND].tolist() == [RANGE, RANGE, RSSI, BEARING, BEARING]
    assert table[:, rows.VALUE].tolist() == [4.0, 4.5, -60.0, 0.2, 0.4]
    assert table[:, rows.NOMINAL].tolist() == [0.2, 0.3, physics.RSSI_SIGMA_DB, 0.2, 0.2]
    factor, shared = state.learned("uwb").factor, state.learned("uwb").shared
    expected = [
        link_sigma(factor, shared, 0.2, 1.0, 0.0, 0.0),
        link_sigma(factor, shared, 0.3, 2.0, 0.0, 0.0),
    ]
    assert table[:2, rows.SIGMA] == pytest.approx(expected)
    assert table[3:, rows.EXTRA].tolist() == [state.graph.starts[state.nodes["ff"].unit], -1.0]


def test_what_walls_add_is_taken_off_a_range_which_counts_for_less_but_not_through_a_floor() -> None:
    state = crew()
    first, above = held(
        state,
        Range(t=T, a="ff", b="crumb", range_m=6.0, technology="uwb", sigma_m=0.2),
        Range(t=T, a="ff", b="up", range_m=6.0, technology="uwb", sigma_m=0.2),
    )
    state.links.tell_walls(np.arange(2), np.full(2, 0.5), np.full(2, 0.25), np.full(2, 0.09))
    second, above_again = held(
        state,
        Range(t=T, a="ff", b="crumb", range_m=6.0, technology="uwb", sigma_m=0.2),
        Range(t=T, a="ff", b="up", range_m=6.1, technology="uwb", sigma_m=0.2),
    )
    known = state.learned("uwb")
    alone, walled = (
        link_sigma(known.factor, known.shared, 0.2, 2.0, *more) for more in ((0.0, 0.0), (0.25, 0.09))
    )
    assert (first[rows.VALUE], second[rows.VALUE]) == (6.0, 5.5)
    assert walled > alone
    assert second[rows.SIGMA] == pytest.approx(walled)
    assert (above[rows.VALUE], above_again[rows.VALUE]) == (6.0, 6.1)
    assert column(state, "value") == [6.0, 6.0, 6.0, 6.1]


def test_a_floor_between_adds_noise_and_tells_nothing_of_the_technology() -> None:
    state = crew()
    here, above, outside = held(
        state,
        Rssi(t=T, a="ff", b="crumb", dbm=-60.0),
        Rssi(t=T, a="ff", b="up", dbm=-60.0),
        Rssi(t=T, a="uav", b="up", dbm=-60.0),
    )
    assert here[rows.SOURCE] == outside[rows.SOURCE] == state.source("rssi ")
    assert above[rows.SOURCE] == above[rows.LINK] == -1.0
    assert above[rows.SIGMA] == pytest.approx(np.hypot(here[rows.SIGMA], physics.FLOOR_SIGMA[1]))
    assert column(state, "link") == [0.0, 1.0, 2.0]


def test_readings_to_an_undecided_node_are_only_entered() -> None:
    state = crew()
    table = held(
        state,
        Range(t=T, a="ff", b="lost", range_m=4.0),
        Range(t=T, a="ff", b="new", range_m=4.0),
        Range(t=T, a="lost", b="new", range_m=4.0),
        Range(t=T, a="base", b="base2", range_m=4.0),
    )
    assert len(table) == 0
    assert len(state.ledger.table("pairs")) == 3
    assert state.sightings == {"lost": 1, "new": 1, "base2": 1}
    assert state.counts["not_fused"] == 1


def test_a_range_that_jumps_farther_than_anybody_runs_is_held_and_entered_as_an_echo() -> None:
    state = crew()
    ranges_m = (6.0, 6.1, 26.1, 26.2, 6.2)
    ranges = (
        Range(t=T + 0.1 * i, a="ff", b="base", range_m=range_m, sigma_m=0.1, technology="uwb")
        for i, range_m in enumerate(ranges_m)
    )
    table = held(state, *ranges)
    assert column(state, "echo") == pytest.approx([0.0, 0.0, 20.0, 20.0, 0.0])
    assert table[2:4, rows.SHIFT] == pytest.approx([20.0, 20.0])
    assert (table[[0, 1, 4], rows.SHIFT] == physics.RANGE_NOISE.shift).all()
    assert (table[:, rows.OUTLIERS] == physics.ECHOES).tolist() == [False, False, True, True, False]
