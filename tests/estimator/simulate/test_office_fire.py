"""The demo's story is told by its readings."""

import numpy as np
import pytest

from estimator.measurements import Alarm, Displacement, Drop, Node, Position, Range, Retire, Rssi, Status
from estimator.measurements.base import PairReading
from estimator.simulate import Scenario, scenario


@pytest.fixture(scope="module")
def played() -> Scenario:
    return scenario("office-fire", seed=2)


def test_two_crews_of_three_and_a_uav_are_introduced_at_once(played: Scenario) -> None:
    first = [r for r in played.readings if isinstance(r, Node) and r.t == 0.0]
    crews = {r.callsign: r.crew for r in first if r.role == "responder"}
    assert crews == {"E7-1": "E7", "E7-2": "E7", "E7-3": "E7", "L3-1": "L3", "L3-2": "L3", "L3-3": "L3"}
    assert [r.node for r in first if r.role == "uav"] == ["uav-1"]
    assert [r.position_m for r in first if r.role == "base"] == [(0.0, 0.0, 0.0)]


def test_the_first_of_each_crew_is_inside_within_ten_seconds(played: Scenario) -> None:
    for node in ("E7-1", "L3-1"):
        assert played.truth[node].at(np.array([10.0]))[0, 0] > 2.0


def test_the_storeys_are_three_and_all_of_them_are_walked(played: Scenario) -> None:
    assert [(s.level, s.up_m) for s in played.storeys] == [(0, 0.0), (1, 3.4), (2, 6.8)]
    assert {
        level for node, track in played.truth.items() if node[0] in "EL" for level in track.level.tolist()
    } == {
        0,
        1,
        2,
    }


def test_breadcrumbs_lie_twelve_to_fifteen_metres_of_way_apart(played: Scenario) -> None:
    for crew, leader in (("E7", "E7-1"), ("L3", "L3-1")):
        drops = [r.t for r in played.readings if isinstance(r, Drop) and r.by == leader]
        assert len(drops) >= 5
        track = played.truth[leader]
        step = np.linalg.norm(np.diff(track.position_m, axis=0), axis=1)
        apart = np.diff(np.interp(drops, track.t_s[1:], np.cumsum(step)))
        assert ((apart > 11.9) & (apart < 15.1)).all(), crew


def test_nothing_of_the_lost_one_is_heard_for_two_minutes(played: Scenario) -> None:
    silent = [
        r
        for r in played.readings
        if 540.0 <= r.t < 660.0
        and "E7-2" in ({r.a, r.b} if isinstance(r, PairReading) else {getattr(r, "node", "")})
    ]
    assert silent == []


def test_what_the_lost_one_walked_comes_as_one_displacement(played: Scenario) -> None:
    own = [r for r in played.readings if isinstance(r, Displacement) and r.node == "E7-2"]
    spanning = [r for r in own if r.from_t is not None and r.t - r.from_t > 2.0]
    assert [(r.from_t, r.t) for r in spanning] == [(539.0, 660.0)]
    way = played.truth["E7-2"].at(np.array([539.0, 660.0]))
    assert np.linalg.norm(spanning[0].delta_m) == pytest.approx(np.linalg.norm(way[1] - way[0]), abs=2.0)


def test_one_mayday_is_raised_acknowledged_and_cleared(played: Scenario) -> None:
    mayday = [
        (r.t, r.state, report.gateway)
        for report in played.reports
        if isinstance(r := report.reading, Alarm) and r.alarm == "mayday"
    ]
    assert [state for _, state, _ in mayday] == ["raised", "acknowledged", "cleared"]
    assert mayday[0][0] == 780.0
    assert [gateway for _, _, gateway in mayday] == ["ladder-3", "command-post", "command-post"]
    text = next(r.text for r in played.readings if isinstance(r, Alarm) and r.alarm == "mayday" and r.text)
    assert all(word in text for word in ("Location", "Unit", "Name", "Assignment", "Resources"))


def test_the_one_who_is_down_does_not_move_until_he_is_found(played: Scenario) -> None:
    place = played.truth["L3-2"].at(np.arange(740.0, 965.0))
    assert np.ptp(place, axis=0).max() == 0.0
    still = [
        r.motionless_s
        for r in played.readings
        if isinstance(r, Status) and r.node == "L3-2" and 900 < r.t < 960
    ]
    assert min(s for s in still if s is not None) > 150.0


def test_one_breadcrumb_is_kicked_and_another_burns(played: Scenario) -> None:
    moved = [n for n, track in played.truth.items() if "-B" in n and track.distance_m > 0.0]
    assert len(moved) == 1
    assert played.truth[moved[0]].distance_m == pytest.approx(4.0)
    burnt = [r for r in played.readings if isinstance(r, Retire)]
    assert [r.t for r in burnt] == [900.0]
    assert burnt[0].node not in moved
    heard = [r.t for r in played.readings if isinstance(r, PairReading) and burnt[0].node in (r.a, r.b)]
    assert max(heard) < 880.0


def test_air_goes_down_and_is_not_reported_by_all(played: Scenario) -> None:
    air: dict[str, list[float]] = {}
    for r in played.readings:
        if isinstance(r, Status) and r.air_bar is not None:
            air.setdefault(r.node, []).append(r.air_bar)
    assert sorted(air) == ["E7-1", "E7-2", "E7-3", "L3-1", "L3-2"]
    for left in air.values():
        assert left == sorted(left, reverse=True)
        assert 50.0 < left[-1] < 200.0 < left[0] <= 300.0


def test_the_uav_flies_around_the_building_and_ranges_through_windows(played: Scenario) -> None:
    fixes = [r for r in played.readings if isinstance(r, Position)]
    truth = played.truth["uav-1"].at(np.array([r.t for r in fixes]))
    error = (np.array([r.position_m for r in fixes]) - truth) / np.array([r.sigma_m for r in fixes])
    assert np.std(error, axis=0) == pytest.approx([1.0, 1.0, 1.0], rel=0.08)
    ranged = {r.b for r in played.readings if isinstance(r, Range) and r.a == "uav-1"}
    assert len(ranged) == 6


def test_a_minute_brings_some_thousands_of_readings(played: Scenario) -> None:
    assert 1_500 < len(played.readings) / 20 < 4_000
    assert sum(isinstance(r, Rssi) for r in played.readings) > 20_000


def test_uwb_ranges_are_never_far_too_short_and_often_too_long(played: Scenario) -> None:
    ranges = [r for r in played.readings if isinstance(r, Range)]
    errors = np.array(
        [
            r.range_m
            - float(
                np.linalg.norm(played.truth[r.a].at(np.array([r.t])) - played.truth[r.b].at(np.array([r.t])))
            )
            for r in ranges[::5]
        ]
    )
    assert np.quantile(errors, 0.001) > -0.5
    assert np.median(errors) < 0.5
    assert np.quantile(errors, 0.99) > 1.0
