"""A radio all of whose ranges are too long, among good ones: it is told, and nobody is shown elsewhere."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pytest

from estimator.estimate import TrackPoint
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.learning.radios import Delay
from estimator.smoothing.learning.trusted_radios import distrust
from estimator.smoothing.whole import solve_whole
from estimator.smoothing.window import solve_now
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import SURE, outside
from tests.estimator.smoothing.windows import fused

SECONDS, SEEDS = 150, (41, 42, 43)
RADIOS, UP_M, RANGE_SIGMA_M = 4, 1.0, 0.15
ECHOES, ECHO_M = 0.05, 2.0


class World(NamedTuple):
    """What was measured, and where everybody was at each whole second (m)."""

    readings: list[AnyReading]
    ways: dict[str, Array]


def world(seed: int, delays_m: dict[str, float], crew: int = 1, kicked_m: float = 0.0) -> World:
    """A crew walks from goal to goal among radios whose places are known; `delays_m`: by node.

    Half way, the first radio is kicked.
    """
    chance = np.random.default_rng(seed)
    radios = {f"a{i}": np.array([*chance.uniform(-25.0, 25.0, 2), UP_M]) for i in range(RADIOS)}
    readings: list[AnyReading] = [
        Node(
            t=0.0,
            node=name,
            role="beacon" if kicked_m else "anchor",
            position_m=(*at[:2].tolist(), UP_M),
            sigma_m=0.1,
        )
        for name, at in radios.items()
    ]
    ways = {}
    for number in range(crew):
        name, at = f"ff{number}", chance.uniform(-3.0, 3.0, 2)
        goal, way, turned_rad = at, [at], 0.0
        for second in range(1, SECONDS + 1):
            if np.hypot(*(goal - at)) < 1.0:
                goal = chance.uniform(-20.0, 20.0, 2)
            step_m = (goal - at) / max(1.0, float(np.hypot(*(goal - at))))
            at, turned_rad = at + step_m, turned_rad + chance.normal(0.0, 0.005)
            way.append(at)
            cos, sin = np.cos(turned_rad), np.sin(turned_rad)
            turned_m = np.array([[cos, -sin], [sin, cos]]) @ step_m + chance.normal(0.0, 0.03, 2)
            east, north = turned_m.tolist()
            readings.append(Displacement(t=float(second), node=name, delta_m=(east, north, 0.0)))
            for radio, place in radios.items():
                kick_m = kicked_m if radio == "a0" and second > SECONDS // 2 else 0.0
                range_m = float(np.linalg.norm([*(at - place[:2] - (kick_m, 0.0)), UP_M - place[2]]))
                range_m += (
                    chance.normal(0.0, RANGE_SIGMA_M) + delays_m.get(name, 0.0) + delays_m.get(radio, 0.0)
                )
                range_m += chance.exponential(ECHO_M) if chance.random() < ECHOES else 0.0
                reading = Range(
                    t=float(second), a=name, b=radio, range_m=float(abs(range_m)), technology="uwb"
                )
                readings.append(reading)
        ways[name] = np.array(way)
        place_m = (*way[0].tolist(), UP_M)
        readings.append(
            Node(t=0.0, node=name, role="responder", position_m=place_m, sigma_m=0.3, heading_sigma_rad=0.05)
        )
    return World(sorted(readings, key=lambda r: r.t), ways)


def followed(told: World) -> tuple[int, int, set[str | None]]:
    """For how many seconds somebody is shown elsewhere with certainty, of how many; whose ranges are off."""
    tracker, wrong, seconds = KirchhoffTracker(), 0, 0
    for second in range(SECONDS + 1):
        tracker.fold([r for r in told.readings if r.t == second])
        for found in tracker.estimates():
            if found.node in told.ways and second > 0:
                true_m = told.ways[found.node][second]
                wrong += outside(found.position_m, found.covariance_m2, true_m) > SURE
                seconds += 1
    said = {n.node for n in tracker.take_notices() if "antenna delay" in n.text}
    return wrong, seconds, said


def wrong_s(track: Iterable[TrackPoint], way: Array) -> int:
    return sum(
        outside(p.position_m, p.covariance_m2, way[round(p.t)]) > SURE for p in track if p.t == round(p.t)
    )


@pytest.mark.parametrize(
    ("delays_m", "crew"), [({"a0": 2.0}, 1), ({"a0": -2.0}, 3), ({"ff0": 2.0}, 1), ({"ff0": 4.0}, 3)]
)
def test_a_radio_that_is_off_is_told_and_shows_nobody_elsewhere(
    delays_m: dict[str, float], crew: int
) -> None:
    """Believed, it showed them elsewhere for a third to a half of the time."""
    found = [followed(world(seed, delays_m, crew)) for seed in SEEDS]
    assert all(set(delays_m) <= said for _, _, said in found)
    assert sum(wrong for wrong, _, _ in found) < 0.02 * sum(seconds for _, seconds, _ in found)


def test_two_radios_that_are_off_are_both_told() -> None:
    wrong, seconds, said = followed(world(44, {"a0": 2.0, "ff1": 3.0}, crew=3))
    assert said == {"a0", "ff1"}
    assert wrong < 0.02 * seconds


@pytest.mark.parametrize("delays_m", [{"a0": 2.0}, {"ff0": 2.0}])
def test_looking_back_nobody_is_thought_to_have_been_elsewhere(delays_m: dict[str, float]) -> None:
    for seed in SEEDS:
        readings, ways = world(seed, delays_m)
        track = BatchSmoother().smooth(readings)["ff0"]
        assert wrong_s(track, ways["ff0"]) == 0


def dropped(seed: int, delay_m: float = 0.0) -> World:
    """The same between four anchors; he drops a breadcrumb, all ranges of which are off by `delay_m`."""
    readings, ways = world(seed, {})
    chance, at = np.random.default_rng(seed), np.array([*ways["ff0"][20], 0.2])
    readings += [Node(t=20.0, node="b0", role="breadcrumb"), Drop(t=20.0, node="b0", by="ff0")]
    for second in range(21, SECONDS + 1):
        far_m = float(np.linalg.norm([*(ways["ff0"][second] - at[:2]), UP_M - at[2]])) + delay_m
        range_m = abs(far_m + chance.normal(0.0, RANGE_SIGMA_M))
        readings.append(Range(t=float(second), a="ff0", b="b0", range_m=range_m, technology="uwb"))
    return World(sorted(readings, key=lambda r: r.t), ways)


@pytest.mark.parametrize("delay_m", [0.0, 2.0])
def test_looking_back_a_breadcrumb_is_trusted_again_unless_all_says_that_it_is_off(delay_m: float) -> None:
    for seed in SEEDS:
        state = fused(dropped(seed, delay_m).readings)
        if ("uwb", "b0") not in state.delayed:
            distrust(state, [Delay(("uwb", "b0"), 0.0, 0.0, True, 0.0)])
        problem, *_ = solve_whole(state)
        assert list(problem.layout.state.delayed) == ([("uwb", "b0")] if delay_m else [])


@pytest.mark.parametrize("delay_m", [0.0, 2.0])
def test_a_radio_is_trusted_again_once_its_own_ranges_say_that_it_is_not_off(
    delay_m: float,
) -> None:
    """A map that was bent has made it seem so; what is off stays distrusted."""
    for seed in SEEDS:
        state = fused(dropped(seed, delay_m).readings)
        distrust(state, [Delay(("uwb", "b0"), 0.0, 0.0, True, 0.0)])
        for _ in range(3):
            solve_now(state, state.newest_t)
        assert (("uwb", "b0") in state.delayed) == (delay_m > 0.0)


def test_good_radios_are_trusted() -> None:
    for seed in SEEDS:
        wrong, _, said = followed(world(seed, {}, crew=3))
        assert said == set()
        assert wrong == 0


def test_a_radio_that_was_kicked_is_not_taken_for_one_that_is_off() -> None:
    for seed in SEEDS:
        _, _, said = followed(world(seed, {}, kicked_m=5.0))
        assert said == set()
