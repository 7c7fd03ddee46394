"""What holds for every scenario."""

import itertools

import msgspec
import numpy as np
import pytest

from estimator.measurements import AnyReading, Displacement
from estimator.measurements.base import PairReading
from estimator.simulate import Scenario, scenario, scenario_names

decode = msgspec.json.Decoder(list[AnyReading]).decode


@pytest.fixture(scope="module", params=scenario_names())
def played(request: pytest.FixtureRequest) -> Scenario:
    return scenario(request.param, seed=7)


def test_every_reading_passes_the_bounds_of_its_kind(played: Scenario) -> None:
    assert decode(msgspec.json.encode(played.readings)) == played.readings


def test_equal_seeds_give_equal_readings(played: Scenario) -> None:
    again = scenario(played.name, seed=7)
    assert msgspec.json.encode(again.readings) == msgspec.json.encode(played.readings)
    assert [report.sent_s for report in again.reports] == [report.sent_s for report in played.reports]


def test_other_seeds_give_other_readings(played: Scenario) -> None:
    assert scenario(played.name, seed=8).readings != played.readings


def test_reports_are_posted_in_order_and_not_before_they_are_measured(played: Scenario) -> None:
    sent = [report.sent_s for report in played.reports]
    assert sent == sorted(sent)
    assert all(report.reading.t <= report.sent_s for report in played.reports)
    assert max(report.reading.t for report in played.reports) <= played.duration_s + 1.0


def test_every_node_in_a_reading_has_a_truth(played: Scenario) -> None:
    for reading in played.readings:
        named = {reading.a, reading.b} if isinstance(reading, PairReading) else {getattr(reading, "node", "")}
        assert named <= played.truth.keys()


def test_truth_is_walked_at_the_pace_of_people(played: Scenario) -> None:
    for node, track in played.truth.items():
        if not any(isinstance(r, Displacement) and r.node == node for r in played.readings):
            continue
        speed = np.linalg.norm(np.diff(track.position_m, axis=0), axis=1) / np.diff(track.t_s)
        assert speed.max() < 1.3
        assert (np.diff(track.t_s) > 0).all()


def test_levels_of_the_truth_are_those_of_the_nearest_floor(played: Scenario) -> None:
    floors = {storey.level: storey.up_m for storey in played.storeys}
    for node, track in played.truth.items():
        if node.startswith("uav"):
            continue
        for level, up_m in zip(track.level.tolist(), track.position_m[:, 2].tolist(), strict=True):
            nearest = min(floors, key=lambda candidate: abs(floors[candidate] - up_m), default=0)
            assert level == nearest or abs(floors[level] - up_m) < 1e-6 + abs(floors[nearest] - up_m)


def test_displacements_cover_the_walk_without_gap_or_overlap(played: Scenario) -> None:
    for node in played.truth:
        own = sorted(
            (r for r in played.readings if isinstance(r, Displacement) and r.node == node), key=lambda r: r.t
        )
        for before, after in itertools.pairwise(own):
            assert after.from_t == before.t


def test_an_unknown_scenario_is_answered_with_those_there_are() -> None:
    with pytest.raises(KeyError, match="office-fire"):
        scenario("office-party")
