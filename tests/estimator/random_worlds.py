"""Small random worlds: a base, a few anchors, and a crew some of whose units are silent, late or missing."""

from typing import Literal, NamedTuple, get_args

import numpy as np

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node, Role
from estimator.measurements.range import Range

Unit = Literal["on", "none", "late", "gap"]
"""It reports all the time; there is none; from a minute after the start on; not for 40 s."""
SECONDS, HALF_M, REACH_M, HEARD_M = 150, 20.0, 40.0, 15.0
RANGE_SIGMA_M, STEP_SIGMA_M = 0.15, 0.03
ON_S, SILENT_S = 60, range(61, 101)
DROPS_S = 40


class World(NamedTuple):
    """What is posted, and where everybody is.

    Attributes:
        readings: in order of epoch.
        ways_m: of each responder, second by second, k × 2 (m).
    """

    readings: list[AnyReading]
    ways_m: dict[str, Array]


def world(seed: int) -> World:
    """A world at random: from one radio that stands to five, from one responder to three."""
    chance = np.random.default_rng(seed)
    base_m = chance.uniform(-25.0, 25.0, 2)
    radios = {"base": base_m} | {
        f"a{i}": chance.uniform(-25.0, 25.0, 2) for i in range(int(chance.integers(0, 5)))
    }
    readings: list[AnyReading] = [_node(name, at, 0.05) for name, at in radios.items()]
    ways: dict[str, Array] = {}
    units: dict[str, Unit] = {}
    for i in range(int(chance.integers(1, 4))):
        who = f"f{i}"
        units[who] = chance.choice(get_args(Unit))
        ways[who] = _way(chance, base_m + chance.uniform(-3.0, 3.0, 2))
        readings.append(_node(who, ways[who][0], 0.2))
    dropped: dict[str, Array] = {}
    for second in range(1, SECONDS):
        for i, (who, way) in enumerate(ways.items()):
            on = _reports(units[who], second)
            if on:
                e, n = (way[second] - way[second - 1] + chance.normal(0.0, STEP_SIGMA_M, 2)).tolist()
                readings.append(
                    Displacement(t=float(second), from_t=second - 1.0, node=who, delta_m=(e, n, 0.0))
                )
            if on and second % DROPS_S == DROPS_S // 2 + 5 * i:
                dropped[f"b{who}{second}"] = way[second].copy()
                readings.append(Drop(t=float(second), node=f"b{who}{second}", by=who))
            readings += _heard(chance, second, who, way[second], radios | dropped, REACH_M)
            others = {other: at[second] for other, at in ways.items() if other > who}
            readings += _heard(chance, second, who, way[second], others, HEARD_M)
    return World(readings, ways)


def _node(name: str, at: Array, sigma_m: float) -> Node:
    east, north = at.tolist()
    role: Role = "base" if name == "base" else "anchor" if name.startswith("a") else "responder"
    return Node(
        t=0.0,
        node=name,
        role=role,
        position_m=(east, north, 0.0),
        sigma_m=sigma_m,
        heading_sigma_rad=0.05 if role == "responder" else None,
    )


def _way(chance: np.random.Generator, start: Array) -> Array:
    """From goal to goal at a metre a second, with a rest at some."""
    at, goal, rest_s, way = start, start, 0, []
    for _ in range(SECONDS):
        off_m = float(np.hypot(*(goal - at)))
        if rest_s > 0:
            rest_s -= 1
        elif off_m < 1e-6:
            goal = chance.uniform(-HALF_M, HALF_M, 2)
            rest_s = int(chance.integers(0, 8)) if chance.random() < 0.4 else 0
        else:
            at = at + (goal - at) * min(1.0, 1.0 / off_m)
        way.append(at)
    return np.array(way)


def _reports(unit: Unit, second: int) -> bool:
    return unit == "on" or (unit == "late" and second > ON_S) or (unit == "gap" and second not in SILENT_S)


def _heard(
    chance: np.random.Generator, second: int, who: str, at: Array, others: dict[str, Array], reach_m: float
) -> list[AnyReading]:
    found: list[AnyReading] = []
    for name, there in others.items():
        off_m = float(np.hypot(*(at - there)))
        dropped_here = name.startswith("b") and name != "base" and off_m < 0.5
        if off_m < reach_m and not dropped_here:
            range_m = abs(off_m + float(chance.normal(0.0, RANGE_SIGMA_M)))
            found.append(Range(t=second, a=who, b=name, range_m=range_m, technology="uwb"))
    return found
