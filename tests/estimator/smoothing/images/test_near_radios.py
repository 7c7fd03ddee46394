"""Who has no unit and hears signals alone: outside of all radios he may fit as well as among them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.smoothing.images.near_radios import centroids, starts_near_radios
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.images.test_flip_ambiguity import places, solved_of

ROOM_M = np.array([20.0, 15.0])
RADIOS_M = ((0.0, 0.0), (20.0, 0.0), (20.0, 15.0), (0.0, 15.0), (10.0, 0.0), (10.0, 15.0))
SECONDS = 80
SEEDS = (0, 3, 6, 8)
DBM, EXPONENT, SIGMA_DB = -62.0, 1.5, 5.0
"""As weak, and as little weaker with the distance, as beacons of Bluetooth Low Energy are measured."""


def walked(chance: np.random.Generator) -> Array:
    """A stroll through the room, second by second, k × 2 (m)."""
    place, velocity, way = np.array([5.0, 4.0]), chance.normal(0.0, 0.6, 2), []
    for _ in range(SECONDS):
        velocity = 0.9 * velocity + chance.normal(0.0, 0.25, 2)
        velocity = np.where((place + velocity < 2.0) | (place + velocity > ROOM_M - 2.0), -velocity, velocity)
        place = np.clip(place + velocity, 2.0, ROOM_M - 2.0)
        way.append(place)
    return np.array(way)


def stroll(seed: int) -> tuple[list[AnyReading], Array]:
    """What he hears, each second of all radios, and his way."""
    chance = np.random.default_rng(seed)
    way_m = walked(chance)
    readings: list[AnyReading] = [
        Node(t=0.0, node=f"a{i}", role="anchor", position_m=(*at_m, 2.0)) for i, at_m in enumerate(RADIOS_M)
    ]
    readings.append(Node(t=0.0, node="ff1", role="responder"))
    for second, place in enumerate(way_m, start=1):
        for i, at_m in enumerate(RADIOS_M):
            distance_m = float(np.sqrt(((place - at_m) ** 2).sum() + 1.0))
            dbm = DBM - 10.0 * EXPONENT * np.log10(distance_m) + chance.normal(0.0, SIGMA_DB)
            readings.append(Rssi(t=float(second), a="ff1", b=f"a{i}", dbm=float(dbm)))
    return readings, way_m


def begun_outside(readings: list[AnyReading]) -> tuple[Problem, Solution]:
    """The incident solved from far outside, where stronger radios than these would be heard as well."""
    problem, solved = solved_of(readings)
    x = solved.x.copy()
    problem.layout.states(x, 0)[:, :2] += 60.0
    size = problem.layout.length * problem.layout.width
    start = next(at for (kind, _), at in problem.layout.technologies.items() if kind == "rssi")
    x[size + start : size + start + 2] = -35.0, 2.5
    return problem, problem.solve(x)


def off_m(problem: Problem, solved: Solution, way_m: Array) -> float:
    """How far off he is, root mean square (m)."""
    at = np.clip(problem.layout.grid.astype(int) - 1, 0, SECONDS - 1)
    return float(np.sqrt(((places(problem, solved) - way_m[at]) ** 2).sum(axis=1).mean()))


def test_whom_a_solution_has_outside_of_all_radios_is_found_among_them() -> None:
    readings, way_m = stroll(7)
    problem, outside = begun_outside(readings)
    found, others = starts_near_radios(problem, outside, whole=True)
    assert off_m(problem, outside, way_m) > 20.0
    assert off_m(problem, found, way_m) < 4.0
    assert found.cost < outside.cost
    assert not others or others[0].share < 0.5


def test_asked_again_it_is_the_same_solution() -> None:
    readings, _ = stroll(3)
    problem, solved = solved_of(readings)
    found, _ = starts_near_radios(problem, solved, whole=True)
    again, others = starts_near_radios(problem, found, whole=True)
    assert again.cost == pytest.approx(found.cost, abs=0.5)
    assert not others


def test_whom_a_range_locates_as_well_is_not_asked() -> None:
    readings, way_m = stroll(7)
    range_m = float(np.hypot(*(way_m[40] - RADIOS_M[0])))
    problem, outside = begun_outside([*readings, Range(t=41.0, a="ff1", b="a0", range_m=range_m)])
    assert starts_near_radios(problem, outside, whole=True) == (outside, [])


@pytest.mark.parametrize("seed", SEEDS)
def test_he_is_shown_in_the_room_and_not_far_beyond_its_walls(seed: int) -> None:
    """Begun with a P0 that is too high, he was shown 40 to 70 m beyond them."""
    readings, _ = stroll(seed)
    smoothed = [p.position_m for p in BatchSmoother(TrackerSettings()).smooth(readings)["ff1"]]
    tracker = KirchhoffTracker()
    tracker.fold(readings)
    last = next(e.position_m for e in tracker.estimates() if e.node == "ff1")
    assert last is not None
    off_room_m = np.abs(np.array([*smoothed, last])[:, :2] - ROOM_M / 2.0) - ROOM_M / 2.0
    assert off_room_m.max() < 8.0


@given(
    dbm=st.lists(st.floats(-100.0, -30.0), min_size=len(RADIOS_M), max_size=len(RADIOS_M)),
    t=st.floats(0.0, 30.0),
)
def test_a_centroid_is_among_the_radios(dbm: list[float], t: float) -> None:
    (centre,) = centroids(np.zeros(len(RADIOS_M)), np.array(RADIOS_M), np.array(dbm), np.array([t]))
    assert (centre >= 0.0).all()
    assert (centre <= ROOM_M).all()


def test_a_centroid_is_at_the_radio_that_is_heard_far_better_and_just_now() -> None:
    t, powers = np.array([0.0, 0.0, 60.0]), np.array([-90.0, -30.0, -90.0])
    at_m = np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 15.0]])
    first, last = centroids(t, at_m, powers, np.array([0.0, 60.0]))
    assert first == pytest.approx(at_m[1], abs=0.1)
    assert last == pytest.approx(at_m[2], abs=0.1)
