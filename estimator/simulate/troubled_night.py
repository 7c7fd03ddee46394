"""A search night on which something goes wrong, often more than one thing; 15 minutes.

Each by chance: a breadcrumb is kicked, one burns, somebody's radio is silent for one to three minutes, and
comes back, and a rescue crew goes in that drops nothing. The rest is drawn as in `search_night.py`.
"""

from dataclasses import replace

import numpy as np

from estimator.simulate import search_night
from estimator.simulate.base import Scenario, TrueTrack, in_posting_order
from estimator.simulate.breadcrumbs import kicked
from estimator.simulate.building import STOREYS, Room
from estimator.simulate.itinerary import Itinerary
from estimator.simulate.search_night import DURATION_S, GATEWAY, Night
from estimator.simulate.team import reported

NAME = "troubled-night"
KICKED_P, BURNT_P, SILENT_P, RESCUE_P = 0.5, 0.5, 0.5, 0.4
RESCUE = "rit"


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    night = _troubled(search_night.draw(rng), rng)
    off_s: dict[str, float] = {}
    if night.crumbs and rng.random() < BURNT_P:
        burnt = night.crumbs[int(rng.integers(len(night.crumbs)))]
        off_s[burnt.node] = burnt.t_s + float(rng.uniform(100.0, 600.0))
    radios = night.radios(off_s)
    if rng.random() < SILENT_P:
        lost = str(rng.choice(list(night.tracks)))
        since_s = float(rng.uniform(100.0, 700.0))
        radios[lost] = replace(radios[lost], silent_s=(since_s, since_s + float(rng.uniform(60.0, 180.0))))
    reports = in_posting_order(reported(search_night.readings_of(night, radios, rng), GATEWAY, rng))
    return Scenario(NAME, "A troubled night", "recorded", STOREYS, reports, night.truth, DURATION_S)


def _troubled(night: Night, rng: np.random.Generator) -> Night:
    """`night` with a breadcrumb that is kicked, and a crew to the rescue, by chance."""
    crumbs, tracks = list(night.crumbs), dict(night.tracks)
    if crumbs and rng.random() < KICKED_P:
        moved = int(rng.integers(len(crumbs)))
        crumbs[moved] = kicked(crumbs[moved], crumbs[moved].t_s + float(rng.uniform(30.0, 400.0)), rng)
    if rng.random() < RESCUE_P:
        start_s = float(rng.uniform(300.0, 600.0))
        room = Room("n" if rng.random() < 0.5 else "s", int(rng.integers(2, 7)), int(rng.integers(0, 3)))
        tracks |= {
            f"{RESCUE}-{n + 1}": _rescue(n, start_s, room, rng) for n in range(int(rng.integers(2, 4)))
        }
    return replace(night, crumbs=crumbs, tracks=tracks)


def _rescue(number: int, start_s: float, room: Room, rng: np.random.Generator) -> TrueTrack:
    """Waits outside, goes to `room` when called at `start_s`, stays for some minutes, and comes out."""
    beside_m = 0.4 * (number - 1)
    way = Itinerary((-4.0 - number, beside_m, 0.0), beside_m, rng).wait_until(start_s + 2.0 * number)
    if room.level:
        way.take_stairs("W", room.level, 0.6)
    way.enter(room, 0.4 * (number - 1), 0.5, 0.7).wait(float(rng.uniform(60.0, 150.0))).leave(room, 0.5)
    if room.level:
        way.take_stairs("W", 0, 0.5)
    return way.advance(-4.0 - number, 0.7).track(DURATION_S)
