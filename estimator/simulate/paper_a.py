"""Paper A's experiment: 400 m round a rectangle with six breadcrumbs.

30 × 20 m walked four times at 1 m/s from the base at a corner; breadcrumbs dropped on the first lap at
14, 28, 42, 57, 71 and 85 m. Displacement each second, noise 0.03 m per axis, step scale of sd 2 %; the
heading error is a bias of ±0.3 °/s × U(0.6, 1.4) for the whole walk and a random walk of 0.6 ° a step.
RSSI each second from every node within 25 m: -40 dBm at 1 m, n = 2.5, sd 5 dB, 1.5 dB within 1.5 m.
"""

import numpy as np

from estimator.measurements import AnyReading, Drop, Node
from estimator.simulate.base import Report, Scenario, in_posting_order, static_track
from estimator.simulate.breadcrumbs import drop_at
from estimator.simulate.links import Radio, Site, rssi_readings
from estimator.simulate.pdr import PdrUnit, displacements, reckon
from estimator.simulate.radio import PathLoss
from estimator.simulate.walking import Leg, walk

NAME = "paper-a"
LAPS, CORNERS_M = 4, ((30.0, 0.0, 0.0), (30.0, 20.0, 0.0), (0.0, 20.0, 0.0), (0.0, 0.0, 0.0))
DROPS_M = (14.0, 28.0, 42.0, 57.0, 71.0, 85.0)
DURATION_S = 400.0


def unit(rng: np.random.Generator) -> PdrUnit:
    """The walker's unit; what is not named above is perfect."""
    return PdrUnit(
        heading_sigma_rad=0.0,
        bias_radps=float(np.radians(0.3) * rng.uniform(0.6, 1.4) * rng.choice([-1.0, 1.0])),
        heading_walk_rad=float(np.radians(0.6)),
        scale=float(rng.normal(1.0, 0.02)),
        noise_m=0.03,
        heading_noise_rad=0.0,
    )


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    truth = walk((0.0, 0.0, 0.0), [Leg(corner, 1.0) for corner in CORNERS_M] * LAPS, (), DURATION_S)
    # At 1 m/s the metres walked are the seconds since the start.
    crumbs = [drop_at(f"b{i + 1}", "ff1", truth, metres, rng) for i, metres in enumerate(DROPS_M)]
    base = static_track(np.zeros(3), 0, 0.0, DURATION_S)
    radios = {"ff1": Radio(truth), "base": Radio(base)}
    radios |= {crumb.node: Radio(crumb.truth, on_s=crumb.t_s) for crumb in crumbs}
    readings: list[AnyReading] = [
        Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
        Node(
            t=0.0,
            node="ff1",
            role="responder",
            position_m=(0.0, 0.0, 0.0),
            sigma_m=0.05,
            heading_sigma_rad=0.01,
        ),
    ]
    readings += [Drop(t=crumb.t_s, node=crumb.node, by="ff1") for crumb in crumbs]
    readings += displacements("ff1", reckon(truth, unit(rng), rng))
    loss = PathLoss(range_m=25.0, sensitivity_dbm=-np.inf)
    each_second = np.arange(1.0, DURATION_S + 0.5)
    readings += rssi_readings(
        "ff1", radios, each_second, loss, Site(), rng, strongest=len(radios), lost_p=0.0
    )
    reports = in_posting_order([Report(reading, "engine-1", reading.t) for reading in readings])
    tracks = {"ff1": truth, "base": base} | {crumb.node: crumb.truth for crumb in crumbs}
    return Scenario(NAME, "Paper A: 400 m with six breadcrumbs", "recorded", (), reports, tracks, DURATION_S)
