"""Breadcrumbs that lie elsewhere than they did, and links that have changed for good."""

import dataclasses
import itertools
import math
from functools import cache

import numpy as np
import pytest

from estimator.estimate import NodeEstimate, Notice
from estimator.fusion.memory.ledger import COLUMNS, RANGE
from estimator.fusion.memory.state import FusionState
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.simulate import Scenario, scenario
from estimator.smoothing.changes.moved_nodes import by_node
from estimator.smoothing.changes.relocation import READINGS_MIN
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from estimator.trackers.lag import Lag

AGAIN_M = 15.0
"""A breadcrumb's place is told by who comes so near: farther away 4 m are within the noise of its signal."""


def followed(shown: Scenario, until_s: float) -> tuple[list[Notice], dict[str, list[NodeEstimate]]]:
    """Notices and each second's estimates of the walkers, from what has been measured up to then."""
    readings = sorted((r for r in shown.readings if r.t <= until_s), key=lambda r: r.t)
    tracker = KirchhoffTracker()
    notices: list[Notice] = []
    tracks: dict[str, list[NodeEstimate]] = {}
    start = 0
    for second in range(1, math.ceil(until_s) + 1):
        end = start
        while end < len(readings) and readings[end].t <= second:
            end += 1
        tracker.fold(readings[start:end])
        notices += tracker.take_notices()
        for estimate in tracker.estimates():
            tracks.setdefault(estimate.node, []).append(estimate)
        start = end
    return notices, tracks


def off_m(shown: Scenario, track: list[NodeEstimate], name: str) -> dict[float, float]:
    """How far a walker's estimates are from the truth, by their epoch (m)."""
    return {
        e.t: float(np.hypot(*(np.array(e.position_m) - shown.truth[name].at(np.array([e.t]))[0])[:2]))
        for e in track
        if e.position_m is not None and e.t > 170.0
    }


@cache  # the same walks are asked when the kick is noticed, and what it costs
def past_a_kick(seed: int) -> tuple[Scenario, list[Notice], dict[str, list[NodeEstimate]]]:
    """A scenario in which a breadcrumb is kicked, until it has been met again, and what is told of it."""
    shown = scenario("kicked-breadcrumb", seed)
    return shown, *followed(shown, 280.0)


@pytest.mark.parametrize("seed", [*range(6), 9, 17])
def test_a_kicked_breadcrumb_is_noticed_within_30_s_of_coming_near_again(seed: int) -> None:
    shown, notices, _ = past_a_kick(seed)
    told = [n.t for n in notices if n.code == "node_moved"]
    assert [n.node for n in notices if n.code == "node_moved"] == ["b3"]
    epochs = np.arange(181.0, 281.0)
    walkers = [shown.truth[name].at(epochs) for name in ("ff1", "ff2")]
    near = np.min([np.linalg.norm(w - shown.truth["b3"].at(epochs), axis=1) for w in walkers], axis=0)
    again = float(epochs[np.argmax(near < AGAIN_M)])
    assert told[0] <= again + 30.0


@pytest.mark.parametrize("seed", [11, 16])
def test_five_ranges_to_a_kicked_breadcrumb_are_enough_that_bend_the_way_of_who_passes(seed: int) -> None:
    """They miss little themselves, and cost all others little: both together are clear."""
    shown = scenario("kicked-breadcrumb", seed)
    notices, _ = followed(shown, 260.0)
    told = next(n.t for n in notices if n.code == "node_moved")
    ranges = [r for r in shown.readings if isinstance(r, Range) and "b3" in (r.a, r.b) and r.t > 200.0]
    assert sum(r.t <= told for r in ranges) == READINGS_MIN


@pytest.mark.parametrize("seed", [0, 1, 18])
def test_a_kicked_breadcrumb_costs_its_neighbours_no_more_than_a_metre(seed: int) -> None:
    """What it costs is held against the same walk whose breadcrumb falls silent instead."""
    shown, _, tracks = past_a_kick(seed)
    kept = [
        report
        for report in shown.reports
        if report.reading.t < 180.0
        or "b3" not in (getattr(report.reading, "a", ""), getattr(report.reading, "b", ""))
    ]
    _, without = followed(dataclasses.replace(shown, reports=tuple(kept)), 280.0)
    for name in ("ff1", "ff2"):
        kicked, silent = off_m(shown, tracks[name], name), off_m(shown, without[name], name)
        assert max(kicked[t] - silent[t] for t in kicked if t in silent) <= 1.0


