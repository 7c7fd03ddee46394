"""What the whole incident tells of a unit: that it is as noisy as it is, whatever is assumed of walls."""

import math

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.whole import solve_whole, sort_by_walk
from tests.estimator.smoothing.windows import entered, fused, problem_of
from tests.estimator.walks import two_responders

SECONDS, PACE_MPS = 600, 0.4
BEACONS_M = {
    "sw": (-4.0, -4.0, 0.0),
    "se": (12.0, -4.0, 0.0),
    "nw": (-4.0, 8.0, 0.0),
    "ne": (12.0, 8.0, 0.0),
}
PLACE_M2 = (
    physics.WALK_M_PER_ROOT_M**2 * PACE_MPS + physics.STAND_M_PER_ROOT_S**2 + physics.DISPLACEMENT_FLOOR_M**2
)
"""Variance that is assumed of what is walked in a second."""


def searched(factor: float, seed: int) -> list[AnyReading]:
    """A search in sight of four surveyed breadcrumbs, with a unit `factor` times as noisy as assumed."""
    chance = np.random.default_rng(seed)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="breadcrumb", position_m=at, sigma_m=0.01)
        for name, at in BEACONS_M.items()
    ]
    readings.append(entered())
    place = np.zeros(2)
    for second in range(1, SECONDS + 1):
        direction = 2.0 * math.pi * second / 60.0
        step = PACE_MPS * np.array([math.cos(direction), math.sin(direction)])
        place = place + step
        e, n = (step + math.sqrt(factor * PLACE_M2) * chance.normal(size=2)).tolist()
        t = float(second)
        readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(e, n, 0.0)))
        for name, at in BEACONS_M.items():
            far_m = float(np.hypot(*(place - at[:2])) + chance.normal(0.0, 0.05))
            readings.append(Range(t=t, a="ff1", b=name, range_m=far_m, technology="uwb"))
    return readings


@pytest.mark.parametrize("factor", [1.0, 3.0])
def test_what_is_assumed_of_walls_makes_no_unit_better_than_it_is(factor: float) -> None:
    learned = []
    for seed in range(4):
        problem, *_ = solve_whole(fused(searched(factor, seed)))
        learned.append(problem.layout.state.nodes["ff1"].walk_factors[0])
    assert float(np.exp(np.mean(np.log(learned)))) == pytest.approx(factor, rel=0.35)


def test_the_pairs_of_one_walk_stand_behind_each_other_each_walks_as_they_were() -> None:
    state = fused(two_responders())
    before = state.ledger.table("pairs").copy()
    sort_by_walk(state)
    after, walking = state.ledger.table("pairs"), state.ledger.table("begins")[:, 1]
    walk = np.where(np.isin(after[:, 2:4], walking), after[:, 2:4], np.inf).min(axis=1)
    assert len(np.unique(walk)) > 1
    assert (np.diff(walk[np.isfinite(walk)]) >= 0.0).all()
    of_before = np.where(np.isin(before[:, 2:4], walking), before[:, 2:4], np.inf).min(axis=1)
    for each in np.unique(walk):
        assert np.array_equal(after[walk == each], before[of_before == each])


def test_a_solution_does_not_depend_on_the_order_of_the_pairs() -> None:
    state = fused(two_responders())
    as_they_came = problem_of(state)
    expected = as_they_came.solve(as_they_came.layout.start())
    sort_by_walk(state)
    by_walk = problem_of(state)
    found = by_walk.solve(by_walk.layout.start())
    assert not np.array_equal(by_walk.rows.t, as_they_came.rows.t)
    assert found.cost == pytest.approx(expected.cost, rel=1e-12)
    assert found.x == pytest.approx(expected.x, abs=1e-8)
