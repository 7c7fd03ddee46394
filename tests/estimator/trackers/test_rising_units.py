"""Units whose heights rise or fall with each metre, as those of boots do (paper C; decision 0128)."""

from typing import NamedTuple

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE
from tests.estimator.trackers.restarts import assert_goes_on_alike
from tests.estimator.trackers.storeys import STOREY_M, Judged, Storeys, counted, judged

PACE_M, NOISE_M, FLIGHT_S = 0.7, 0.03, 12


def along(seconds: int, slope: float = 0.0) -> Array:
    """To and fro in a corridor; or onward, where it is not level, m × 3 (m)."""
    towards = np.where(np.arange(seconds) // 28 % 2 == 0, 1.0, -1.0) if slope == 0.0 else np.ones(seconds)
    return np.column_stack([PACE_M * towards, np.zeros(seconds), np.full(seconds, PACE_M * slope)])


def stair(storeys: int) -> Array:
    """Flights of a stairwell, m × 3 (m)."""
    seconds = FLIGHT_S * abs(storeys)
    towards = np.where(np.arange(seconds) // 6 % 2 == 0, 0.5, -0.5)
    return np.column_stack([towards, np.full(seconds, 0.05), np.full(seconds, STOREY_M * storeys / seconds)])


class Walker(NamedTuple):
    """Somebody who walks from the door on, by what his unit tells.

    Attributes:
        way: his steps, second by second, m × 3 (m).
        rises: what his unit's heights rise by for each metre of way (m/m).
        altimeter: he has one.
    """

    way: Array
    rises: float
    altimeter: bool = False

    @property
    def heights_m(self) -> Array:
        """How high he truly is, from the door on (m)."""
        return np.concatenate([[0.0], np.cumsum(self.way[:, 2])])

    def told(self, seed: int) -> list[AnyReading]:
        """All that is told of him, in order of epoch."""
        chance = np.random.default_rng(seed)
        told = self.way + NOISE_M * chance.normal(size=self.way.shape)
        told[:, 2] += self.rises * np.hypot(self.way[:, 0], self.way[:, 1])
        place = Node(t=0.0, node="ff1", role="responder", position_m=(2.0, 0.0, 0.0), sigma_m=0.3)
        readings: list[AnyReading] = [BASE, place]
        for i, (east_m, north_m, up_m) in enumerate(told.tolist()):
            t = float(i + 1)
            readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(east_m, north_m, up_m)))
            if self.altimeter and i % 2:
                reads_m = float(self.heights_m[i + 1] + 0.4 * chance.normal())
                readings.append(Altitude(t=t, node="ff1", up_m=reads_m, sigma_m=0.4))
        return readings

    def live(self, seed: int) -> Storeys:
        """What is shown while he walks."""
        tracker, found, coming = KirchhoffTracker(), list[Judged](), self.told(seed)
        for second, height_m in enumerate(self.heights_m.tolist()):
            tracker.fold([reading for reading in coming if reading.t == second])
            shown = {e.node: e for e in tracker.estimates()}["ff1"]
            if second:
                found.append(judged(height_m, shown.position_m, shown.covariance_m2))
        return counted(found)

    def looking_back(self, seed: int) -> Storeys:
        """What is shown when all is known."""
        points = BatchSmoother().smooth(self.told(seed))["ff1"]
        heights_m = np.interp([point.t for point in points], np.arange(len(self.heights_m)), self.heights_m)
        each = zip(points, heights_m.tolist(), strict=True)
        return counted([judged(height_m, point.position_m, point.covariance_m2) for point, height_m in each])


SEARCH = np.concatenate([along(250), stair(1), along(150), stair(2), along(100), stair(-1), along(60)])


@pytest.mark.parametrize("altimeter", [False, True])
@pytest.mark.parametrize("rises", [-0.04, 0.0, 0.02, 0.04])
def test_who_walks_far_on_a_floor_has_not_left_it(rises: float, altimeter: bool) -> None:
    """By 4 cm a metre he was surely on a wrong storey half of the time, with an altimeter a third of it."""
    walker = Walker(SEARCH, rises, altimeter)
    shown, back = walker.live(1), walker.looking_back(1)
    assert shown.wrong == 0
    assert shown.right > 0.9 * shown.seconds
    assert back.wrong == 0
    assert back.right > 0.98 * back.seconds


@pytest.mark.parametrize("altimeter", [False, True])
@pytest.mark.parametrize("rises", [-0.02, 0.0])
def test_who_walks_up_a_garage_has_left_the_ground_floor(rises: float, altimeter: bool) -> None:
    """A ramp round and round of 8 %, three storeys high, after he has walked on the level."""
    ramp = along(round(3.0 * STOREY_M / (0.08 * PACE_M)), 0.08)
    walker = Walker(np.concatenate([along(60), ramp, along(120)]), rises, altimeter)
    shown, back = walker.live(2), walker.looking_back(2)
    assert shown.wrong == 0
    assert shown.right > (0.98 if altimeter else 0.25) * shown.seconds
    assert back.wrong == 0


@pytest.mark.parametrize("altimeter", [False, True])
@pytest.mark.parametrize("slope", [0.04, 0.07])
def test_of_who_comes_up_a_hill_only_an_altimeter_is_sure(slope: float, altimeter: bool) -> None:
    """His unit may rise, or the ground."""
    walker = Walker(np.concatenate([along(200, slope), along(150)]), 0.0, altimeter)
    shown, back = walker.live(5), walker.looking_back(5)
    assert shown.wrong == 0
    assert back.wrong == 0
    assert (shown.right > 0.95 * shown.seconds) == altimeter


@pytest.mark.parametrize(("rises", "told"), [(0.0, None), (0.04, "rise"), (-0.04, "fall")])
def test_it_is_told_that_a_unit_rises(rises: float, told: str | None) -> None:
    tracker, texts = KirchhoffTracker(), list[str]()
    for reading in Walker(SEARCH[:200], rises).told(3):
        tracker.fold([reading])
        tracker.estimates()
        texts += [notice.text for notice in tracker.take_notices()]
    told_of = [text for text in texts if f"the heights of ff1 {told} by themselves, by about" in text]
    assert len(told_of) == (1 if told else 0)


@pytest.mark.parametrize("stopped_s", [90, 450])
def test_a_tracker_that_is_stopped_goes_on_alike(stopped_s: int) -> None:
    """The later one has forgotten the first legs, but for what they told."""
    assert_goes_on_alike(Walker(SEARCH, 0.03).told(4), stopped_s)
