"""Breadcrumbs that were kicked while nobody was there, and draw along who comes back."""

import itertools
import math
from functools import cache

import numpy as np
import pytest

from estimator.estimate import NodeEstimate, Notice
from estimator.fusion.memory.ledger import RANGE
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.changes.drawing_nodes import heard_anew
from estimator.smoothing.changes.relocation import READINGS_MIN
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.smoothing.windows import entered, fused, problem_of

WAY_M = (
    (-2.0, 0.0),
    (24.0, 0.0),
    (24.0, 30.0),
    (50.0, 30.0),
    (50.0, 32.0),
    (24.0, 32.0),
    (24.0, 0.0),
    (-4.0, 0.0),
)
"""Along a corridor past two breadcrumbs, round two corners until nobody is heard, and back at 1 m/s."""
KICKED_S, REACH_M, KICK_M = 70, 10.0, 4.0


class Walk:
    """A walk during which one of two breadcrumbs is kicked out of earshot; its draws are of a `seed`."""

    def __init__(self, seed: int) -> None:
        chance = np.random.default_rng(seed)
        first, apart, second = chance.uniform(-2.0, 2.0), chance.uniform(5.0, 10.0), chance.uniform(-2.0, 2.0)
        self.lay_m = {"b1": np.array([8.0, first]), "b2": np.array([8.0 + apart, second])}
        self.kicked = "b2" if chance.random() < 0.6 else "b1"
        angle = chance.uniform(0.0, 2.0 * math.pi)
        self.kick_m = KICK_M * np.array([math.cos(angle), math.sin(angle)])
        self.readings: list[AnyReading] = [Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))]
        self.readings.append(entered(*WAY_M[0]))
        for name, (east_m, north_m) in self.lay_m.items():
            place_m = (float(east_m), float(north_m), 0.0)
            lying = Node(t=0.5, node=name, role="breadcrumb", position_m=place_m, sigma_m=0.3)
            self.readings.append(lying)
        self._measure(chance)

    def lies_m(self, name: str, second: int) -> Array:
        """Where a breadcrumb, or the base, lies at a second, 2 (m)."""
        kicked = name == self.kicked and second > KICKED_S
        return self.lay_m.get(name, np.zeros(2)) + kicked * self.kick_m

    def _measure(self, chance: np.random.Generator) -> None:
        bias_radps, turned_rad = chance.normal(0.0, 0.0012), 0.0
        for second, (before_m, at_m) in enumerate(itertools.pairwise(PLACES_M), start=1):
            turned_rad += bias_radps + chance.normal(0.0, 0.004)
            cos, sin = math.cos(turned_rad), math.sin(turned_rad)
            step_m = np.array([[cos, sin], [-sin, cos]]) @ (at_m - before_m) + chance.normal(0.0, 0.03, 2)
            delta_m = (float(step_m[0]), float(step_m[1]), 0.0)
            t = float(second)
            self.readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=delta_m))
            for name in ("b1", "b2", "base"):
                far_m = float(np.hypot(*(at_m - self.lies_m(name, second))))
                if far_m < REACH_M and second % 2 == (name != "b1"):
                    range_m = far_m + float(chance.normal(0.0, 0.1))
                    ranged = Range(t=t, a="ff1", b=name, range_m=range_m, technology="uwb", sigma_m=0.1)
                    self.readings.append(ranged)

    def ranges_to(self, name: str) -> list[Range]:
        """The ranges to a breadcrumb, in order of epoch."""
        return [r for r in self.readings if isinstance(r, Range) and r.b == name]

    def until(self, second: float) -> list[AnyReading]:
        """What has been measured up to a second."""
        return [r for r in self.readings if r.t <= second]


def _places_m() -> list[Array]:
    """Where the walker is at each second."""
    corners = [np.array(corner) for corner in WAY_M]
    legs_m = [math.dist(*leg) for leg in itertools.pairwise(corners)]
    way_m = np.concatenate([[0.0], np.cumsum(legs_m)])
    seconds = np.arange(int(way_m[-1]) + 1)
    east, north = (np.interp(seconds, way_m, [corner[axis] for corner in corners]) for axis in range(2))
    return list(np.stack([east, north], axis=1))


PLACES_M = _places_m()


@cache
def followed(seed: int) -> tuple[Walk, list[Notice], dict[str, NodeEstimate]]:
    """A walk, what is told of breadcrumbs that lie elsewhere, and where all are in the end."""
    walk, tracker, told = Walk(seed), KirchhoffTracker(), list[Notice]()
    readings = sorted(walk.readings, key=lambda r: r.t)
    start = 0
    for second in range(len(PLACES_M)):
        end = start + sum(r.t <= second for r in readings[start:])
        tracker.fold(readings[start:end])
        found = {e.node: e for e in tracker.estimates()}
        told += [n for n in tracker.take_notices() if n.code == "node_moved"]
        start = end
    return walk, told, found


@pytest.mark.parametrize("seed", [2, 6, 16, 24, 35, 44])
def test_of_two_breadcrumbs_the_one_that_was_kicked_is_said_to_lie_elsewhere(seed: int) -> None:
    """Whom it has drawn along is back on his way, though his ranges to the other one had become outliers."""
    walk, told, found = followed(seed)
    assert [notice.node for notice in told] == [walk.kicked]
    again_t = min(r.t for r in walk.ranges_to(walk.kicked) if r.t > KICKED_S)
    assert told[0].t <= again_t + 30.0
    assert off_m(found["ff1"], PLACES_M[-1]) < 1.0
    lies = next(name for name in ("b1", "b2") if name != walk.kicked)
    assert off_m(found[lies], walk.lay_m[lies]) < 0.5


def test_where_either_explains_all_as_well_nothing_is_said_until_more_is_known() -> None:
    walk, told, found = followed(38)
    first_t = min(r.t for r in walk.ranges_to(walk.kicked) if r.t > KICKED_S)
    assert [notice.node for notice in told] == [walk.kicked]
    assert told[0].t > first_t + 2.0 * (READINGS_MIN - 1) + 2.0
    assert off_m(found["ff1"], PLACES_M[-1]) < 1.0


def asked_again(walk: Walk, second: float, name: str) -> dict[str, Integers]:
    """Of whom is asked at a second where ranges to a breadcrumb disagree with its place."""
    problem = problem_of(fused(walk.until(second)))
    pairs, number = problem.rows.pairs, problem.layout.state.nodes[name].index
    doubted = np.flatnonzero((pairs[:, 2:4] == number).any(axis=1) & (pairs[:, 1] == RANGE))
    return heard_anew(problem, doubted, second)


def test_asked_is_whom_somebody_has_come_near_to_again() -> None:
    """Going out both have just been put there; coming back, whoever was ranged five times."""
    walk = Walk(1)
    assert asked_again(walk, 20.0, "b1") == {}
    again_t = sorted(r.t for r in walk.ranges_to("b2") if r.t > KICKED_S)
    assert asked_again(walk, again_t[READINGS_MIN - 2], "b1").keys() == set()
    found = asked_again(walk, again_t[READINGS_MIN - 1], "b1")
    assert found.keys() == {"b2"}
    assert len(found["b2"]) == READINGS_MIN


def off_m(estimate: NodeEstimate, true_m: Array) -> float:
    """How far a place that is shown is from the true one (m)."""
    assert estimate.position_m is not None
    return float(np.hypot(*(np.array(estimate.position_m[:2]) - true_m)))
