"""Two walk paper A's rectangle; fire reaches the fourth breadcrumb, which weakens, dies and is retired.

The breadcrumbs hear each other as well, so that the change shows on links between nodes that do not move.
"""

import msgspec
import numpy as np

from estimator.measurements import AnyReading, Retire, Rssi
from estimator.simulate.base import Scenario, in_posting_order
from estimator.simulate.links import Site, rssi_readings
from estimator.simulate.radio import PathLoss
from estimator.simulate.rectangle import END_S, sensed, walked
from estimator.simulate.team import radios_of, reported

NAME = "burned-breadcrumb"
BURNED = "b4"
FIRE_S, DEAD_S, RETIRED_S = 150.0, 210.0, 240.0
FIRE_DB = 15.0
"""What flames around an antenna take away (paper A measures signal strength in a burning house)."""

MESH_PERIOD_S = 5.0


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    way = walked(rng)
    readings = sensed(way.tracks, way.crumbs, {BURNED: DEAD_S}, rng)
    lying = radios_of({}, way.crumbs, {BURNED: DEAD_S})
    for node in lying:
        epochs = np.arange(100.0 + rng.uniform(0.0, MESH_PERIOD_S), END_S, MESH_PERIOD_S)
        readings += rssi_readings(node, lying, epochs, PathLoss(), Site(), rng)
    readings = [_in_fire(reading) for reading in readings]
    readings.append(Retire(t=RETIRED_S, node=BURNED, reason="burned"))
    truth = way.tracks | {crumb.node: crumb.truth for crumb in way.crumbs}
    reports = in_posting_order(reported(readings, "engine-7", rng))
    return Scenario(NAME, "A burned breadcrumb", "recorded", (), reports, truth, END_S)


def _in_fire(reading: AnyReading) -> AnyReading:
    if isinstance(reading, Rssi) and BURNED in (reading.a, reading.b) and reading.t >= FIRE_S:
        return msgspec.structs.replace(reading, dbm=round(reading.dbm - FIRE_DB, 1))
    return reading
