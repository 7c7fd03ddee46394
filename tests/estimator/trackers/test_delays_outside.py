"""Whose radio is off, outside of where the anchors are: a delay looks like a place there, for minutes."""

import math
from typing import NamedTuple

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside

SECONDS, SEEDS = 120, range(51, 57)
HALF_M, UP_M, RANGE_SIGMA_M = 6.0, 1.0, 0.1
ECHOES, ECHO_M = 0.05, 2.0


class World(NamedTuple):
    """What was measured, and where everybody was at each whole second (m)."""

    readings: list[AnyReading]
    ways: dict[str, Array]


def world(seed: int, delay_m: float, crew: int = 1, unit: bool = False, middle_m: float = 18.0) -> World:
    """A crew walks to and fro within 6 m of a place beside a square of anchors; the first one's radio is off.

    Args:
        seed: of all that is drawn.
        delay_m: by which ranges of the first one's radio are too long (m).
        crew: how many they are.
        unit: they have PDR units.
        middle_m: how far that place is from the middle of the anchors.
    """
    chance = np.random.default_rng(seed)
    corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * HALF_M
    anchors = {f"a{i}": np.array([*at, UP_M + 0.5 * i]) for i, at in enumerate(corners)}
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(float(at[0]), float(at[1]), float(at[2])))
        for name, at in anchors.items()
    ]
    ways = {}
    for number in range(crew):
        name, goal = f"ff{number}", np.array([middle_m, 0.0])
        at, turned_rad = goal + chance.uniform(-3.0, 3.0, 2), chance.normal(0.0, 0.05)
        place_m = (float(at[0]), float(at[1]), UP_M)
        readings.append(Node(t=0.0, node=name, role="responder", position_m=place_m, sigma_m=0.5))
        way = [at]
        for second in range(1, SECONDS + 1):
            if np.hypot(*(goal - at)) < 1.0:
                goal = np.array([middle_m, 0.0]) + chance.uniform(-6.0, 6.0, 2)
            step_m = (goal - at) / max(1.0, float(np.hypot(*(goal - at))))
            at, turned_rad = at + step_m, turned_rad + chance.normal(0.0, 0.005)
            way.append(at)
            cos, sin = math.cos(turned_rad), math.sin(turned_rad)
            east, north = (
                np.array([[cos, -sin], [sin, cos]]) @ step_m + chance.normal(0.0, 0.03, 2)
            ).tolist()
            if unit:
                readings.append(Displacement(t=float(second), node=name, delta_m=(east, north, 0.0)))
            for anchor, there in anchors.items():
                range_m = float(np.linalg.norm(np.array([*at, UP_M]) - there)) + chance.normal(
                    0.0, RANGE_SIGMA_M
                )
                range_m += delay_m if number == 0 else 0.0
                range_m += chance.exponential(ECHO_M) if chance.random() < ECHOES else 0.0
                reading = Range(t=float(second), a=name, b=anchor, range_m=abs(range_m), technology="uwb")
                readings.append(reading)
        ways[name] = np.array(way)
    return World(sorted(readings, key=lambda r: r.t), ways)


def followed(told: World) -> Array:
    """Squared distances of everybody from where he is shown, in the metric of what is told."""
    tracker, squares = KirchhoffTracker(), list[float]()
    for second in range(SECONDS + 1):
        tracker.fold([r for r in told.readings if r.t == second])
        for found in tracker.estimates():
            if found.node in told.ways and second > 0:
                true_m = told.ways[found.node][second]
                squares.append(outside(found.position_m, found.covariance_m2, true_m))
    return np.array(squares)


@pytest.mark.parametrize(
    ("delay_m", "crew", "unit"), [(1.0, 1, False), (-1.0, 1, True), (0.5, 3, True), (1.0, 3, False)]
)
def test_nobody_is_shown_elsewhere_with_certainty(delay_m: float, crew: int, unit: bool) -> None:
    """Believed until it was found, such a radio showed them elsewhere for 7 to 46 % of the time."""
    squares = [followed(world(seed, delay_m, crew, unit)) for seed in SEEDS]
    assert (np.concatenate(squares) > SURE).mean() < 0.04


@pytest.mark.parametrize("unit", [False, True])
def test_who_has_a_good_radio_is_shown_as_honestly(unit: bool) -> None:
    squares = np.concatenate([followed(world(seed, 0.0, 2, unit)) for seed in SEEDS])
    assert (squares < INSIDE).mean() > 0.95
    assert squares.mean() / 2.0 > 0.2


def test_two_pictures_are_the_same_before_and_after_a_restart() -> None:
    tracker, told = KirchhoffTracker(), world(51, 1.0)
    tracker.fold([r for r in told.readings if r.t <= 30.0])
    again = KirchhoffTracker.restore(tracker.snapshot())
    assert again.estimates() == tracker.estimates()


def test_looking_back_he_is_inside_and_evidence_is_as_unsure() -> None:
    """Looked back at with that radio believed, not one of his places was inside."""
    readings, ways = world(51, 0.8, crew=3, unit=True)
    smoother = BatchSmoother()
    track = smoother.smooth(readings)["ff0"]
    squares = [outside(p.position_m, p.covariance_m2, ways["ff0"][round(p.t)]) for p in track]
    assert np.mean(np.array(squares) < INSIDE) > 0.9
    evidence = smoother.evidence(readings, "ff0")
    assert evidence is not None
    assert evidence.covariance_m2 == pytest.approx(track[-1].covariance_m2, rel=0.02, abs=1e-4)
