"""True ways are walked as told: pace, stops, facing, levels; in the office through doors, not walls."""

import numpy as np
import pytest

from estimator.simulate import Storey, scenario
from estimator.simulate.building import STOREYS, walls_between
from estimator.simulate.walking import Leg, levels_of, walk


def test_a_leg_takes_its_length_over_its_pace_and_then_its_stop() -> None:
    track = walk((0.0, 0.0, 0.0), [Leg((6.0, 8.0, 0.0), 0.5, 5.0), Leg((6.0, 0.0, 0.0), 1.0)], (), end_s=40.0)
    place = track.at(np.array([0.0, 10.0, 20.0, 25.0, 29.0, 33.0, 40.0]))
    expected = [(0, 0), (3, 4), (6, 8), (6, 8), (6, 4), (6, 0), (6, 0)]
    assert np.allclose(place[:, :2], expected)


def test_standing_before_the_first_leg_delays_it() -> None:
    track = walk((0.0, 0.0, 0.0), [Leg((10.0, 0.0, 0.0), 1.0)], (), end_s=20.0, stand_s=4.0)
    assert track.at(np.array([4.0, 9.0]))[:, 0].tolist() == pytest.approx([0.0, 5.0])


def test_a_walker_faces_the_way_and_keeps_facing_it_while_standing() -> None:
    track = walk(
        (0.0, 0.0, 0.0), [Leg((0.0, 5.0, 0.0), 1.0, 5.0), Leg((-5.0, 5.0, 0.0), 1.0)], (), end_s=15.0
    )
    facing = track.heading_at(np.array([2.0, 7.0, 13.0]))
    assert facing == pytest.approx([np.pi / 2, np.pi / 2, np.pi])


def test_the_level_is_that_of_the_nearest_floor() -> None:
    storeys = (Storey(-1, "Cellar", -2.8), Storey(0, "Ground", 0.0), Storey(1, "First", 3.4))
    assert levels_of(np.array([-3.0, -1.0, 1.6, 1.8, 9.0]), storeys).tolist() == [-1, 0, 0, 1, 1]


@pytest.mark.parametrize("name", ["office-fire", "shared-breadcrumbs", "heavy-obstruction", "late-gateway"])
def test_nobody_walks_through_a_wall(name: str) -> None:
    for node, track in scenario(name, 4).truth.items():
        if not node.startswith(("uav", "base")) and "B" not in node and not node.startswith("b"):
            crossed = walls_between(track.position_m[:-1], track.position_m[1:])
            assert crossed.sum() == 0, (node, track.position_m[:-1][crossed > 0][:3])


def test_stairs_are_climbed_storey_by_storey() -> None:
    track = scenario("office-fire", 4).truth["L3-1"]
    for storey in STOREYS:
        assert np.abs(track.position_m[:, 2] - storey.up_m).min() < 1e-6
    assert np.abs(np.diff(track.level)).max() == 1
