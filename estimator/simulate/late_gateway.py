"""Two crews on two storeys; a gateway loses its link for five minutes, then posts all it kept; 12 minutes.

From 200 s to 500 s nothing of ladder-3 arrives. From 500 s on it posts the old readings in ten seconds, the
oldest first, while new ones go on.
"""

import numpy as np

from estimator.measurements import AnyReading
from estimator.simulate.base import Report, Scenario, TrueTrack, in_posting_order
from estimator.simulate.breadcrumbs import drop_along
from estimator.simulate.building import STOREYS
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

NAME = "late-gateway"
DURATION_S = 720.0
AWAY_S, BACK_S, EMPTIED_S = 200.0, 500.0, 510.0
CREWS = {"E7-1": "engine-7", "E7-2": "engine-7", "L3-1": "ladder-3", "L3-2": "ladder-3"}


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    tracks = {node: _round(index, rng) for index, node in enumerate(CREWS)}
    crumbs = {
        gateway: drop_along(leader[:2] + "-B", leader, tracks[leader], rng, until_s=170.0)
        for leader, gateway in (("E7-1", "engine-7"), ("L3-1", "ladder-3"))
    }
    lying = [crumb for own in crumbs.values() for crumb in own]
    truth = tracks | {"base": base_track(DURATION_S)}
    radios = radios_of(truth, lying)
    reports = reported([introduce_base()], "engine-7", rng)
    lined_up = {node: introduce(node, track, rng, node[:2]) for node, track in tracks.items()}
    kit = Kit(site=IN_THE_OFFICE, uwb=calibrated(TYPICAL_UWB, rng))
    for gateway, own in crumbs.items():
        readings: list[AnyReading] = introduce_dropped(own)
        for node in (node for node, its in CREWS.items() if its == gateway):
            readings.append(lined_up[node])
            readings += measured(node, radios, DURATION_S, rng, kit)
        sent = reported(readings, gateway, rng)
        reports += [_held_up(report) for report in sent] if gateway == "ladder-3" else sent
    truth |= {crumb.node: crumb.truth for crumb in lying}
    return Scenario(
        NAME, "A gateway comes back", "recorded", STOREYS[:2], in_posting_order(reports), truth, DURATION_S
    )


def _held_up(report: Report) -> Report:
    """When a report of the lost gateway really goes out: its backlog in order, at 30 times the pace."""
    if not AWAY_S <= report.sent_s < BACK_S:
        return report
    pace = (EMPTIED_S - BACK_S) / (BACK_S - AWAY_S)
    return Report(report.reading, report.gateway, BACK_S + (report.sent_s - AWAY_S) * pace)


def _round(index: int, rng: np.random.Generator) -> TrueTrack:
    """E7 goes round by stairwell W first, L3 by stairwell E."""
    there, back = ("W", "E") if index < 2 else ("E", "W")
    way = Itinerary((-2.0 - index, 0.3 * index - 0.5, 0.0), 0.3 * index - 0.5, rng).wait(2.0 + 3.0 * index)
    while way.t_s < DURATION_S:
        way.take_stairs(there, 1, 0.7).wait(10.0).take_stairs(back, 0, 0.7).wait(5.0)
    return way.track(DURATION_S)
