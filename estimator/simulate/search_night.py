"""A night as any other: crews search the office, change storeys, come out for air and go in again; 15 min.

Drawn at random: how many crews and people, whether they have UWB and altimeters, how many vehicles stand in
the yard as anchors, whether a UAV flies, and all ways. Nothing is at fault.
"""

from dataclasses import dataclass

import numpy as np

from estimator.measurements import AnyReading, Node
from estimator.simulate.base import FloatArray, Scenario, TrueTrack, in_posting_order, static_track
from estimator.simulate.breadcrumbs import Dropped, drop_along
from estimator.simulate.building import STOREYS, Room
from estimator.simulate.itinerary import Itinerary
from estimator.simulate.links import Radio
from estimator.simulate.radio import Uwb, calibrated
from estimator.simulate.team import (
    IN_THE_OFFICE,
    TYPICAL_UWB,
    Kit,
    base_track,
    introduce,
    introduce_base,
    introduce_dropped,
    measured,
    radios_of,
    reported,
)
from estimator.simulate.uav import circle, flight_readings

NAME = "search-night"
DURATION_S = 900.0
CREWS_P, PEOPLE_P, VEHICLES_P = (0.3, 0.5, 0.2), (0.2, 0.4, 0.4), (0.4, 0.25, 0.2, 0.15)
"""How often there are 1, 2 or 3 crews; 1, 2 or 3 people in one; no vehicle, 1, 2 or 3."""
UWB_P, ALTIMETERS_P, UAV_P = 0.75, 0.8, 0.5
GATEWAY = "engine-7"
VEHICLE_SIGMA_M = 0.2


@dataclass(frozen=True, slots=True)
class Night:
    """What is drawn before anything is measured.

    Attributes:
        tracks: of the responders, by node; the crew's name comes first: `c1-2`.
        crumbs: breadcrumbs, dropped by each crew's first.
        vehicles: the anchors' places.
        uav: its way; None: there is none.
        uwb: the incident's radios; None: there are none.
        altimeters: the crews that have them.
    """

    tracks: dict[str, TrueTrack]
    crumbs: list[Dropped]
    vehicles: dict[str, TrueTrack]
    uav: TrueTrack | None
    uwb: Uwb | None
    altimeters: frozenset[str]

    @property
    def truth(self) -> dict[str, TrueTrack]:
        """The true tracks of all nodes."""
        lying = {crumb.node: crumb.truth for crumb in self.crumbs}
        flying = {} if self.uav is None else {"uav-1": self.uav}
        return self.tracks | lying | self.vehicles | flying | {"base": base_track(DURATION_S)}

    def radios(self, off_s: dict[str, float] | None = None) -> dict[str, Radio]:
        """The radios that hear each other; `off_s`: when one dies (s)."""
        standing = self.vehicles | {"base": base_track(DURATION_S)}
        return radios_of(self.tracks | standing, self.crumbs, off_s)


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    night = draw(rng)
    reports = in_posting_order(reported(readings_of(night, night.radios(), rng), GATEWAY, rng))
    return Scenario(NAME, "Search of an office", "recorded", STOREYS, reports, night.truth, DURATION_S)


def draw(rng: np.random.Generator) -> Night:
    """A night at random."""
    crews = [f"c{number + 1}" for number in range(1 + int(rng.choice(3, p=CREWS_P)))]
    tracks: dict[str, TrueTrack] = {}
    crumbs: list[Dropped] = []
    for order, crew in enumerate(crews):
        for number in range(1 + int(rng.choice(3, p=PEOPLE_P))):
            tracks[f"{crew}-{number + 1}"] = _search(order, number, rng)
        first = tracks[f"{crew}-1"]
        crumbs += drop_along(f"{crew}-b", f"{crew}-1", first, rng, until_s=float(rng.uniform(150.0, 400.0)))
    vehicles = {f"v{i + 1}": _parked(rng) for i in range(int(rng.choice(4, p=VEHICLES_P)))}
    return Night(
        tracks,
        crumbs,
        vehicles,
        circle(DURATION_S) if rng.random() < UAV_P else None,
        calibrated(TYPICAL_UWB, rng) if rng.random() < UWB_P else None,
        frozenset(crew for crew in crews if rng.random() < ALTIMETERS_P),
    )


