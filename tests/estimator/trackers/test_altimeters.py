"""Altimeters that nobody has zeroed: whose bearer stands at the door, they do not put on another storey."""

from typing import NamedTuple

import numpy as np
import pytest

from estimator.levels import most_probable
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, shown

LEVELS = [(0, "G", 0.0), (1, "1", 3.0), (2, "2", 6.0)]
SECONDS, CLIMBS, STEPS, STEP_M = 150, (60, 110), 10, 0.3
SIGMA_M = 0.6


class Storeys(NamedTuple):
    """Seconds on a floor, those sure (p > 0.9) of its storey, and those sure of another one."""

    seconds: int
    right: int
    wrong: int


def followed(off_m: float, seed: int, told_sigma_m: float | None, sees_stairs: bool) -> Storeys:
    """He enters, walks about and climbs twice, with an altimeter that is off by so much.

    Args:
        off_m: by how much.
        seed: of the noise.
        told_sigma_m: with which the height of the door is told; None: it is the base's, as nobody tells.
        sees_stairs: his unit measures heights.
    """
    chance, up_m, tracker, found = np.random.default_rng(seed), 0.0, KirchhoffTracker(), []
    at = None if told_sigma_m is None else (0.0, 0.0, 0.0)
    tracker.fold([BASE, Node(t=0.0, node="ff1", role="responder", position_m=at, sigma_m=told_sigma_m)])
    for second in range(1, SECONDS + 1):
        climbs = any(begin <= second < begin + STEPS for begin in CLIMBS)
        up_m += STEP_M * climbs
        reported_m = STEP_M * climbs + chance.normal(0.0, 0.02) if sees_stairs else 0.0
        height_m = float(up_m + off_m + chance.normal(0.0, SIGMA_M / 2.0))
        readings: list[AnyReading] = [
            Displacement(t=float(second), node="ff1", delta_m=(0.8, 0.0, reported_m)),
            Altitude(t=float(second), node="ff1", up_m=height_m, sigma_m=SIGMA_M),
        ]
        tracker.fold(readings)
        here = shown(tracker)
        assert here.position_m is not None
        assert here.covariance_m2 is not None
        storey = most_probable(LEVELS, here.position_m[2], here.covariance_m2[5])
        assert storey is not None
        if not climbs:
            found.append((storey.level == round(up_m / 3.0), storey.probability > 0.9))
    right = sum(fits and sure for fits, sure in found)
    return Storeys(len(found), right, sum(sure and not fits for fits, sure in found))


@pytest.mark.parametrize("off_m", [-4.0, 2.0, 4.0])
@pytest.mark.parametrize("told_sigma_m", [0.3, 1.0, None])
@pytest.mark.parametrize("sees_stairs", [True, False])
def test_an_altimeter_that_is_off_makes_nobody_sure_of_a_wrong_storey(
    off_m: float, told_sigma_m: float | None, sees_stairs: bool
) -> None:
    """Believed, those of four metres did for up to two thirds of the time."""
    assert sum(followed(off_m, seed, told_sigma_m, sees_stairs).wrong for seed in (1, 2)) == 0


@pytest.mark.parametrize("off_m", [0.0, -4.0, 4.0])
def test_at_a_door_whose_height_is_told_it_is_zeroed_and_tells_the_storey(off_m: float) -> None:
    seconds, right, _ = followed(off_m, 3, 0.3, sees_stairs=True)
    assert right > 0.9 * seconds


def test_one_that_was_zeroed_tells_the_storey_wherever_he_entered() -> None:
    seconds, right, _ = followed(0.0, 4, None, sees_stairs=True)
    assert right > 0.9 * seconds
