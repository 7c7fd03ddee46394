"""Two search a floor with thick walls: most ranges are obstructed, a tenth wild; 10 minutes.

The breadcrumbs lie in the corridor, which is walked first; the rooms are searched on the way back.
"""

import numpy as np

from estimator.measurements import AnyReading
from estimator.simulate.base import Scenario, TrueTrack, in_posting_order
from estimator.simulate.breadcrumbs import drop_along
from estimator.simulate.building import STOREYS, Room
from estimator.simulate.itinerary import Itinerary
from estimator.simulate.radio import PathLoss, Uwb, calibrated
from estimator.simulate.team import (
    IN_THE_OFFICE,
    Kit,
    base_track,
    introduce,
    introduce_base,
    introduce_dropped,
    measured,
    radios_of,
    reported,
)

NAME = "heavy-obstruction"
DURATION_S = 600.0
ROOMS = {"ff1": ("s", (6, 5, 4, 3, 1)), "ff2": ("n", (6, 5, 4, 3, 2))}
LOSS = PathLoss(wall_db=7.0, sigma_db=6.0)
UWB = Uwb(range_m=30.0, wall_bias_m=1.0, wall_range=0.85, outlier_p=0.1, outlier_m=4.0)


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    tracks = {node: _search(node, rng) for node in ROOMS}
    crumbs = drop_along("b", "ff1", tracks["ff1"], rng, until_s=55.0)
    truth = tracks | {"base": base_track(DURATION_S)}
    radios = radios_of(truth, crumbs)
    readings: list[AnyReading] = [introduce_base(), *(introduce(n, t, rng, "E7") for n, t in tracks.items())]
    readings += introduce_dropped(crumbs)
    kit = Kit(site=IN_THE_OFFICE, loss=LOSS, uwb=calibrated(UWB, rng))
    for node in tracks:
        readings += measured(node, radios, DURATION_S, rng, kit)
    reports = in_posting_order(reported(readings, "engine-7", rng))
    truth |= {crumb.node: crumb.truth for crumb in crumbs}
    return Scenario(NAME, "Heavy obstruction", "recorded", STOREYS[:1], reports, truth, DURATION_S)


def _search(node: str, rng: np.random.Generator) -> TrueTrack:
    side, numbers = ROOMS[node]
    north_m = 0.4 if side == "n" else -0.4
    way = Itinerary((-2.0, north_m, 0.0), north_m, rng).wait(3.0).advance(44.0, 0.9)
    for number in numbers:
        way.search(Room(side, number, 0), 0.36).wait(10.0)
    return way.advance(-2.0, 0.8).track(DURATION_S)
