"""Three responders share the breadcrumbs of the first one on two storeys; 10 minutes.

ff1 goes in along the ground floor, up stairwell E, back along the first floor and down stairwell W, dropping
breadcrumbs on the first round only; ff2 and ff3 follow 40 and 80 s later, and all go round again.
"""

import numpy as np

from estimator.measurements import AnyReading
from estimator.simulate.base import Scenario, TrueTrack, in_posting_order
from estimator.simulate.breadcrumbs import drop_along
from estimator.simulate.building import STOREYS
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
    reported,
)

NAME = "shared-breadcrumbs"
DURATION_S = 600.0
FOLLOWS_S = {"ff1": 0.0, "ff2": 40.0, "ff3": 80.0}


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    tracks = {node: _round(after_s, index, rng) for index, (node, after_s) in enumerate(FOLLOWS_S.items())}
    crumbs = drop_along("b", "ff1", tracks["ff1"], rng, until_s=190.0)
    truth = tracks | {"base": base_track(DURATION_S)}
    radios = radios_of(truth, crumbs)
    readings: list[AnyReading] = [introduce_base(), *(introduce(n, t, rng, "E7") for n, t in tracks.items())]
    readings += introduce_dropped(crumbs)
    for node in tracks:
        readings += measured(node, radios, DURATION_S, rng, Kit(site=IN_THE_OFFICE))
    reports = in_posting_order(reported(readings, "engine-7", rng))
    truth |= {crumb.node: crumb.truth for crumb in crumbs}
    return Scenario(NAME, "Shared breadcrumbs", "recorded", STOREYS[:2], reports, truth, DURATION_S)


def _round(after_s: float, index: int, rng: np.random.Generator) -> TrueTrack:
    way = Itinerary((-2.0 - index, 0.3 * (index - 1), 0.0), 0.3 * (index - 1), rng).wait(2.0 + after_s)
    while way.t_s < DURATION_S:
        way.advance(40.0, 0.9).take_stairs("E", 1, 0.6).wait(5.0)
        way.advance(20.0, 0.7).take_stairs("W", 0, 0.6).wait(5.0).advance(4.0, 0.9)
    return way.track(DURATION_S)
