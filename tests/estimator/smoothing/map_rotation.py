"""Walks past beacons whose map may be turned as a whole, and what a turn does to all that is unknown."""

import numpy as np

from estimator.graph.dense import Array
from estimator.graph.gauge import turning
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES

HEADING_SIGMA_RAD = 0.1
BEACONS_M = {"b1": (5.0, 8.0), "b2": (-6.0, 12.0)}
AFAR_M = (45.0, -30.0)


def walk_past_beacons(base_m: tuple[float, float] = (0.0, 0.0), free: bool = False) -> list[AnyReading]:
    """A unit walks between beacons that nobody has surveyed.

    Args:
        base_m: where the base stands, beside which all begins: east, north (m).
        free: somebody without a unit walks along.
    """
    chance = np.random.default_rng(1)
    east, north = base_m
    places = {name: np.array([east + e, north + n]) for name, (e, n) in BEACONS_M.items()} | {
        "base": np.array(base_m)
    }
    walkers = {"ff1": places["base"] + np.array([1.0, 0.0])}
    if free:
        walkers["ff2"] = places["base"] + np.array([5.0, 1.0])
    readings: list[AnyReading] = [Node(t=0.0, node="base", role="base", position_m=(*base_m, 0.0))]
    readings += [
        Node(
            t=0.0,
            node=name,
            role="responder",
            position_m=(float(at[0]), float(at[1]), 0.0),
            sigma_m=1e3,
            heading_sigma_rad=HEADING_SIGMA_RAD,
        )
        for name, at in walkers.items()
    ]
    readings += [Node(t=0.0, node=name, role="beacon") for name in BEACONS_M]
    for second in range(1, 61):
        steps = {
            "ff1": np.array([np.cos(second / 7.0), np.sin(second / 7.0)]),
            "ff2": 0.5 * np.array([np.sin(second / 9.0), np.cos(second / 9.0)]),
        }
        walkers = {who: at + steps[who] for who, at in walkers.items()}
        e, n = (steps["ff1"] + chance.normal(0.0, 0.03, 2)).tolist()
        readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(e, n, 0.0)))
        for who, at in walkers.items():
            for name, place in places.items():
                range_m = float(np.hypot(*(at - place)) + chance.normal(0.0, 0.1))
                readings.append(Range(t=float(second), a=who, b=name, range_m=range_m, technology="uwb"))
    return readings


def walk_from_afar(until_s: float, vehicle_m: tuple[float, float] | None = None) -> list[AnyReading]:
    """A unit walks round between two beacons; only where it was switched on is known, and there is no base.

    Args:
        until_s: how long (s).
        vehicle_m: where a vehicle stands that nobody hears, east and north (m); None: there is none.
    """
    chance, at = np.random.default_rng(2), np.array(AFAR_M)
    places = {name: at + np.array([e, n]) for name, (e, n) in BEACONS_M.items()}
    readings: list[AnyReading] = [
        Node(
            t=0.0,
            node="ff1",
            role="responder",
            position_m=(*AFAR_M, 0.0),
            sigma_m=0.05,
            heading_sigma_rad=3.0 * HEADING_SIGMA_RAD,
        )
    ]
    readings += [Node(t=0.0, node=name, role="beacon") for name in BEACONS_M]
    if vehicle_m is not None:
        at_m = (*vehicle_m, 0.0)
        readings.append(Node(t=0.0, node="engine", role="anchor", position_m=at_m, sigma_m=0.2))
    for second in np.arange(1.0, until_s + 1.0).tolist():
        step = np.array([np.cos(second / 7.0), np.sin(second / 7.0)])
        at = at + step
        e, n = (step + chance.normal(0.0, 0.03, 2)).tolist()
        readings.append(Displacement(t=second, from_t=second - 1.0, node="ff1", delta_m=(e, n, 0.0)))
        for name, place in places.items():
            range_m = float(np.hypot(*(at - place)) + chance.normal(0.0, 0.1))
            readings.append(Range(t=second, a="ff1", b=name, range_m=range_m, technology="uwb"))
    return readings


def turn(ways: Array, by_rad: float) -> Array:
    """Ways, … × 2, turned to the left."""
    return np.asarray(ways @ turning(by_rad))


def turned_map(layout: Layout, x: Array, by_rad: float) -> tuple[Array, Array]:
    """All unknowns with the map turned about the base, flat; and how they begin to change as it turns.

    Places by J p, velocities by J v, headings by 1.
    """
    base_m, size = np.array(layout.state.base_place()[:2]), layout.length * layout.width
    there, way = x.copy(), np.zeros_like(x)
    keyframes = there[:size].reshape(layout.length, layout.width)
    begins = way[:size].reshape(layout.length, layout.width)
    for i, walk in enumerate(layout.walks):
        place, rest = slice(STATES * i, STATES * i + 2), slice(STATES * i + 3, STATES * i + 5)
        begins[:, place] = turn(keyframes[:, place] - base_m, np.pi / 2)
        keyframes[:, place] = base_m + turn(keyframes[:, place] - base_m, by_rad)
        if walk.way is None:
            begins[:, rest] = turn(keyframes[:, rest], np.pi / 2)
            keyframes[:, rest] = turn(keyframes[:, rest], by_rad)
        else:
            begins[:, rest.start] = 1.0
            keyframes[:, rest.start] += by_rad
    for start in layout.stands.values():
        own = slice(size + start, size + start + 2)
        way[own] = turn(x[own] - base_m, np.pi / 2)
        there[own] = base_m + turn(x[own] - base_m, by_rad)
    return there, way
