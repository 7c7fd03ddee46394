"""Which ranges and powers lose what on their way through a building."""

import math

import numpy as np

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.losses import EVERYONE, STEP_S, going_on, loss_column, parts_of
from tests.estimator.smoothing.windows import fused, problem_of

UNTIL = 150
UNITS, LOOSE = ("ff1", "ff2"), "ff3"
"""Two of a crew who wear units, and one of it who does not."""
ENTERED_M = {"ff1": 2.0, "ff2": 3.0, "ff3": 4.0}
"""How far north."""


def incident(crews: tuple[str | None, ...] = ("E7", "E7", "E7"), ranged: bool = False) -> list[AnyReading]:
    """All hear the base, a vehicle, a breadcrumb and the first of them, each second.

    Those who wear units may range the vehicle as well.
    """
    readings: list[AnyReading] = [Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))]
    readings.append(Node(t=0.0, node="engine", role="anchor", position_m=(9.0, 9.0, 0.0), sigma_m=0.1))
    for node, crew in zip((*UNITS, LOOSE), crews, strict=True):
        place = (1.0, ENTERED_M[node], 0.0)
        readings.append(
            Node(t=0.0, node=node, role="responder", crew=crew, position_m=place, heading_sigma_rad=0.1)
        )
    readings.append(Drop(t=2.0, node="b1", by="ff1"))
    for t in range(1, UNTIL + 1):
        for node in (*UNITS, LOOSE):
            if node in UNITS:
                move = Displacement(t=float(t), from_t=t - 1.0, node=node, delta_m=(0.1, 0.0, 0.0))
                readings.append(move)
                range_m = math.dist((1.0 + 0.1 * t, ENTERED_M[node]), (9.0, 9.0))
                told = Range(t=float(t), a=node, b="engine", range_m=range_m, technology="uwb")
                readings += [told] if ranged else []
            heard = [other for other in ("base", "engine", "b1", "ff1") if other != node]
            readings += [Rssi(t=float(t), a=node, b=other, dbm=-60.0) for other in heard]
    return readings


def layout_of(crews: tuple[str | None, ...] = ("E7", "E7", "E7"), ranged: bool = False) -> Layout:
    return problem_of(fused(incident(crews, ranged))).layout


def names(layout: Layout) -> set[tuple[str, str]]:
    """Whose powers lose something of their own on the way to whom."""
    owners, found = layout.state.owners, set()
    for _, number in layout.lost:
        _, leader, radio, _ = parts_of(number)
        found.add((owners[leader], "everyone" if radio == EVERYONE else owners[radio]))
    return found


def test_a_crew_loses_to_each_anchor_and_to_all_of_them() -> None:
    assert names(layout_of()) == {("ff1", "engine"), ("ff1", "everyone")}


def test_each_crew_has_losses_of_its_own() -> None:
    layout = layout_of(("E7", "L3", "E7"))
    assert {leader for leader, _ in names(layout)} == set(UNITS)


def test_those_whose_crew_nobody_has_told_are_one() -> None:
    assert {leader for leader, _ in names(layout_of((None, None, None)))} == {"ff1"}


def test_there_is_one_for_each_minute_that_follows_the_one_before() -> None:
    layout = layout_of()
    for _, number in layout.lost:
        assert parts_of(number)[3] % STEP_S == 0.0
    firsts = [one for one in layout.lost.values() if one.before is None]
    assert len(layout.lost) == 6
    assert len(firsts) == 2
    for one in layout.lost.values():
        if one.before is not None:
            assert layout.lost[one.before].since_s == one.since_s - STEP_S


def test_powers_of_who_wears_no_unit_and_those_that_no_anchor_hears_lose_nothing() -> None:
    layout = layout_of()
    owners = layout.state.owners
    for pair in layout.state.ledger.table("pairs"):
        a, b = (owners[int(number)] for number in pair[2:4])
        lossy = {a, b} in ({"engine", unit} for unit in UNITS)
        assert (loss_column(layout.losses, pair) >= 0) == lossy


def test_both_of_a_crew_lose_the_same_on_the_way_to_a_vehicle() -> None:
    layout = layout_of()
    state = layout.state
    numbers = {name: state.nodes[name].index for name in ("ff1", "ff2", "engine")}
    found = set()
    for pair in state.ledger.table("pairs"):
        ends = {int(pair[2]), int(pair[3])}
        if numbers["engine"] in ends and ends & {numbers["ff1"], numbers["ff2"]} and pair[0] < STEP_S:
            found.add(int(loss_column(layout.losses, pair)))
    assert len(found) == 1


def test_after_a_cut_the_newest_losses_go_on_and_what_others_are_counted_from() -> None:
    lost = layout_of().lost
    kept = going_on(lost, 2.0 * STEP_S + 1.0)
    assert {lost[key].since_s for key in kept} == {2.0 * STEP_S}
    everything = going_on(lost, 0.0)
    assert everything == list(lost)
    assert going_on(lost, 1e6) == []
    assert np.all([lost[key].common in kept for key in kept if lost[key].common is not None])


def test_ranges_and_powers_of_a_crew_lose_apart_from_each_other() -> None:
    layout = layout_of(ranged=True)
    columns: dict[int, set[int]] = {RANGE: set(), RSSI: set()}
    for pair in layout.state.ledger.table("pairs"):
        if (column := int(loss_column(layout.losses, pair))) >= 0:
            columns[int(pair[1])].add(column)
    ranges, powers = columns.values()
    assert len(ranges) == len(powers) == 3
    assert not ranges & powers
    for (_, number), loss in layout.lost.items():
        kind, _, radio, _ = parts_of(number)
        assert kind == loss.kind
        assert radio == EVERYONE or (loss.column in ranges) == (kind == RANGE)
        for other in (loss.before, loss.common):
            assert other is None or layout.lost[other].kind == kind