@pytest.mark.parametrize("seed", [4, 5])
def test_the_first_ranges_to_a_kicked_breadcrumb_are_of_its_new_place(seed: int) -> None:
    """Those that bent the way of who passed would go on bending it."""
    shown = scenario("kicked-breadcrumb", seed)
    lag = Lag(TrackerSettings().lag_s, FusionState())
    lag.add([r.reading for r in sorted(shown.reports, key=lambda r: r.reading.t) if r.reading.t <= 250.0])
    state = lag.state()
    pairs, new = state.ledger.table("pairs"), state.nodes["b3"].index
    old = state.owners.index("b3")
    near = pairs[(pairs[:, 1] == RANGE) & (pairs[:, 0] > 235.0)]
    assert new != old
    assert (near[:, 2:4] == new).any(axis=1).sum() >= READINGS_MIN
    assert not (near[:, 2:4] == old).any()


def test_the_kicked_breadcrumb_is_then_shown_where_it_lies() -> None:
    shown = scenario("kicked-breadcrumb", 1)
    _, tracks = followed(shown, 300.0)
    place = tracks["b3"][-1].position_m
    assert place is not None
    kicked = shown.truth["b3"].position_m[-1] - shown.truth["b2"].position_m[-1]
    other = tracks["b2"][-1].position_m
    assert other is not None
    assert np.hypot(*(np.array(place) - np.array(other) - kicked)[:2]) < 2.5


def along(points_m: list[tuple[float, float]], lies_m: tuple[float, float], t: float) -> list[AnyReading]:
    """A walker's displacements and fixes from one point to the next, 1 m/s, and its ranges to "b1"."""
    found: list[AnyReading] = []
    chance = np.random.default_rng(int(t))
    for (from_e, from_n), (to_e, to_n) in itertools.pairwise(points_m):
        seconds = round(math.hypot(to_e - from_e, to_n - from_n))
        step = ((to_e - from_e) / seconds, (to_n - from_n) / seconds, 0.0)
        for second in range(1, seconds + 1):
            t += 1.0
            e, n = from_e + second * step[0], from_n + second * step[1]
            found.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=step))
            found.append(Position(t=t, node="ff1", position_m=(e, n, 0.0), sigma_m=(0.3, 0.3, 0.3)))
            far = math.hypot(e - lies_m[0], n - lies_m[1]) + float(chance.normal(0.0, 0.1))
            found.append(Range(t=t, a="ff1", b="b1", range_m=max(far, 0.0), technology="uwb", sigma_m=0.1))
    return found


def test_a_breadcrumb_kicked_beside_a_straight_way_is_shown_nowhere_until_its_side_is_known() -> None:
    """From a straight way two places explain the same ranges: a guess may be a wrong dot."""
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=0.0, node="base", role="base"), Node(t=0.0, node="ff1", role="responder")])
    tracker.fold([Node(t=0.0, node="b1", role="breadcrumb", position_m=(4.0, 10.0, 0.0), sigma_m=0.3)])
    tracker.fold(along([(0.0, 0.0), (0.0, 20.0), (0.0, 0.0)], (4.0, 10.0), 0.0))
    tracker.fold(along([(0.0, 0.0), (0.0, 20.0)], (9.0, 10.0), 40.0))
    assert [n.node for n in tracker.take_notices() if n.code == "node_moved"] == ["b1"]
    assert {e.node: e.position_m for e in tracker.estimates()}["b1"] is None
    tracker.fold(along([(0.0, 20.0), (20.0, 20.0), (20.0, 10.0)], (9.0, 10.0), 60.0))
    place = {e.node: e.position_m for e in tracker.estimates()}["b1"]
    assert place is not None
    assert np.hypot(place[0] - 9.0, place[1] - 10.0) < 0.5