def readings_of(night: Night, radios: dict[str, Radio], rng: np.random.Generator) -> list[AnyReading]:
    """All that is told and measured in `night` by `radios`."""
    readings: list[AnyReading] = [introduce_base()]
    readings += [introduce(node, track, rng, crew_of(node)) for node, track in night.tracks.items()]
    readings += [_introduce_vehicle(node, track, rng) for node, track in night.vehicles.items()]
    readings += introduce_dropped(night.crumbs, {node: crew_of(node) for node in night.tracks})
    for node in night.tracks:
        altitude_sigma_m = 0.4 if crew_of(node) in night.altimeters else None
        kit = Kit(site=IN_THE_OFFICE, uwb=night.uwb, altitude_sigma_m=altitude_sigma_m)
        readings += measured(node, radios, DURATION_S, rng, kit)
    if night.uav is None:
        return readings
    ranged = {node: radios[node] for node in night.tracks}
    readings.append(Node(t=0.0, node="uav-1", role="uav", callsign="UAV 1"))
    return readings + flight_readings("uav-1", night.uav, ranged, night.uwb, rng)


def crew_of(node: str) -> str:
    """The crew of a responder."""
    return node.partition("-")[0]


def _search(order: int, number: int, rng: np.random.Generator) -> TrueTrack:
    """In, from room to room on one storey or two, out for air, and in again, until the night is over."""
    beside_m = float(rng.uniform(-0.5, 0.5))
    outside_m = -2.0 - number - 1.5 * order
    way = Itinerary((outside_m, beside_m, 0.0), beside_m, rng)
    way.wait(2.0 + 1.5 * number + order * float(rng.uniform(5.0, 90.0)))
    while way.t_s < DURATION_S:
        for _ in range(1 + int(rng.integers(0, 2))):
            level = _change_storey(way, rng)
            for room in rng.integers(2, 7, size=int(rng.integers(1, 4))):
                way.search(Room("n" if rng.random() < 0.5 else "s", int(room), level), 0.45)
                way.wait(float(rng.uniform(0.0, 40.0)))
        if way.level:
            way.take_stairs(_stairwell(rng), 0, 0.55)
        way.advance(outside_m, 0.8).wait(float(rng.uniform(30.0, 150.0)))
    return way.track(DURATION_S)


def _change_storey(way: Itinerary, rng: np.random.Generator) -> int:
    """By either stairwell to a storey at random, which may be the same one."""
    level = int(rng.integers(0, len(STOREYS)))
    if level != way.level:
        way.take_stairs(_stairwell(rng), level, 0.55)
    return level


def _stairwell(rng: np.random.Generator) -> str:
    return "W" if rng.random() < 0.5 else "E"


def _parked(rng: np.random.Generator) -> TrueTrack:
    """A vehicle west of the door, or before either long side."""
    if rng.random() < 0.4:
        place = np.array([rng.uniform(-15.0, -5.0), rng.uniform(-12.0, 12.0), 1.5])
    else:
        side = 1.0 if rng.random() < 0.5 else -1.0
        place = np.array([rng.uniform(0.0, 52.0), side * rng.uniform(13.0, 20.0), 1.5])
    return static_track(place, 0, 0.0, DURATION_S)


def _introduce_vehicle(node: str, truth: TrueTrack, rng: np.random.Generator) -> Node:
    """A vehicle whose place is told to `VEHICLE_SIGMA_M`."""
    told: FloatArray = truth.position_m[0] + rng.normal(0.0, VEHICLE_SIGMA_M, 3)
    east, north, up = (round(float(metres), 2) for metres in told)
    return Node(
        t=0.0,
        node=node,
        role="anchor",
        callsign=node,
        position_m=(east, north, up),
        sigma_m=VEHICLE_SIGMA_M,
    )
