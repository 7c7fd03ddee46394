"""Somebody without a unit, whose first place nobody gives, is shown as soon as readings tell of it."""

import numpy as np
import pytest

from estimator.estimate import Covariance6, Vector3
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker

SECONDS = 60
SURE = 20.0
"""Squared distance, in sigmas, beyond which a place is shown as certain that is wrong."""
SOON_S = 15.0
ALL = {"a": (0.0, 0.0), "b": (30.0, 0.0), "c": (30.0, 20.0), "d": (0.0, 20.0)}
TWO = {"a": (0.0, 0.0), "b": (30.0, 0.0)}
ONE = {"a": (0.0, 0.0)}


def way(second: float) -> Array:
    """To and fro through the middle, aside of the line through two of the radios."""
    return np.array([15.0 + 8.0 * np.sin(0.1 * second), 6.0 + 3.0 * np.cos(0.07 * second)])


def walked(radios: dict[str, tuple[float, float]], every_s: int, seed: int) -> list[AnyReading]:
    """What is posted of one walk: each second a range to one radio at most, to one after the other."""
    chance, names = np.random.default_rng(seed), sorted(radios)
    found: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*radios[name], 0.0), sigma_m=0.05) for name in names
    ]
    found.append(Node(t=0.0, node="ff1", role="responder"))
    for k, second in enumerate(range(2, SECONDS, every_s)):
        name = names[k % len(names)]
        off_m = float(np.hypot(*(way(second) - radios[name])) + chance.normal(0.0, 0.15))
        found.append(Range(t=float(second), a="ff1", b=name, range_m=off_m, technology="uwb"))
    return found


def squared(place_m: Vector3, covariance_m2: Covariance6, t: float) -> float:
    """How far off a place is, by what is said of it."""
    ee, en, _, nn, _, _ = covariance_m2
    off_m = np.array(place_m[:2]) - way(t)
    return float(off_m @ np.linalg.solve(np.array([[ee, en], [en, nn]]), off_m))


def shown(readings: list[AnyReading]) -> dict[float, float]:
    """How far off he is at each epoch at which he is shown, by what is said of it."""
    tracker, found = KirchhoffTracker(), dict[float, float]()
    for second in range(SECONDS):
        tracker.fold([reading for reading in readings if int(reading.t) == second])
        one = next((e for e in tracker.estimates() if e.node == "ff1"), None)
        if one is not None and one.position_m is not None and one.covariance_m2 is not None:
            found[one.t] = squared(one.position_m, one.covariance_m2, one.t)
    return found


@pytest.mark.parametrize("radios", [ALL, TWO])
@pytest.mark.parametrize("every_s", [1, 3])
def test_who_is_heard_rarely_is_shown_soon_and_nowhere_as_certain(
    radios: dict[str, tuple[float, float]], every_s: int
) -> None:
    for seed in range(3):
        found = shown(walked(radios, every_s, seed))
        assert min(found) < SOON_S
        assert max(found.values()) < SURE


def test_a_ring_about_one_radio_is_no_place_to_show() -> None:
    """Whichever side were shown, the covariance would be sure of it."""
    readings = walked(ONE, 1, 0)
    assert shown(readings) == {}
    assert "ff1" not in BatchSmoother().smooth(readings)


@pytest.mark.parametrize("radios", [ALL, TWO])
def test_his_smoothed_track_reaches_back_to_his_first_reading(
    radios: dict[str, tuple[float, float]],
) -> None:
    for seed in range(3):
        track = BatchSmoother().smooth(walked(radios, 3, seed))["ff1"]
        assert track[0].t <= 2.0
        assert max(squared(p.position_m, p.covariance_m2, p.t) for p in track if p.t >= 2.0) < SURE