def test_signals_from_afar_do_not_drown_the_ranges_of_who_passes_a_kicked_breadcrumb() -> None:
    chance = np.random.default_rng(1)
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=0.0, node="base", role="base", position_m=(-20.0, 10.0, 0.0))])
    tracker.fold([Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3)])
    tracker.fold([Node(t=0.0, node="b1", role="breadcrumb", position_m=(4.0, 10.0, 0.0), sigma_m=0.3)])
    walked = along([(0.0, 0.0), (0.0, 20.0), (0.0, 0.0)], (4.0, 10.0), 0.0)
    walked += along([(0.0, 0.0), (0.0, 20.0), (10.0, 20.0)], (9.0, 10.0), 40.0)
    heard = np.arange(1.0, 70.0, 0.05)
    dbm = -40.0 - 22.0 * np.log10(26.0) + chance.normal(0.0, 5.0, len(heard))
    signals = [
        Rssi(t=t, a="base", b="b1", dbm=power) for t, power in zip(heard.tolist(), dbm.tolist(), strict=True)
    ]
    told: list[Notice] = []
    for second in range(1, 71):
        tracker.fold([r for r in (*walked, *signals) if second - 1.0 < r.t <= second])
        told += tracker.take_notices()
    assert [n.node for n in told if n.code == "node_moved"] == ["b1"]


def test_a_breadcrumb_whose_signals_weaken_but_whose_ranges_agree_has_not_moved() -> None:
    chance = np.random.default_rng(2)
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=0.0, node="base", role="base"), Node(t=0.0, node="ff1", role="responder")])
    tracker.fold([Node(t=0.0, node="b1", role="breadcrumb", position_m=(4.0, 10.0, 0.0), sigma_m=0.3)])
    there, back = [(0.0, 0.0), (0.0, 20.0), (8.0, 20.0)], [(8.0, 20.0), (0.0, 20.0), (0.0, 0.0)]
    walked = along(there, (4.0, 10.0), 0.0) + along(back, (4.0, 10.0), 28.0)
    places = {r.t: r.position_m for r in walked if isinstance(r, Position) and r.position_m is not None}
    signals: list[AnyReading] = []
    for t, (e, n, _) in places.items():
        lost_db = 15.0 if t > 28.0 else 0.0
        expected = -45.0 - lost_db - 22.0 * math.log10(math.hypot(e - 4.0, n - 10.0))
        for k in range(5):
            power = expected + float(chance.normal(0.0, 3.0))
            signals.append(Rssi(t=t - 0.1 * k, a="ff1", b="b1", dbm=power))
    told: list[Notice] = []
    for second in range(1, 57):
        tracker.fold([r for r in (*walked, *signals) if second - 1.0 < r.t <= second])
        told += tracker.take_notices()
    assert not [n for n in told if n.code == "node_moved"]


def test_a_fire_between_breadcrumbs_is_told_as_changed_links_and_moves_nothing() -> None:
    notices, _ = followed(scenario("burned-breadcrumb", 1), 205.0)
    changed = [n for n in notices if n.code == "link_changed"]
    assert changed
    assert all("b4" in n.text for n in changed)
    assert not [n for n in notices if n.code == "node_moved"]


def test_where_nothing_is_kicked_nothing_is_said_to_have_moved() -> None:
    notices, _ = followed(scenario("paper-a", 3), 400.0)
    assert not [n for n in notices if n.code in ("node_moved", "link_changed")]


@pytest.mark.parametrize("seed", [2, 4, 6, 205])
def test_walls_that_make_ranges_too_long_have_moved_no_breadcrumb(seed: int) -> None:
    notices, _ = followed(scenario("heavy-obstruction", seed), 300.0)
    assert not [n for n in notices if n.code == "node_moved"]


def test_each_node_is_asked_by_the_readings_that_name_it_in_their_order() -> None:
    rng = np.random.default_rng(12)
    pairs = np.zeros((200, len(COLUMNS["pairs"])))
    pairs[:, 2] = rng.integers(0, 9, 200)
    pairs[:, 3] = (pairs[:, 2] + rng.integers(1, 9, 200)) % 9
    recent = rng.permutation(200)[:120]
    first, told = by_node(recent, pairs, 11)
    for node in range(11):
        naming = [i for i in recent.tolist() if node in pairs[i, 2:4]]
        assert told[first[node] : first[node + 1]].tolist() == naming
