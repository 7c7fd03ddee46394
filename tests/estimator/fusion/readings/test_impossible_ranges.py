"""Ranges that no radio can have measured: a gateway tells millimetres, and nobody's place pays for it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.entering.introduce import introduce
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.impossible_ranges import FAR_M, TIMES, UNHEARD_OF_M, is_impossible
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.trackers.entry import BASE, off_m, shown

SECONDS = 60
CORNERS = {"a1": (-22.0, -20.0), "a2": (21.0, -22.0), "a3": (20.0, 21.0), "a4": (-21.0, 19.0)}


def among_four(times: dict[str, float], unit: bool) -> tuple[list[AnyReading], list[Array]]:
    """He goes round among four anchors; the ranges of some are told so many times too large."""
    chance, at, way = np.random.default_rng(3), np.zeros(2), [np.zeros(2)]
    readings: list[AnyReading] = [BASE, Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))]
    for name, (east, north) in CORNERS.items():
        readings.append(Node(t=0.0, node=name, role="anchor", position_m=(east, north, 0.0), sigma_m=0.1))
    for second in range(1, SECONDS + 1):
        step_m = np.array([math.cos(0.1 * second), math.sin(0.1 * second)])
        at = at + step_m
        way.append(at)
        east, north = (step_m + chance.normal(0.0, 0.03, 2)).tolist()
        if unit:
            readings.append(Displacement(t=float(second), node="ff1", delta_m=(east, north, 0.0)))
        for name, place in CORNERS.items():
            range_m = (math.dist(at, place) + float(chance.normal(0.0, 0.1))) * times.get(name, 1.0)
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
    return readings, way


@pytest.mark.parametrize("unit", [True, False])
@pytest.mark.parametrize("times", [1000.0, 100.0])
def test_one_gateway_that_tells_millimetres_or_centimetres_moves_nobody(times: float, unit: bool) -> None:
    readings, way = among_four({"a1": times}, unit)
    tracker, said = KirchhoffTracker(), list[str]()
    for second in range(SECONDS + 1):
        tracker.fold([r for r in readings if r.t == second])
        said += [notice.text for notice in tracker.take_notices()]
        found = shown(tracker, "ff1")
        if second > 3:
            assert off_m(found, way[second]) < 2.0
    assert [text for text in said if "set aside" in text and "a1" in text] == said
    assert len(said) == 1


def test_where_all_ranges_are_in_millimetres_the_unit_leads_and_the_smoothed_way_is_right() -> None:
    readings, way = among_four(dict.fromkeys(CORNERS, 1000.0), unit=True)
    for p in BatchSmoother().smooth(readings)["ff1"]:
        assert outside(p.position_m, p.covariance_m2, way[round(p.t)]) < SURE


def known(east_m: float, sigma_m: float) -> tuple[FusionState, NodeState, NodeState]:
    """The base, and a breadcrumb that lies so far off, so surely."""
    state = FusionState()
    lies = Node(t=0.0, node="b1", role="breadcrumb", position_m=(east_m, 0.0, 0.0), sigma_m=sigma_m)
    for reading in (BASE, lies):
        introduce(state, reading)
    return state, state.nodes[BASE.node], state.nodes["b1"]


def says(range_m: float) -> Range:
    return Range(t=1.0, a=BASE.node, b="b1", range_m=range_m, technology="uwb")


@given(st.floats(0.1, 2000.0), st.floats(0.0, 3.0))
def test_what_walls_and_echoes_make_too_long_is_never_set_aside(apart_m: float, times: float) -> None:
    state, base, crumb = known(apart_m, 0.3)
    assert not is_impossible(state, says(apart_m * (1.0 + times) + 60.0), base, crumb, state.graph.covariance)


def test_a_range_is_held_against_how_surely_both_lie_where_they_are() -> None:
    state, base, crumb = known(5.0, 0.3)
    far_m = FAR_M + TIMES * 50.0
    assert is_impossible(state, says(far_m), base, crumb, state.graph.covariance)
    assert len(state.notices) == 1
    state, base, crumb = known(5.0, 100.0)
    assert not is_impossible(state, says(far_m), base, crumb, state.graph.covariance)


def test_to_a_node_of_which_nothing_is_known_any_range_of_a_radio_is_possible() -> None:
    state = FusionState()
    base, unknown = (state.node_of(name, "breadcrumb", 0.0) for name in ("b1", "b2"))
    assert not is_impossible(state, says(0.9 * UNHEARD_OF_M), base, unknown, state.graph.covariance)
    assert is_impossible(state, says(1.1 * UNHEARD_OF_M), base, unknown, state.graph.covariance)
