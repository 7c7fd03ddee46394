"""A short walk of two responders past breadcrumbs and anchors, as readings with realistic noise."""

import math

import numpy as np
from msgspec.structs import replace

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.bearing import Bearing
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.rssi import Rssi

BEGINS = Node(
    t=0.0,
    node="ff1",
    role="responder",
    position_m=(0.0, 0.0, 0.0),
    sigma_m=0.1,
    heading_rad=0.0,
    heading_sigma_rad=0.02,
)
"""A responder enters at the origin, and the turn of his unit's frame is known."""


def two_responders(seconds: int = 60, seed: int = 1) -> list[AnyReading]:
    """Readings in order of epoch: one walker with PDR, one without, an unknown beacon, drops."""
    rng = np.random.default_rng(seed)
    readings: list[AnyReading] = [
        Node(t=0.0, node="base", role="base"),
        Node(t=0.0, node="anchor", role="anchor", position_m=(12.0, 10.0, 0.0), sigma_m=0.05),
        Node(t=0.0, node="beacon", role="beacon"),
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.2),
        Node(t=0.0, node="ff2", role="responder", position_m=(2.0, 0.0, 0.0), sigma_m=0.2),
    ]
    places = {
        "base": np.zeros(3),
        "anchor": np.array([12.0, 10.0, 0.0]),
        "beacon": np.array([-5.0, 12.0, 0.0]),
    }
    one, two = np.zeros(3), np.array([2.0, 0.0, 0.0])
    for second in range(1, seconds + 1):
        turn = 2.0 * math.pi * second / 40.0
        delta = np.array([math.cos(turn), math.sin(turn), 0.0])
        one, two = one + delta, two + 0.5 * delta
        noisy = (delta + rng.normal(0.0, 0.03, 3)).tolist()
        t = float(second)
        readings.append(
            Displacement(t=t, node="ff1", delta_m=(noisy[0], noisy[1], noisy[2]), heading_rad=turn)
        )
        for name, place in places.items():
            for node, at in (("ff1", one), ("ff2", two)):
                measured = float(np.linalg.norm(at - place) + rng.normal(0.0, 0.3))
                readings.append(Range(t=t, a=node, b=name, range_m=max(measured, 0.0), technology="uwb"))
            power = -45.0 - 22.0 * math.log10(max(float(np.linalg.norm(one - place)), 0.3))
            readings.append(Rssi(t=t + 0.3, a="ff1", b=name, dbm=power + float(rng.normal(0.0, 5.0))))
        if second % 20 == 10:
            readings.append(Drop(t=t + 0.1, node=f"b{second}", by="ff1"))
            places[f"b{second}"] = one.copy()
        if second % 15 == 0:
            fix = (two + rng.normal(0.0, 1.0, 3)).tolist()
            readings.append(
                Position(t=t + 0.5, node="ff2", position_m=(fix[0], fix[1], fix[2]), sigma_m=(1.0, 1.0, 2.0))
            )
            readings.append(Altitude(t=t, node="ff1", up_m=float(rng.normal(0.0, 0.5)), sigma_m=0.5))
            direction = math.atan2(*(places["anchor"] - one)[[1, 0]].tolist())
            readings.append(Bearing(t=t, a="ff1", b="anchor", bearing_rad=direction, sigma_rad=0.1))
    readings.append(Retire(t=float(seconds), node="b10"))
    return sorted(readings, key=lambda r: r.t)


def behind_a_wall() -> list[AnyReading]:
    """The same, with a wall before the beacon, which lies where it was said to: its ranges are too long by
    now this and now that."""
    chance = np.random.default_rng(4)
    lies = Node(t=0.0, node="beacon", role="beacon", position_m=(-5.0, 12.0, 0.0), sigma_m=0.3)
    walk = [lies if isinstance(r, Node) and r.node == "beacon" else r for r in two_responders()]
    return [
        replace(r, range_m=r.range_m + float(chance.exponential(1.0)))
        if isinstance(r, Range) and r.b == "beacon"
        else r
        for r in walk
    ]


def standing_radios(seconds: int = 20, seed: int = 1) -> list[AnyReading]:
    """Readings in order of epoch of a base, three anchors and a beacon that these range: nobody moves."""
    rng = np.random.default_rng(seed)
    places = [(0.0, 8.0, 0.0), (10.0, 0.0, 0.0), (10.0, 8.0, 0.0)]
    readings: list[AnyReading] = [
        Node(t=0.0, node="base", role="base"),
        Node(t=0.0, node="beacon", role="beacon"),
    ]
    readings += [
        Node(t=0.0, node=f"anchor{i}", role="anchor", position_m=place, sigma_m=0.3)
        for i, place in enumerate(places)
    ]
    for second in range(1, seconds + 1):
        for i, place in enumerate(places):
            measured = math.dist(place, (5.0, 4.0, 0.0)) + float(rng.normal(0.0, 0.1))
            readings.append(
                Range(t=float(second), a=f"anchor{i}", b="beacon", range_m=measured, technology="uwb")
            )
    return readings


def from_goal_to_goal(
    chance: np.random.Generator,
    start_m: Array,
    area_m: tuple[float | Array, float | Array],
    step_m: float,
    near_m: float,
    steps: int,
) -> Array:
    """Where somebody is who walks straight to one place after another, after each step, n × 2 (m).

    Args:
        chance: draws where he goes next.
        start_m: where he begins, 2.
        area_m: the least and the most of east and north of where he goes.
        step_m: how far each step is.
        near_m: from where on he has arrived.
        steps: how many there are.
    """
    at, goal, found = start_m, start_m, list[Array]()
    for _ in range(steps):
        while np.hypot(*(goal - at)) < near_m:
            goal = chance.uniform(*area_m, 2)
        at = at + (goal - at) / np.hypot(*(goal - at)) * step_m
        found.append(at)
    return np.array(found)
