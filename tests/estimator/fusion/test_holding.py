"""What is held against the graph, and when; a fix is as old as the newest reading that tells of its place."""

import pytest

from estimator.estimate import NodeEstimate
from estimator.fusion import physics
from estimator.fusion.holding import parts_of
from estimator.fusion.memory.ledger import Ledger
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.recent_places import offset_of
from estimator.fusion.tick import fold_tick
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.bearing import Bearing
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.trackers.kirchhoff import KirchhoffTracker

SILENT_SINCE, NOW = 20.0, 80.0
NAMED = Node(t=NOW, node="ff1", role="responder", callsign="E7-9", crew="E7")

TELL_NOTHING: list[AnyReading] = [
    NAMED,
    Position(t=NOW, node="ff1", wgs84=(48.1, 11.5, 520.0)),
    Pressure(t=NOW, node="ff1", pressure_pa=101_000.0),
    Altitude(t=NOW, node="ff1", up_m=0.0),
    Rssi(t=NOW, a="ff1", b="unplaced", dbm=-60.0),
    Range(t=NOW, a="ff1", b="unplaced", range_m=7.0),
    Bearing(t=NOW, a="ff1", b="unplaced", bearing_rad=0.1),
]
TELL: list[AnyReading] = [
    Displacement(t=NOW, node="ff1", delta_m=(1.0, 0.0, 0.0)),
    Position(t=NOW, node="ff1", position_m=(10.0, 0.0, 0.0)),
    Rssi(t=NOW, a="ff1", b="base", dbm=-60.0),
    Range(t=NOW, a="base", b="ff1", range_m=10.0),
    Drop(t=NOW, node="b1", by="ff1"),
]


def after(reading: AnyReading) -> NodeEstimate:
    """A responder who has walked for 20 s, was silent for a minute, and is then named in a reading."""
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=0.0, node="base", role="base"), Node(t=0.0, node="ff1", role="responder")])
    steps = [Displacement(t=float(t), node="ff1", delta_m=(0.5, 0.0, 0.0)) for t in range(1, 21)]
    tracker.fold([*steps, reading])
    return next(estimate for estimate in tracker.estimates() if estimate.node == "ff1")


@pytest.mark.parametrize("reading", TELL_NOTHING, ids=lambda reading: type(reading).__name__)
def test_what_says_nothing_of_a_place_leaves_the_fix_as_old_as_it_was(reading: AnyReading) -> None:
    """Who was lost would be shown as found again, where he was last heard of."""
    assert after(reading).t == SILENT_SINCE


def test_an_altimeter_tells_of_a_place_once_it_is_zeroed() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=0.0, node="base", role="base"), Node(t=0.0, node="ff1", role="responder")])
    tracker.fold([Displacement(t=float(t), node="ff1", delta_m=(0.5, 0.0, 0.0)) for t in range(1, 21)])
    tracker.fold([Altitude(t=float(t), node="ff1", up_m=0.0) for t in (*range(1, 7), NOW)])
    assert next(estimate for estimate in tracker.estimates() if estimate.node == "ff1").t == NOW


@pytest.mark.parametrize("reading", TELL, ids=lambda reading: type(reading).__name__)
def test_what_tells_of_a_place_makes_the_fix_new(reading: AnyReading) -> None:
    assert after(reading).t == NOW


def walking(*more: AnyReading) -> FusionState:
    """A responder who walks away from the base, a step a second for ten seconds; and what is heard."""
    state = FusionState()
    fold_tick(state, 0.5, [Node(t=0.0, node="base", role="base"), Node(t=0.0, node="ff1", role="responder")])
    for second in range(1, 11):
        step = Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0))
        fold_tick(state, float(second), [step])
    for reading in more:
        fold_tick(state, reading.t, [reading])
    return state


def range_at(t: float) -> Range:
    return Range(t=t, a="ff1", b="base", range_m=t, technology="uwb")


