"""A fire on the first floor of an office: two crews of three, a UAV, breadcrumbs, a mayday; 20 minutes.

0:03 the crews enter. E7 takes stairwell W to the fire on the first floor, L3 searches the second floor.
8:00 a breadcrumb is kicked. 9:00 to 11:00 E7-2 is silent. 12:10 L3-2 lies still; PASS 12:40, MAYDAY 13:00,
acknowledged 13:20, cleared 16:10. 14:40 the breadcrumb at the fire falls silent, and is retired at 15:00.
"""

from dataclasses import replace

import numpy as np

from estimator.measurements import Alarm, AnyReading, Node, Retire
from estimator.measurements.base import PairReading
from estimator.simulate.base import FloatArray, Report, Scenario, TrueTrack, in_posting_order
from estimator.simulate.breadcrumbs import drop_along, kicked
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
)
from estimator.simulate.uav import circle, flight_readings
from estimator.simulate.vitals import Breathing, pressure_readings, status_readings

NAME = "office-fire"
DURATION_S = 1200.0
FIRE_ROOM, DOWN_ROOM = Room("s", 5, 1), Room("s", 4, 2)
SEARCHED = {
    "E7-1": tuple(Room(side, number, 1) for side, number in (("s", 4), ("n", 4), ("n", 3), ("s", 3))),
    "E7-2": tuple(Room(side, number, 1) for side, number in (("n", 5), ("n", 6), ("s", 6))),
    "L3-1": tuple(Room("n", number, 2) for number in (6, 5, 4, 3, 2)),
    "L3-2": tuple(Room("s", number, 2) for number in (7, 6, 5, 3)),
}
FIRE_M: FloatArray = np.array(FIRE_ROOM.inside(0.3, 0.6))
LOST, LOST_S = "E7-2", (540.0, 660.0)
DOWN, DOWN_S, PASS_S, MAYDAY_S, ACKNOWLEDGED_S, FOUND_S = "L3-2", 730.0, 760.0, 780.0, 800.0, 970.0
KICKED_S, BURNT_S, RETIRED_S = 480.0, 880.0, 900.0
GATEWAYS = {"E7": "engine-7", "L3": "ladder-3", "UA": "uav-1"}
POST = "command-post"
UAV = Node(t=0.0, node="uav-1", role="uav", callsign="UAV 1", device="quadcopter")
CREWS = {"E7": ("E7-1", "E7-2", "E7-3"), "L3": ("L3-1", "L3-2", "L3-3")}


def build(seed: int) -> Scenario:
    """The scenario, the same for the same `seed`."""
    rng = np.random.default_rng(seed)
    tracks = _engine_crew(rng) | _ladder_crew(rng)
    dropped = drop_along("E7-B", "E7-1", tracks["E7-1"], rng, until_s=330.0)
    dropped += drop_along("L3-B", "L3-1", tracks["L3-1"], rng, until_s=210.0)
    upstairs = [crumb for crumb in dropped if crumb.by == "E7-1" and crumb.truth.level[0] == 1]
    moved = upstairs[0].node
    burnt = min(upstairs[1:], key=lambda c: float(np.linalg.norm(c.truth.position_m[0] - FIRE_M))).node
    crumbs = {c.node: kicked(c, KICKED_S, rng) if c.node == moved else c for c in dropped}
    uav = circle(DURATION_S)
    base = base_track(DURATION_S)
    radios = radios_of(tracks | {"base": base}, crumbs.values(), {burnt: BURNT_S})
    radios[LOST] = replace(radios[LOST], silent_s=LOST_S)
    readings: list[AnyReading] = [introduce_base(), UAV]
    readings += [introduce(node, truth, rng, node[:2]) for node, truth in tracks.items()]
    readings += introduce_dropped(crumbs.values(), {"E7-1": "E7", "L3-1": "L3"})
    uwb = calibrated(TYPICAL_UWB, rng)
    ranged = {node: radios[node] for node in tracks}
    readings += _story(burnt) + flight_readings("uav-1", uav, ranged, uwb, rng)
    readings += list(pressure_readings("base", base, np.arange(0.0, DURATION_S, 5.0), rng, 0.0))
    for node in tracks:
        readings += _worn(node, radios, uwb, rng)
    reports = [_report(reading, rng) for reading in readings]
    truths = tracks | {n: c.truth for n, c in crumbs.items()} | {"base": base, "uav-1": uav}
    return Scenario(NAME, "Office fire", "live", STOREYS, in_posting_order(reports), truths, DURATION_S)


