"""What the scenarios share: how nodes are introduced, and what a responder's kit measures."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.measurements import AnyReading, Drop, Node
from estimator.simulate.base import Report, TrueTrack, static_track
from estimator.simulate.breadcrumbs import Dropped
from estimator.simulate.building import floors_between, walls_between
from estimator.simulate.links import Radio, Site, range_readings, rssi_readings
from estimator.simulate.pdr import PdrUnit, displacements, reckon
from estimator.simulate.radio import PathLoss, Uwb
from estimator.simulate.vitals import altitude_readings

START_SIGMA_M = 0.5
HEADING_SIGMA_RAD = 0.1
GYRO_BIAS_RADPS = 0.0012
"""A good MEMS gyro after a minute at rest: 0.07 °/s, one sigma."""
CRAWLS = 0.1
"""They are off by this share of a crawl, one sigma: assumed, as the estimator does."""
RISES = 0.01
"""Boots rise or fall by so much for each metre of way, one sigma: ZUPT-aided units err by 0.3 to 1 %."""

IN_THE_OPEN = Site()
IN_THE_OFFICE = Site(walls_between, floors_between)
TYPICAL_LOSS = PathLoss()
TYPICAL_UWB = Uwb(range_m=30.0)


@dataclass(frozen=True, slots=True)
class Kit:
    """What a responder carries beside the PDR unit.

    Attributes:
        site: what stands between radios.
        loss: how signal strength falls off.
        uwb: its UWB radio, as the incident's are calibrated; None: it has none.
        altitude_sigma_m: noise of its altimeter (m); None: it has none.
        rssi_period_s: it listens this often (s).
        range_period_s: it ranges this often (s).
    """

    site: Site = IN_THE_OPEN
    loss: PathLoss = TYPICAL_LOSS
    uwb: Uwb | None = None
    altitude_sigma_m: float | None = 0.4
    rssi_period_s: float = 1.0
    range_period_s: float = 2.0


def typical_unit(rng: np.random.Generator) -> PdrUnit:
    """A foot-mounted unit as they differ from boot to boot."""
    # A stream of its own: how heights rise, and what of a crawl is told, change nothing else.
    own = rng.spawn(1)[0]
    rises, crawls = float(own.normal(0.0, RISES)), float(own.normal(1.0, CRAWLS))
    return PdrUnit(
        heading_sigma_rad=HEADING_SIGMA_RAD,
        bias_radps=float(rng.normal(0.0, GYRO_BIAS_RADPS)),
        scale=float(rng.normal(1.0, 0.02)),
        rises=rises,
        crawls=crawls,
    )


def base_track(end_s: float) -> TrueTrack:
    """The base station at the origin until `end_s`."""
    return static_track(np.zeros(3), 0, 0.0, end_s)


def introduce_base() -> Node:
    """The base station at the origin."""
    return Node(t=0.0, node="base", role="base", callsign="Command post", position_m=(0.0, 0.0, 0.0))


def introduce(node: str, truth: TrueTrack, rng: np.random.Generator, crew: str | None = None) -> Node:
    """A responder who lines up at the door, at a place on the ground known to half a metre."""
    # A stream of its own: who stands where changes nothing in what is measured afterwards.
    off_m = np.append(rng.spawn(1)[0].normal(0.0, START_SIGMA_M, 2), 0.0)
    east, north, up = (round(float(metres), 2) for metres in truth.position_m[0] + off_m)
    return Node(
        t=0.0,
        node=node,
        role="responder",
        callsign=node,
        crew=crew,
        position_m=(east, north, up),
        sigma_m=START_SIGMA_M,
        heading_sigma_rad=HEADING_SIGMA_RAD,
        device="boot unit",
    )


def introduce_dropped(crumbs: Iterable[Dropped], crews: Mapping[str, str] | None = None) -> list[AnyReading]:
    """Each breadcrumb is introduced, and said to have been dropped."""
    readings: list[AnyReading] = []
    for crumb in crumbs:
        crew = crews.get(crumb.by) if crews else None
        readings.append(Node(t=crumb.t_s, node=crumb.node, role="breadcrumb", crew=crew))
        readings.append(Drop(t=crumb.t_s, node=crumb.node, by=crumb.by))
    return readings


def radios_of(
    tracks: Mapping[str, TrueTrack], crumbs: Iterable[Dropped], off_s: Mapping[str, float] | None = None
) -> dict[str, Radio]:
    """The radios of walkers, and of breadcrumbs from a second after the drop; `off_s`: when one dies (s)."""
    ends = off_s or {}
    radios = {node: Radio(track, off_s=ends.get(node, np.inf)) for node, track in tracks.items()}
    for crumb in crumbs:
        radios[crumb.node] = Radio(crumb.truth, crumb.t_s + 1.0, ends.get(crumb.node, np.inf))
    return radios


def measured(
    node: str, radios: Mapping[str, Radio], end_s: float, rng: np.random.Generator, kit: Kit
) -> list[AnyReading]:
    """What the kit of `node` measures until `end_s`; nothing is sent while its own radio is silent."""
    radio = radios[node]
    first = 1.0 + float(rng.uniform(0.0, 0.9))
    readings: list[AnyReading] = list(
        rssi_readings(node, radios, np.arange(first, end_s, kit.rssi_period_s), kit.loss, kit.site, rng)
    )
    ranging = np.arange(first, end_s, kit.range_period_s)
    if kit.uwb is not None:
        readings += range_readings(node, radios, ranging, kit.uwb, kit.site, rng)
    if kit.altitude_sigma_m is not None:
        readings += altitude_readings(node, radio.truth, ranging, rng, kit.altitude_sigma_m)
    heard = [reading for reading in readings if not radio.silent_s[0] <= reading.t < radio.silent_s[1]]
    return heard + list(displacements(node, reckon(radio.truth, typical_unit(rng), rng), radio.silent_s))


def reported(readings: Sequence[AnyReading], gateway: str, rng: np.random.Generator) -> list[Report]:
    """Posted by one gateway, each some tenths of a second after it was measured."""
    return [Report(reading, gateway, reading.t + float(rng.uniform(0.05, 0.35))) for reading in readings]