def test_a_range_waits_for_the_displacement_that_covers_its_epoch() -> None:
    early = range_at(10.4)
    state = walking(early)
    assert list(state.waiting) == [early]
    fold_tick(state, 11.0, [Displacement(t=11.0, from_t=10.0, node="ff1", delta_m=(1.0, 0.0, 0.0))])
    assert not state.waiting
    assert state.counts["fused"] == walking().counts["fused"] + 2


def test_nothing_waits_for_a_unit_that_has_fallen_silent() -> None:
    state = walking(range_at(10.4))
    fold_tick(state, 10.4 + physics.PENDING_S + 0.1, [])
    assert not state.waiting


def test_what_is_heard_of_who_has_no_unit_is_held_by_quarters_of_a_second() -> None:
    """Nothing tells how he moves between them; the ways of others are known."""
    state = walking(Node(t=10.0, node="ff2", role="responder"))
    of_the_unit = [range_at(9.1), range_at(9.9)]
    of_the_other = [Range(t=t, a="ff2", b="base", range_m=5.0, technology="uwb") for t in (9.1, 9.2, 9.3)]
    held = parts_of(state, sorted([*of_the_unit, *of_the_other], key=lambda reading: reading.t))
    assert held == [of_the_unit, of_the_other[:2], of_the_other[2:]]


@pytest.mark.parametrize("period_s", [1, 3, 6, 10])
def test_what_is_heard_between_two_reports_of_a_unit_waits_for_the_second_one(period_s: int) -> None:
    """Held before, it would have its bearer stand about, and of the report only what is left would count."""
    state = FusionState()
    begins = [
        Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1),
    ]
    fold_tick(state, 0.5, begins)
    was_m = 0.0
    for second in range(1, 6 * period_s + 1):
        t = float(second)
        heard: list[AnyReading] = [Rssi(t=t - 0.5, a="ff1", b="base", dbm=-70.0)]
        if second % period_s == 0:
            way_m = (float(period_s), 0.0, 0.0)
            heard.append(Displacement(t=t, from_t=t - period_s, node="ff1", delta_m=way_m))
        fold_tick(state, t, heard)
        if second == period_s:
            was_m = float(state.graph.value(state.nodes["ff1"].position)[0])
    gone_m = float(state.graph.value(state.nodes["ff1"].position)[0]) - was_m
    assert gone_m == pytest.approx(5.0 * period_s, rel=0.15)


def test_what_waits_for_a_unit_that_fell_silent_is_held_at_last() -> None:
    state = FusionState()
    state.ledger = Ledger(complete=True)
    begins = [
        Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1),
    ]
    fold_tick(state, 0.5, begins)
    fold_tick(state, 6.0, [Displacement(t=6.0, from_t=0.0, node="ff1", delta_m=(6.0, 0.0, 0.0))])
    for second in range(7, 20):
        fold_tick(state, float(second), [Range(t=float(second), a="ff1", b="base", range_m=6.0)])
    waits_s = physics.REPORT_LATE * 6.0
    assert [reading.t for reading in state.waiting] == [t for t in range(7, 20) if t > 19.0 - waits_s]
    assert len(state.ledger.table("pairs")) == 13 - len(state.waiting)


def test_ways_are_remembered_for_as_long_as_readings_wait_for_anybody() -> None:
    """A range between two of a crew is held when the slower unit reports: where was the other one then?"""
    state = FusionState()
    begins = [
        Node(t=0.0, node=name, role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1)
        for name in ("ff1", "ff2")
    ]
    fold_tick(state, 0.5, [Node(t=0.0, node="base", role="base"), *begins])
    for second in range(1, 31):
        t = float(second)
        told: list[AnyReading] = [
            Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0)),
        ]
        if second % 15 == 0:
            told.append(Displacement(t=t, from_t=t - 15.0, node="ff2", delta_m=(15.0, 0.0, 0.0)))
        fold_tick(state, t, told)
    assert state.nodes["ff1"].trail[0][0] <= 15.0
    assert offset_of(state, state.nodes["ff1"], 16.0)[0] == pytest.approx(-14.0, abs=0.1)