def _engine_crew(rng: np.random.Generator) -> dict[str, TrueTrack]:
    """E7 to the fire by stairwell W, then up stairwell E to the one who is down, and out with him."""
    tracks = {}
    for number, node in enumerate(CREWS["E7"]):
        way = Itinerary((-2.0 - number, 0.4 * (1 - number), 0.0), 0.4 * (1 - number), rng)
        way.wait(2.0 + 1.5 * number).advance(8.0, 0.9).take_stairs("W", 1, 0.55)
        way.wait(6.0).advance(22.0, 0.6).wait(12.0).advance(33.0 - 1.5 * number, 0.5).wait(20.0)
        if number < 2:
            way.enter(FIRE_ROOM, -0.6 + 0.5 * number, 0.1, 0.5).wait_until(300.0 + 20.0 * number)
            way.leave(FIRE_ROOM, 0.6)
            for room in SEARCHED[node]:
                way.search(room, 0.42).wait(30.0)
            way.advance(34.0 + number, 0.6).wait_until(MAYDAY_S + 15.0 + 3.0 * number)
            way.take_stairs("E", 2, 0.7).enter(DOWN_ROOM, 0.4 - 0.4 * number, 0.6, 0.8)
            way.wait_until(FOUND_S + 2.0).leave(DOWN_ROOM, 0.5).take_stairs("W", 0, 0.5).advance(-3.0, 0.8)
        else:
            for x_m in (24.0, 31.0, 20.0, 30.0, 26.0, 31.0):
                way.wait(45.0).advance(x_m, 0.5)
            way.wait_until(MAYDAY_S + 20.0).take_stairs("W", 0, 0.6).advance(-4.0, 0.9)
        tracks[node] = way.track(DURATION_S)
    return tracks


def _ladder_crew(rng: np.random.Generator) -> dict[str, TrueTrack]:
    """L3 through the ground floor and up stairwell E; the search from room to room; one lies still."""
    tracks = {}
    for number, node in enumerate(CREWS["L3"]):
        way = Itinerary((-3.0 - number, -1.0, 0.0), -0.3 * number, rng)
        way.wait(3.0 + 1.5 * number).advance(40.0, 0.95).take_stairs("E", 2, 0.6).wait(5.0)
        for room in SEARCHED.get(node, ()):
            way.search(room, 0.38).wait(40.0)
        if node == DOWN:
            way.wait_until(DOWN_S - 25.0).enter(DOWN_ROOM, 0.5, 0.7, 0.5).wait_until(FOUND_S)
        else:
            if node == "L3-3":
                for x_m in (45.0, 41.0, 37.0, 41.0, 35.0, 31.0, 33.0):
                    way.advance(x_m, 0.5).wait(70.0)
            way.wait_until(MAYDAY_S - 8.0 + 3.0 * number).enter(DOWN_ROOM, -0.3 * number, 0.5, 0.8)
            way.wait_until(FOUND_S + 3.0 * number)
        way.leave(DOWN_ROOM, 0.45).take_stairs("W", 0, 0.45).advance(-3.0 - number, 0.7)
        tracks[node] = way.track(DURATION_S)
    return tracks


def _worn(node: str, radios: dict[str, Radio], uwb: Uwb, rng: np.random.Generator) -> list[AnyReading]:
    """All that a responder's units measure, less what a silent radio could not send."""
    radio, engine = radios[node], node.startswith("E7")
    kit = Kit(site=IN_THE_OFFICE, uwb=uwb, altitude_sigma_m=None if engine else 0.4)
    epochs = np.arange(1.0 + rng.uniform(0.0, 0.9), DURATION_S, 2.0)
    told: list[AnyReading] = []
    if engine:
        told += pressure_readings(node, radio.truth, epochs, rng, offset_pa=float(rng.normal(0.0, 3.0)))
    breathing = None if node == "L3-3" else Breathing(float(rng.uniform(9.5, 12.0)))
    told += status_readings(node, radio.truth, epochs[::5], FIRE_M, breathing)
    sent = [reading for reading in told if not radio.silent_s[0] <= reading.t < radio.silent_s[1]]
    return sent + measured(node, radios, DURATION_S, rng, kit)


def _story(burnt: str) -> list[AnyReading]:
    """What people and their alarms say."""
    lunar = (
        "Location: second floor, corridor side of room S4, low wall collapsed. Unit: Ladder 3, L3-2. "
        "Name: Novak. Assignment: primary search. Resources: two rescuers and a cutter, air below 150 bar."
    )
    return [
        Alarm(t=PASS_S, node=DOWN, alarm="pass", state="raised", text="no movement for 30 s"),
        Alarm(t=MAYDAY_S, node=DOWN, alarm="mayday", state="raised", text=lunar),
        Alarm(t=ACKNOWLEDGED_S, node=DOWN, alarm="mayday", state="acknowledged", text="RIT: E7-1, E7-2"),
        Alarm(t=ACKNOWLEDGED_S + 5.0, node=DOWN, alarm="pass", state="acknowledged"),
        Retire(t=RETIRED_S, node=burnt, reason="burned: in the fire room's doorway, silent for 20 s"),
        Alarm(t=FOUND_S, node=DOWN, alarm="pass", state="cleared", text="moving again"),
        Alarm(
            t=FOUND_S + 10.0, node=DOWN, alarm="mayday", state="cleared", text="freed, walking out with E7"
        ),
    ]


def _report(reading: AnyReading, rng: np.random.Generator) -> Report:
    """Who posts a reading and when: what a node says of itself goes by its own crew's gateway."""
    by_post = isinstance(reading, Retire) or (
        isinstance(reading, Alarm)
        and (reading.state == "acknowledged" or (reading.alarm == "mayday" and reading.state == "cleared"))
    )
    speaker = reading.a if isinstance(reading, PairReading) else getattr(reading, "node", "")
    gateway = POST if by_post else GATEWAYS.get(speaker[:2].upper(), POST)
    return Report(reading, gateway, reading.t + float(rng.uniform(0.05, 0.35)))
