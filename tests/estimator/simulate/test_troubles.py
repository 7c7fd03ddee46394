"""Each scenario of trouble holds the trouble that it is named after."""

import numpy as np
import pytest

from estimator.measurements import Displacement, Drop, Range, Retire, Rssi
from estimator.simulate import Scenario, scenario


def distances(
    played: Scenario, readings: list[Range] | list[Rssi]
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    ends = [(played.truth[r.a].at(np.array([r.t])), played.truth[r.b].at(np.array([r.t]))) for r in readings]
    return np.array([float(np.linalg.norm(a - b)) for a, b in ends])


def test_three_share_the_breadcrumbs_of_the_first_on_two_storeys() -> None:
    played = scenario("shared-breadcrumbs", 1)
    drops = [r for r in played.readings if isinstance(r, Drop)]
    assert {drop.by for drop in drops} == {"ff1"}
    assert {int(played.truth[drop.node].level[0]) for drop in drops} == {0, 1}
    for node in ("ff1", "ff2", "ff3"):
        heard = {r.b for r in played.readings if isinstance(r, Rssi) and r.a == node}
        assert {drop.node for drop in drops} <= heard
        assert set(played.truth[node].level.tolist()) == {0, 1}


def test_a_kicked_breadcrumb_is_ranged_where_it_lies_then() -> None:
    played = scenario("kicked-breadcrumb", 1)
    track = played.truth["b3"]
    before, after = track.at(np.array([179.0, 181.0]))
    assert np.linalg.norm(after - before) == pytest.approx(4.0)
    later = [r for r in played.readings if isinstance(r, Range) and "b3" in (r.a, r.b) and r.t > 181.0]
    residual = np.array([r.range_m for r in later]) - distances(played, later)
    assert len(later) > 20
    assert np.median(np.abs(residual)) < 0.3


def test_a_burned_breadcrumb_weakens_dies_and_is_retired() -> None:
    played = scenario("burned-breadcrumb", 1)
    own = [r for r in played.readings if isinstance(r, Rssi) and "b4" in (r.a, r.b)]
    model = -40.0 - 25.0 * np.log10(np.maximum(distances(played, own), 0.1))
    excess = np.array([r.dbm for r in own]) - model
    t = np.array([r.t for r in own])
    assert t.max() < 210.0
    assert np.mean(excess[t < 150.0]) == pytest.approx(0.0, abs=1.5)
    assert np.mean(excess[t >= 150.0]) < -10.0
    assert [(r.node, r.t) for r in played.readings if isinstance(r, Retire)] == [("b4", 240.0)]
    lying = [r for r in own if r.a.startswith("b") and r.b.startswith("b")]
    assert min(r.t for r in lying) < 150.0 < max(r.t for r in lying)


def test_under_heavy_obstruction_most_ranges_are_much_too_long() -> None:
    played = scenario("heavy-obstruction", 1)
    ranges = [r for r in played.readings if isinstance(r, Range)]
    error = np.array([r.range_m for r in ranges]) - distances(played, ranges)
    assert np.mean(error > 0.3) > 0.4
    assert np.quantile(error, 0.9) > 2.0
    assert error.min() > -0.6


def test_a_late_gateway_posts_five_minutes_of_old_readings_in_ten_seconds() -> None:
    played = scenario("late-gateway", 1)
    late = [r for r in played.reports if r.gateway == "ladder-3"]
    assert not [r for r in late if 200.0 <= r.sent_s < 500.0]
    backlog = [r for r in late if r.sent_s - r.reading.t > 1.0]
    assert {500.0 <= r.sent_s <= 510.0 for r in backlog} == {True}
    assert min(r.reading.t for r in backlog) < 201.0
    assert max(r.sent_s - r.reading.t for r in backlog) > 290.0
    assert max(r.sent_s - r.reading.t for r in played.reports if r.gateway == "engine-7") < 0.5
    # Nothing is lost by it: the unit's displacements still add up without a gap.
    own = sorted(
        r.reading.t for r in late if isinstance(r.reading, Displacement) and r.reading.node == "L3-1"
    )
    assert np.diff(own).max() == pytest.approx(1.0)


def test_a_mission_of_two_hours_lasts_two_hours_of_walking_and_resting() -> None:
    played = scenario("two-hours", 1)
    assert played.duration_s == 7200.0
    assert max(r.t for r in played.readings) > 7195.0
    for node in ("ff1", "ff2", "ff3"):
        assert 1_500.0 < played.truth[node].distance_m < 4_000.0
    assert len(played.readings) > 60_000


def test_the_radios_of_an_incident_are_off_alike_and_those_of_another_otherwise() -> None:
    off_m = []
    for seed in range(6):
        played = scenario("burned-breadcrumb", seed)
        by_walker = [
            [r for r in played.readings if isinstance(r, Range) and r.a == node] for node in ("ff1", "ff2")
        ]
        off_m.append([np.median([r.range_m for r in own] - distances(played, own)) for own in by_walker])
    assert np.ptp(off_m, axis=1).max() < 0.04
    assert np.std(off_m, axis=0).min() > 0.05
