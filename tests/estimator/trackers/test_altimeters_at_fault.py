"""Altimeters that drift or jump while their bearers are inside: nobody is sure of a wrong storey by them."""

from collections.abc import Callable
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
STEPS, STEP_M, SIGMA_M, WALK_S = 10, 0.3, 0.5, 70
CREW = ("ff1", "ff2", "ff3")
CLIMBS = {"ff1": (60, 110), "ff2": (130,), "ff3": (85, 190)}
Off = Callable[[str, int], float]


class Storeys(NamedTuple):
    """Seconds on a floor, those sure (p > 0.9) of its storey, and those sure of another one."""

    seconds: int
    right: int
    wrong: int


def followed(off_m: Off, seed: int, sees_stairs: bool, until_s: int = 400) -> Storeys:
    """Three of a crew enter, walk about with halts, and climb.

    Args:
        off_m: what an altimeter reads too much, by its bearer and the second (m).
        seed: of the noise.
        sees_stairs: their units measure heights.
        until_s: how long they are inside (s).
    """
    chance, tracker, found = np.random.default_rng(seed), KirchhoffTracker(), []
    tracker.fold(
        [
            BASE,
            *(Node(t=0.0, node=n, role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3) for n in CREW),
        ]
    )
    up_m = dict.fromkeys(CREW, 0.0)
    for second in range(1, until_s + 1):
        readings: list[AnyReading] = []
        climbing = {n: any(begin <= second < begin + STEPS for begin in CLIMBS[n]) for n in CREW}
        for name in CREW:
            up_m[name] += STEP_M * climbing[name]
            walks = climbing[name] or (second + 20 * CREW.index(name)) % WALK_S > 15
            east_m = 0.5 * walks * (1.0 if second // WALK_S % 2 else -1.0)
            seen_m = STEP_M * climbing[name] + (0.02 * chance.normal() if sees_stairs else 0.0)
            seen_m *= sees_stairs
            readings.append(Displacement(t=float(second), node=name, delta_m=(east_m, 0.0, seen_m)))
            if second % 2 == 0:
                height_m = float(up_m[name] + off_m(name, second) + 0.3 * chance.normal())
                readings.append(Altitude(t=float(second), node=name, up_m=height_m, sigma_m=SIGMA_M))
        tracker.fold(readings)
        for name in CREW:
            here = shown(tracker, name)
            assert here.position_m is not None
            assert here.covariance_m2 is not None
            storey = most_probable(LEVELS, here.position_m[2], here.covariance_m2[5])
            assert storey is not None
            if not climbing[name]:
                found.append((storey.level == round(up_m[name] / 3.0), storey.probability > 0.9))
    right = sum(fits and sure for fits, sure in found)
    return Storeys(len(found), right, sum(sure and not fits for fits, sure in found))


def good(_name: str, _second: int) -> float:
    return 0.0


def fan(_name: str, second: int) -> float:
    """A fan at the door, from 230 s to 330 s: 36 Pa more inside."""
    return -3.0 if 230 < second < 330 else 0.0


def replaced(name: str, second: int) -> float:
    """The altimeter of one of them is another one, which nobody has zeroed."""
    return -3.0 if name == "ff1" and second > 230 else 0.0


def weather(_name: str, second: int) -> float:
    """A front passes: 1 hPa in an hour."""
    return 8.3 * second / 3600.0


@pytest.mark.parametrize("sees_stairs", [True, False])
@pytest.mark.parametrize("off_m", [fan, replaced])
def test_an_altimeter_that_jumps_makes_nobody_sure_of_a_wrong_storey(off_m: Off, sees_stairs: bool) -> None:
    """Believed, they did for up to a third of the time."""
    found = followed(off_m, 5, sees_stairs)
    assert found.wrong <= 0.01 * found.seconds


def test_a_step_of_pressure_is_not_taken_for_stairs_that_no_unit_has_seen() -> None:
    found = followed(fan, 6, sees_stairs=True)
    assert found.right > 0.9 * found.seconds


def test_who_carries_another_altimeter_leaves_the_others_sure() -> None:
    found = followed(replaced, 7, sees_stairs=True)
    assert found.right > (2.0 / 3.0) * found.seconds


@pytest.mark.parametrize("sees_stairs", [True, False])
def test_weather_makes_nobody_sure_of_a_wrong_storey(sees_stairs: bool) -> None:
    found = followed(weather, 8, sees_stairs, until_s=900)
    assert found.wrong <= 0.01 * found.seconds


@pytest.mark.parametrize(("sees_stairs", "least"), [(True, 0.97), (False, 0.75)])
def test_good_altimeters_tell_the_storey(sees_stairs: bool, least: float) -> None:
    found = followed(good, 9, sees_stairs)
    assert found.right > least * found.seconds
    assert found.wrong == 0
