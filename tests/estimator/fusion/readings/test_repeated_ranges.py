"""Ranges that a driver hands out again, though its radio measures nothing any more."""

import numpy as np

from estimator.fusion.learned.link_correlation import Links
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.readings.repeated_ranges import COARSE, REPEATED, is_repeated
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE
from tests.estimator.trackers.entry import BASE, shown, squared_error

RADIO = NodeState(node="b1", role="breadcrumb", mode="static", t=0.0)
SECONDS, FALLS_SILENT_S = 90, 30


def walker(way_m: float) -> NodeState:
    return NodeState(node="ff1", role="responder", mode="unit", t=0.0, way_m=way_m)


def told(
    links: Links, values_m: list[float], *, pace_mps: float, radio: NodeState = RADIO, each_s: float = 1.0
) -> list[bool]:
    """Which of the ranges from a walker to a radio are only told again."""
    link = links.number("uwb", "ff1", radio.node)
    return [
        is_repeated(links, link, each_s * k, value, walker(pace_mps * each_s * k), radio)
        for k, value in enumerate(values_m)
    ]


def test_who_has_walked_on_is_not_as_far_to_the_last_digit() -> None:
    found = told(Links(), [7.312] * 6 + [8.105], pace_mps=0.8)
    assert found == [False] * (REPEATED - 1) + [True] * (7 - REPEATED) + [False]


def test_who_stands_may_be() -> None:
    assert not any(told(Links(), [7.312] * 9, pace_mps=0.0))


def test_unless_his_other_ranges_change() -> None:
    links, other = Links(), NodeState(node="b2", role="breadcrumb", mode="static", t=0.0)
    told(links, [3.11, 3.25, 3.18], pace_mps=0.0, radio=other)
    assert any(told(links, [7.312] * REPEATED, pace_mps=0.0))


def test_coarse_ranges_are_alike_more_often() -> None:
    found = told(Links(), [7.3] * COARSE, pace_mps=0.8)
    assert found == [False] * (COARSE - 1) + [True]


def test_ten_a_second_agree_by_chance_for_a_moment() -> None:
    found = told(Links(), [7.1, *[7.312] * 40], pace_mps=0.8, each_s=0.1)
    assert not any(found[:15])
    assert found[-1]


def incident(seed: int) -> tuple[list[AnyReading], Array]:
    """He walks away from radios that were dropped at the door: the drivers go on with what was read last."""
    chance = np.random.default_rng(seed)
    radios = {"a1": np.array([0.0, 6.0]), "a2": np.array([8.0, -5.0])}
    readings: list[AnyReading] = [
        BASE,
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3),
    ]
    for name, (east, north) in radios.items():
        readings.append(Node(t=0.0, node=name, role="anchor", position_m=(float(east), float(north), 0.0)))
    at, newest = np.zeros(2), dict.fromkeys(radios, 0.0)
    for second in range(1, SECONDS + 1):
        step_m = np.array([0.8, 0.1])
        at = at + step_m
        east, north = (step_m + chance.normal(0.0, 0.03, 2)).tolist()
        t = float(second)
        readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(east, north, 0.0)))
        for name, place in radios.items():
            if second <= FALLS_SILENT_S:
                newest[name] = round(float(np.hypot(*(at - place)) + chance.normal(0.0, 0.1)), 3)
            readings.append(Range(t=t, a="ff1", b=name, range_m=newest[name], technology="uwb"))
    return readings, at


def test_nobody_is_held_back_by_what_radios_out_of_reach_have_measured_last() -> None:
    for seed in (710, 711):
        readings, at = incident(seed)
        tracker = KirchhoffTracker()
        tracker.fold(readings)
        assert squared_error(shown(tracker), at) < SURE
        assert tracker.counts()["not_fused"] > SECONDS - FALLS_SILENT_S
