"""A crew upstairs in an office, whom vehicles in the street hear far too weakly (decision 0123)."""

import numpy as np

from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.simulate.base import TrueTrack, static_track
from estimator.simulate.breadcrumbs import drop_along
from estimator.simulate.building import DEPTH_M, Room
from estimator.simulate.itinerary import Itinerary
from estimator.simulate.team import (
    IN_THE_OFFICE,
    Kit,
    base_track,
    introduce,
    introduce_base,
    introduce_dropped,
    measured,
    radios_of,
)
from estimator.trackers import smoother
from estimator.trackers.base import TrackerSettings
from tests.estimator.trackers.shown import followed, surely_elsewhere

SECONDS = 360
VEHICLES_M = {"engine": (12.0, -DEPTH_M - 8.0, 2.0), "ladder": (34.0, -DEPTH_M - 8.0, 2.0)}
"""On the side of the street."""
SEEDS = range(8)


def night(seed: int) -> tuple[list[AnyReading], dict[str, TrueTrack]]:
    """Two of a crew go up by the western stairwell and search rooms upstairs, told by powers alone."""
    rng = np.random.default_rng(seed)
    tracks = {f"ff{number}": _search(number, rng) for number in (1, 2)}
    crumbs = drop_along("b", "ff1", tracks["ff1"], rng, until_s=150.0)
    standing = {name: static_track(np.array(at), 0, 0.0, SECONDS) for name, at in VEHICLES_M.items()}
    radios = radios_of(tracks | standing | {"base": base_track(SECONDS)}, crumbs)
    readings: list[AnyReading] = [introduce_base()]
    readings += [
        Node(t=0.0, node=name, role="anchor", position_m=at, sigma_m=0.2) for name, at in VEHICLES_M.items()
    ]
    readings += [introduce(name, track, rng, "E7") for name, track in tracks.items()]
    readings += introduce_dropped(crumbs)
    for name in tracks:
        readings += measured(name, radios, SECONDS, rng, Kit(site=IN_THE_OFFICE))
    return sorted(readings, key=lambda reading: reading.until_t), tracks


def _search(number: int, rng: np.random.Generator) -> TrueTrack:
    way = Itinerary((-2.0 - number, 0.0, 0.0), 0.3 * number, rng).wait(5.0 * number)
    way.advance(4.0, 0.9).take_stairs("W", 1, 0.6)
    while way.t_s < SECONDS:
        side, door = ("s", int(rng.integers(1, 8))) if rng.random() < 0.6 else ("n", int(rng.integers(2, 7)))
        way.search(Room(side, door, 1), 0.45).wait(10.0)
    return way.track(SECONDS)


def test_who_is_heard_too_weakly_by_vehicles_in_the_street_is_not_shown_elsewhere_as_sure() -> None:
    """Of 5,760 seconds. With what walls take counted link by link, three of these nights have 453 and 955."""
    live = back = 0
    for seed in SEEDS:
        readings, tracks = night(seed)
        live += surely_elsewhere(followed(readings, list(tracks), SECONDS), tracks)
        back += surely_elsewhere(smoother("kirchhoff", TrackerSettings()).smooth(readings), tracks)
    assert live < 80
    assert back == 0
