"""Crews ride in lifts and fall through floors; their units tell that they stand where they are (0127)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest

from estimator.estimate import Covariance6, Vector3
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.simulate.vitals import pressure_pa
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE
from tests.estimator.trackers.restarts import assert_goes_on_alike
from tests.estimator.trackers.storeys import STOREY_M, Judged, Storeys, counted, judged

CREW, OTHER = ("ff1", "ff2", "ff3"), "ff4"
SECONDS, RIDES_S, WALK_S, STAIR_S = 260, 100, 70, 12
GROUND_PA = 100_000.0


class Incident(NamedTuple):
    """What happens to a crew that walks about on the ground floor, and to another one's who stays there.

    Attributes:
        up_m: so far they ride or fall (m).
        speed_mps: how fast.
        names: who is inside.
        altimeters: who has an altimeter.
        sees_stairs: their units measure heights, but not where they ride.
        by_pressure: they tell air pressures.
        waits_s: since when before it they stand, and until when after it (s).
        climbs: who stays below climbs a stair instead, at the same time.
        silent_s: for so long from the ride on nothing of them is heard; then their steps come as one.
        pressed_m: what all altimeters read less from `RIDES_S` on, for 100 s (m).
    """

    up_m: float = STOREY_M
    speed_mps: float = 1.5
    names: Sequence[str] = (*CREW, OTHER)
    altimeters: Sequence[str] = (*CREW, OTHER)
    sees_stairs: bool = True
    by_pressure: bool = False
    waits_s: tuple[int, int] = (-4, 4)
    climbs: bool = False
    silent_s: int = 0
    pressed_m: float = 0.0

    def height_m(self, name: str, second: int) -> float:
        """How high somebody truly is (m)."""
        if name == OTHER:
            return self.climbs * STOREY_M * min(max(second - RIDES_S + 6, 0) / STAIR_S, 1.0)
        risen_m = min(max(second - RIDES_S, 0) * self.speed_mps, abs(self.up_m))
        return float(np.sign(self.up_m)) * risen_m

    def told(self, seed: int) -> list[AnyReading]:
        """All that is told of them, in order of epoch."""
        chance, rides_s = np.random.default_rng(seed), abs(self.up_m) / self.speed_mps
        places = {name: (20.0 if name == OTHER else 0.0, float(i), 0.0) for i, name in enumerate(self.names)}
        told: list[AnyReading] = [
            BASE,
            *(Node(t=0.0, node=n, role="responder", position_m=at, sigma_m=0.3) for n, at in places.items()),
        ]
        for second in range(1, SECONDS + 1):
            t = float(second)
            if self.by_pressure and second % 5 == 1:
                told.append(Pressure(t=t, node="base", pressure_pa=float(GROUND_PA + 2.5 * chance.normal())))
            for i, name in enumerate(self.names):
                stands = (second + 20 * (name == OTHER)) % WALK_S <= 15
                if name != OTHER:
                    stands |= self.waits_s[0] < second - RIDES_S < rides_s + self.waits_s[1]
                stands &= not (self.climbs and name == OTHER and abs(second - RIDES_S) < STAIR_S)
                east_m = 0.0 if stands else 0.5 * (1.0 if second // WALK_S % 2 else -1.0)
                noise_m = (0.002 if stands else 0.02) * chance.normal(0.0, 1.0, 3)
                seen_m = float(noise_m[2]) if self.sees_stairs else 0.0
                delta_m = (east_m + float(noise_m[0]), float(noise_m[1]), seen_m)
                heard_s = 0 if name == OTHER else second - RIDES_S
                if 0 < heard_s <= self.silent_s:
                    continue
                from_t = t - 1.0 - (self.silent_s if heard_s == self.silent_s + 1 else 0)
                told.append(Displacement(t=t, from_t=from_t, node=name, delta_m=delta_m))
                if name not in self.altimeters or (second + i) % 2:
                    continue
                reads_m = self.height_m(name, second) - self.pressed_m * (0 < second - RIDES_S <= 100)
                if self.by_pressure:
                    pa = float(pressure_pa(np.array([reads_m]), GROUND_PA)[0] + 2.5 * chance.normal())
                    told.append(Pressure(t=t, node=name, pressure_pa=pa))
                else:
                    told.append(
                        Altitude(t=t, node=name, up_m=float(reads_m + 0.3 * chance.normal()), sigma_m=0.5)
                    )
        return told

    def judged(
        self, name: str, second: int, position_m: Vector3 | None, covariance_m2: Covariance6 | None
    ) -> Judged:
        """See `storeys.judged`."""
        return judged(self.height_m(name, second), position_m, covariance_m2)


def live(incident: Incident, seed: int, of: Sequence[str] = ()) -> Storeys:
    """What is shown while it goes on."""
    tracker, found, coming = KirchhoffTracker(), list[Judged](), incident.told(seed)
    for second in range(SECONDS + 1):
        tracker.fold([reading for reading in coming if reading.t == second])
        for e in tracker.estimates():
            if second and e.node in (of or incident.names):
                found.append(incident.judged(e.node, second, e.position_m, e.covariance_m2))
    return counted(found)


def looking_back(incident: Incident, seed: int, of: Sequence[str] = ()) -> Storeys:
    """What is shown when all is known."""
    found = list[Judged]()
    for name, points in BatchSmoother().smooth(incident.told(seed)).items():
        for point in points:
            if name in (of or incident.names) and point.t == int(point.t):
                found.append(incident.judged(name, int(point.t), point.position_m, point.covariance_m2))
    return counted(found)


def notices(incident: Incident, seed: int) -> list[str]:
    tracker, texts = KirchhoffTracker(), list[str]()
    coming = incident.told(seed)
    for second in range(SECONDS + 1):
        tracker.fold([reading for reading in coming if reading.t == second])
        texts += [notice.text for notice in tracker.take_notices() if notice.code == "conflict"]
    return texts


@pytest.mark.parametrize("sees_stairs", [True, False])
@pytest.mark.parametrize(("storeys", "speed_mps"), [(1, 1.5), (3, 1.5), (10, 2.5), (-2, 1.5)])
def test_a_crew_in_a_lift_is_shown_on_the_storey_that_it_has_got_to(
    sees_stairs: bool, storeys: int, speed_mps: float
) -> None:
    """Its altimeters were taken to be wrong, as none of its units climbed: it stayed on the ground floor."""
    ride = Incident(STOREY_M * storeys, speed_mps, sees_stairs=sees_stairs)
    shown, back = live(ride, 1), looking_back(ride, 1)
    assert shown.wrong < 0.01 * shown.seconds
    assert shown.right > 0.65 * shown.seconds
    assert back.wrong == 0
    assert back.right > 0.95 * back.seconds


def test_where_all_who_are_inside_ride_it_is_told_as_well() -> None:
    ride = Incident(3.0 * STOREY_M, names=CREW)
    shown = live(ride, 2)
    assert shown.wrong < 0.01 * shown.seconds
    assert shown.right > 0.9 * shown.seconds


def test_a_crew_that_climbs_a_stair_meanwhile_does_not_make_it_a_step_of_pressure() -> None:
    """Its units see none, and its altimeters rise by as much."""
    ride = Incident(sees_stairs=False, climbs=True)
    shown, back = live(ride, 8, CREW), looking_back(ride, 8, CREW)
    assert shown.wrong < 0.02 * shown.seconds
    assert back.wrong == 0
    assert [text for text in notices(ride, 8) if "ff2, ff1, ff3 may have gone up" in text]


@pytest.mark.parametrize("sees_stairs", [True, False])
def test_a_crew_that_is_silent_in_a_lift_of_steel_is_shown_where_it_got_out(sees_stairs: bool) -> None:
    ride = Incident(3.0 * STOREY_M, sees_stairs=sees_stairs, silent_s=13)
    back = looking_back(ride, 9)
    assert back.wrong == 0
    assert back.right > 0.9 * back.seconds


def test_air_pressures_tell_of_a_ride_of_one_storey() -> None:
    ride = Incident(by_pressure=True)
    shown, back = live(ride, 3), looking_back(ride, 3)
    assert shown.wrong < 0.02 * shown.seconds
    assert back.wrong == 0


@pytest.mark.parametrize("up_m", [STOREY_M, -STOREY_M])
def test_of_who_rides_or_falls_alone_nobody_is_sure_where_he_is(up_m: float) -> None:
    """His altimeter may be wrong as well: both are said, within seconds."""
    alone = Incident(up_m, names=("ff1", OTHER))
    shown, back = live(alone, 4), looking_back(alone, 4)
    assert shown.wrong < 0.02 * shown.seconds
    assert back.wrong < 0.02 * back.seconds
    assert [text for text in notices(alone, 4) if "by a lift or a fall" in text]


def test_who_stands_beside_who_rides_may_ride_with_him() -> None:
    """He has no altimeter, and was surely shown on the ground floor."""
    ride = Incident(3.0 * STOREY_M, altimeters=("ff1", OTHER))
    assert live(ride, 5, of=("ff2", "ff3")).wrong < 40


@pytest.mark.parametrize(("sees_stairs", "least"), [(True, 0.95), (False, 0.6)])
def test_a_step_of_pressure_on_a_crew_that_stands_together_makes_nobody_sure(
    sees_stairs: bool, least: float
) -> None:
    """36 Pa, and back: when that is undone, where they walk, it has told what it was."""
    pressed = Incident(0.0, names=CREW, sees_stairs=sees_stairs, pressed_m=3.0)
    shown, back = live(pressed, 6), looking_back(pressed, 6)
    assert shown.wrong == 0
    assert back.wrong == 0
    assert back.right > least * back.seconds


def test_a_crew_that_walks_into_a_stairwell_under_pressure_and_waits_there_has_not_fallen() -> None:
    """50 Pa, which keep it free of smoke."""
    pressed = Incident(0.0, names=CREW, pressed_m=4.2, waits_s=(2, 30))
    shown, back = live(pressed, 10), looking_back(pressed, 10)
    assert shown.wrong == 0
    assert shown.right > 0.9 * shown.seconds
    assert back.right > 0.9 * back.seconds


@pytest.mark.parametrize("stopped_s", [5, 11, 30])
def test_a_tracker_that_is_stopped_in_the_midst_of_a_ride_goes_on_alike(stopped_s: int) -> None:
    assert_goes_on_alike(Incident(10.0 * STOREY_M, 2.5).told(7), RIDES_S + stopped_s)
