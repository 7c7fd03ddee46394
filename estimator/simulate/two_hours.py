"""A mission of two hours: three responders search two storeys in turns, resting at the door between."""

import numpy as np

from estimator.measurements import AnyReading
from estimator.simulate.base import Scenario, TrueTrack, in_posting_order
from estimator.simulate.breadcrumbs import drop_along
from estimator.simulate.building import STOREYS, Room
from estimator.simulate.itinerary import Itinerary
from estimator.simulate.radio import calibrated
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

NAME = "two-hours"
DURATION_S = 7200.0
REST_S = 180.0
NODES = ("ff1", "ff2", "ff3")


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    tracks = {node: _mission(index, rng) for index, node in enumerate(NODES)}
    crumbs = drop_along("b", "ff1", tracks["ff1"], rng, until_s=400.0)
    truth = tracks | {"base": base_track(DURATION_S)}
    radios = radios_of(truth, crumbs)
    readings: list[AnyReading] = [introduce_base(), *(introduce(n, t, rng, "E7") for n, t in tracks.items())]
    readings += introduce_dropped(crumbs)
    uwb = calibrated(TYPICAL_UWB, rng)
    kit = Kit(site=IN_THE_OFFICE, uwb=uwb, rssi_period_s=2.0, range_period_s=4.0)
    for node in tracks:
        readings += measured(node, radios, DURATION_S, rng, kit)
    reports = in_posting_order(reported(readings, "engine-7", rng))
    truth |= {crumb.node: crumb.truth for crumb in crumbs}
    return Scenario(NAME, "Two hours", "recorded", STOREYS[:2], reports, truth, DURATION_S)


def _mission(index: int, rng: np.random.Generator) -> TrueTrack:
    """Up one stairwell, two rooms, down the other, out to the door, a rest; again."""
    way = Itinerary((-2.0 - index, 0.3 * (index - 1), 0.0), 0.3 * (index - 1), rng).wait(2.0 + 20.0 * index)
    while way.t_s < DURATION_S:
        there, back = ("W", "E") if rng.random() < 0.5 else ("E", "W")
        way.take_stairs(there, 1, 0.6)
        for number in rng.integers(2, 7, size=2):
            way.search(Room("n" if rng.random() < 0.5 else "s", int(number), 1), 0.5).wait(10.0)
        way.take_stairs(back, 0, 0.6).advance(-2.0 - index, 0.8).wait(REST_S)
    return way.track(DURATION_S)
