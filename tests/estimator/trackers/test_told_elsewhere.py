"""An anchor stands some metres from where it was told to: who is ranged by it, and what is told of it."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside
from tests.estimator.trackers.restarts import assert_goes_on_alike

SECONDS, SEEDS = 100, (81, 82, 83, 84)
OUT_M, HALF_M, UP_M, RANGE_SIGMA_M = 14.0, 9.0, 1.0, 0.12
WRONG = "a1"
TOWARDS_RAD = {81: 0.3, 82: 2.1, 83: 3.9, 84: 5.2}


class World(NamedTuple):
    """What was measured, where he was at each whole second (m), and where the anchors stand (m)."""

    readings: list[AnyReading]
    way: Array
    anchors: dict[str, Array]


class Shown(NamedTuple):
    """Squared distances of him from where he is shown, and what was said of anchors: when (s), of which."""

    squares: Array
    named: list[tuple[int, str]]


def told_at(name: str, at: Array, t: float = 0.0) -> Node:
    """Somebody tells where an anchor stands."""
    place_m = (float(at[0]), float(at[1]), float(at[2]))
    return Node(t=t, node=name, role="anchor", position_m=place_m, sigma_m=0.1)


def world(seed: int, wrong_m: float, anchors: int, unit: bool) -> World:
    """He walks to and fro between anchors, one of which is told to stand elsewhere.

    Args:
        seed: of all that is drawn.
        wrong_m: how far from where it stands (m).
        anchors: how many there are, on a circle about him.
        unit: he has a PDR unit.
    """
    chance = np.random.default_rng(seed)
    angles = chance.uniform(0.0, 2.0 * math.pi) + 2.0 * math.pi * np.arange(anchors) / anchors
    stand = {
        f"a{i}": np.array([OUT_M * math.cos(by), OUT_M * math.sin(by), 0.5 + 0.5 * i])
        for i, by in enumerate(angles.tolist())
    }
    off_m = wrong_m * np.array([math.cos(TOWARDS_RAD[seed]), math.sin(TOWARDS_RAD[seed]), 0.0])
    readings: list[AnyReading] = [
        told_at(name, at + off_m if name == WRONG else at) for name, at in stand.items()
    ]
    at, goal, turned_rad = chance.uniform(-4.0, 4.0, 2), chance.uniform(-HALF_M, HALF_M, 2), 0.0
    began_m = (float(at[0]), float(at[1]), UP_M)
    readings.append(Node(t=0.0, node="ff", role="responder", position_m=began_m, sigma_m=0.5))
    way = [at]
    for second in range(1, SECONDS + 1):
        if np.hypot(*(goal - at)) < 1.0:
            goal = chance.uniform(-HALF_M, HALF_M, 2)
        step_m = (goal - at) / max(1.0, float(np.hypot(*(goal - at))))
        at, turned_rad = at + step_m, turned_rad + chance.normal(0.0, 0.005)
        way.append(at)
        cos, sin = math.cos(turned_rad), math.sin(turned_rad)
        east, north = (np.array([[cos, -sin], [sin, cos]]) @ step_m + chance.normal(0.0, 0.03, 2)).tolist()
        if unit:
            readings.append(Displacement(t=float(second), node="ff", delta_m=(east, north, 0.0)))
        for name, there in stand.items():
            range_m = float(np.linalg.norm(np.array([*at, UP_M]) - there))
            range_m += chance.normal(0.0, RANGE_SIGMA_M)
            range_m += chance.exponential(1.5) if chance.random() < 0.05 else 0.0
            readings.append(Range(t=float(second), a="ff", b=name, range_m=abs(range_m), technology="uwb"))
    return World(readings, np.array(way), stand)


def followed(told: World, tracker: KirchhoffTracker | None = None, since: int = 0) -> Shown:
    """He is followed from a second on."""
    tracker, squares, named = tracker or KirchhoffTracker(), list[float](), list[tuple[int, str]]()
    for second in range(since, SECONDS + 1):
        tracker.fold([r for r in told.readings if r.t == second])
        (found,) = (one for one in tracker.estimates() if one.node == "ff")
        squares.append(outside(found.position_m, found.covariance_m2, told.way[second]))
        notices = [n for n in tracker.take_notices() if n.code == "node_moved"]
        named += [(second, n.node) for n in notices if n.node is not None]
    return Shown(np.array(squares), named)


@pytest.mark.parametrize(
    ("wrong_m", "anchors", "unit"),
    [(2.0, 3, True), (3.0, 3, False), (3.0, 4, False), (2.0, 4, True), (5.0, 5, False)],
)
def test_he_is_not_shown_elsewhere_with_certainty(wrong_m: float, anchors: int, unit: bool) -> None:
    """With all told places believed he was sure of a wrong one for up to half of the time."""
    squares = [followed(world(seed, wrong_m, anchors, unit)).squares for seed in SEEDS]
    assert (np.concatenate(squares) > SURE).mean() < 0.05


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("wrong_m", "anchors"), [(3.0, 5), (5.0, 4)])
def test_that_anchor_is_named_and_no_other(seed: int, wrong_m: float, anchors: int) -> None:
    named = followed(world(seed, wrong_m, anchors, unit=False)).named
    assert [name for _, name in named] == [WRONG]


@pytest.mark.parametrize(("anchors", "unit"), [(3, False), (3, True), (5, False)])
def test_anchors_that_stand_where_they_were_told_to_are_believed(anchors: int, unit: bool) -> None:
    shown = [followed(world(seed, 0.0, anchors, unit)) for seed in SEEDS]
    assert not [named for one in shown for named in one.named]
    assert (np.concatenate([one.squares for one in shown]) < INSIDE).mean() > 0.93


def heard(told: World, seed: int, weaker_db: float) -> World:
    """The same with powers in the place of ranges; one radio is weaker than the others."""
    chance, readings = np.random.default_rng(seed), list[AnyReading]()
    for reading in told.readings:
        if isinstance(reading, Range):
            dbm = -45.0 - 22.0 * math.log10(max(reading.range_m, 0.3)) + float(chance.normal(0.0, 4.0))
            dbm -= weaker_db if reading.b == WRONG else 0.0
            readings.append(Rssi(t=reading.t, a=reading.a, b=reading.b, dbm=dbm))
        else:
            readings.append(reading)
    return told._replace(readings=readings)


@pytest.mark.parametrize("unit", [False, True])
def test_a_weak_radio_of_which_powers_alone_tell_is_not_taken_to_stand_elsewhere(unit: bool) -> None:
    shown = [followed(heard(world(seed, 0.0, 5, unit), seed, weaker_db=10.0)) for seed in SEEDS]
    assert not [named for one in shown for named in one.named]


def test_once_it_is_told_where_it_stands_it_is_believed_there() -> None:
    told = world(81, 5.0, 5, unit=False)
    tracker = KirchhoffTracker()
    tracker.fold([r for r in told.readings if r.t <= 60.0])
    tracker.take_notices()
    tracker.fold([told_at(WRONG, told.anchors[WRONG], 60.0)])
    shown = followed(told, tracker, since=61)
    assert (shown.squares > SURE).mean() < 0.05
    (found,) = (one for one in tracker.estimates() if one.node == WRONG)
    assert outside(found.position_m, found.covariance_m2, told.anchors[WRONG][:2]) < INSIDE


def test_pictures_are_the_same_after_a_restart_while_it_is_in_doubt() -> None:
    assert_goes_on_alike(world(83, 3.0, 3, unit=False).readings, 12.0)


@pytest.mark.parametrize("unit", [False, True])
def test_looking_back_he_is_inside_and_evidence_is_as_unsure(unit: bool) -> None:
    told = world(84, 3.0, 3, unit)
    smoother = BatchSmoother()
    track = smoother.smooth(told.readings)["ff"]
    squares = np.array([outside(p.position_m, p.covariance_m2, told.way[round(p.t)]) for p in track])
    assert (squares < INSIDE).mean() > 0.9
    evidence = smoother.evidence(told.readings, "ff")
    assert evidence is not None
    assert evidence.covariance_m2 == pytest.approx(track[-1].covariance_m2, rel=0.02, abs=1e-4)
