"""Breadcrumbs that lie elsewhere than they did, and links that have changed for good."""

import dataclasses
import math

import numpy as np

from estimator.estimate import NodeEstimate, Notice
from estimator.simulate import Scenario, scenario
from estimator.trackers.kirchhoff import KirchhoffTracker

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


def test_a_kicked_breadcrumb_is_noticed_within_30_s_and_costs_nobody_more_than_a_metre() -> None:
    """What it costs is held against the same walk whose breadcrumb falls silent instead."""
    shown = scenario("kicked-breadcrumb", 0)
    notices, tracks = followed(shown, 280.0)
    told = [n.t for n in notices if n.code == "node_moved"]
    assert [n.node for n in notices if n.code == "node_moved"] == ["b3"]
    epochs = np.arange(181.0, 281.0)
    walkers = [shown.truth[name].at(epochs) for name in ("ff1", "ff2")]
    near = np.min([np.linalg.norm(w - shown.truth["b3"].at(epochs), axis=1) for w in walkers], axis=0)
    again = float(epochs[np.argmax(near < AGAIN_M)])
    assert told[0] <= again + 30.0
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


def test_the_kicked_breadcrumb_is_then_shown_where_it_lies() -> None:
    shown = scenario("kicked-breadcrumb", 1)
    _, tracks = followed(shown, 300.0)
    place = tracks["b3"][-1].position_m
    assert place is not None
    kicked = shown.truth["b3"].position_m[-1] - shown.truth["b2"].position_m[-1]
    other = tracks["b2"][-1].position_m
    assert other is not None
    assert np.hypot(*(np.array(place) - np.array(other) - kicked)[:2]) < 2.5


def test_a_fire_between_breadcrumbs_is_told_as_changed_links_and_moves_nothing() -> None:
    notices, _ = followed(scenario("burned-breadcrumb", 1), 205.0)
    changed = [n for n in notices if n.code == "link_changed"]
    assert changed
    assert all("b4" in n.text for n in changed)
    assert not [n for n in notices if n.code == "node_moved"]


def test_where_nothing_is_kicked_nothing_is_said_to_have_moved() -> None:
    notices, _ = followed(scenario("paper-a", 3), 400.0)
    assert not [n for n in notices if n.code in ("node_moved", "link_changed")]
