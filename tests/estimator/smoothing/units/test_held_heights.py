"""What readings cost with heights and all else held: against all heights looked for one by one."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from msgspec.structs import replace
from scipy.optimize import minimize

from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.smoothing.problem.newton import RESTING, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units import held_heights, unseen_climbs
from estimator.smoothing.units.held_heights import UP, height_costs
from estimator.smoothing.units.marginal_cost import MarginalCost
from estimator.smoothing.units.unseen_climbs import OFF_PLANE_M, find_unseen_climb
from tests.estimator.smoothing.units.test_marginal_cost import ANCHORS_M, CLIMB_M2, both, crew
from tests.estimator.smoothing.windows import difference, fused, problem_of


def test_what_heights_cost_is_their_best_and_how_many_there_might_be(monkeypatch: pytest.MonkeyPatch) -> None:
    (level, flat), (climbing, _) = both()
    climbs_m2 = climbing.motions(flat.x)[0].noise[:, UP, UP]
    climbing.rows.sigma = level.rows.sigma

    def at(heights_m: Array) -> Array:
        x = flat.x.copy()
        climbing.layout.states(x, 0)[1:, UP] = heights_m
        return x

    def cost(heights_m: Array) -> float:
        return climbing.at(at(heights_m)).cost

    # No height tells up from down: the best ones above the floor.
    start = np.full(len(climbs_m2), OFF_PLANE_M)
    best = minimize(cost, start, tol=1e-8).x
    slopes = difference(lambda heights_m: climbing.rows.residual(at(heights_m)), best)
    rises = np.diff(np.eye(len(best)), axis=0, prepend=np.zeros((1, len(best))))
    known = climbing.weigh(climbing.rows.residual(at(best))).information
    information = (slopes.T * known) @ slopes + (rises.T / climbs_m2) @ rises
    doubt = 0.5 * float(np.linalg.slogdet(information)[1] + np.log(climbs_m2).sum())
    expected = cost(best) - cost(0.0 * best) + doubt
    assert height_costs(level, flat, {0: climbs_m2}, OFF_PLANE_M)[0] == pytest.approx(expected, abs=0.5)
    monkeypatch.setattr(held_heights, "STEPS", 60)
    assert height_costs(level, flat, {0: climbs_m2}, OFF_PLANE_M)[0] == pytest.approx(expected, abs=0.01)


def test_heights_that_are_hopeless_with_all_else_held_are_not_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    state = fused(crew(60))
    level = problem_of(state)
    flat = level.solve(level.layout.start())
    for cost in (unseen_climbs.HOPELESS + 1.0, unseen_climbs.HOPELESS - 1.0):
        monkeypatch.setattr(unseen_climbs, "height_costs", lambda *_, cost=cost: {0: 99.0, 1: cost})
        built: list[FusionState] = []

        def build(other: FusionState, built: list[FusionState] = built) -> Problem:
            built.append(other)
            return problem_of(other)

        same, _ = find_unseen_climb(level, flat, build, RESTING)
        assert same is level
        assert bool(built) == (cost < unseen_climbs.HOPELESS)


def climbed(kind: Callable[[Rssi, float], AnyReading]) -> Problem:
    """The same two; one of them is a storey up from half of four minutes on.

    Args:
        kind: makes the reading of a power, and of how far apart its ends are, half of them a storey (m).
    """
    readings: list[AnyReading] = []
    for reading in crew(240):
        if isinstance(reading, Rssi):
            up_m = 3.0 * min(max((reading.t - 120.0) / 15.0, 0.0), 1.0) if reading.a == "ff1" else 0.0
            east, aside = 10.0 - abs(reading.t % 20 - 10.0), 0.0 if reading.a == "ff1" else 2.0
            e, n = ANCHORS_M[int(reading.b[1:])]
            readings.append(kind(reading, float(np.sqrt((east - e) ** 2 + (aside - n) ** 2 + up_m**2))))
        else:
            readings.append(reading)
    return problem_of(fused(readings))


def power(heard: Rssi, away_m: float) -> Rssi:
    """What is heard over a distance (m)."""
    return replace(heard, dbm=-42.0 - 22.0 * math.log10(max(away_m, 0.5)) + 2.0 * math.sin(7.0 * heard.t))


def test_who_has_climbed_is_not_hopeless_though_all_else_is_held() -> None:
    problem = climbed(power)
    flat = problem.solve(problem.layout.start())
    climbs_m2 = {i: np.full(problem.layout.length - 1, CLIMB_M2) for i in range(2)}
    found = height_costs(problem, flat, climbs_m2, OFF_PLANE_M)
    assert found[0] < 0.0 < found[1]


def distance(heard: Rssi, away_m: float) -> Range:
    """A range over a distance (m) in place of what is heard."""
    return Range(t=heard.t, a=heard.a, b=heard.b, range_m=away_m, technology="uwb")


def test_who_is_ranged_is_asked_with_all_else_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unseen_climbs, "height_costs", lambda *_: {0: 99.0, 1: 99.0})
    for problem in (climbed(power), climbed(distance)):
        flat, built = problem.solve(problem.layout.start()), list[FusionState]()

        def build(other: FusionState, built: list[FusionState] = built) -> Problem:
            built.append(other)
            return problem_of(other)

        find_unseen_climb(problem, flat, build, RESTING)
        assert bool(built) == bool((problem.rows.pairs[:, 1] == RANGE).any())


@pytest.mark.parametrize("kind", [power, distance])
def test_of_powers_alone_three_steps_tell_whether_anybody_is_likelier_with_heights(
    kind: Callable[[Rssi, float], AnyReading], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of ranges too where they speak more clearly: from there some have gone on to a storey."""
    monkeypatch.setattr(unseen_climbs, "height_costs", lambda *_: {0: 0.0, 1: 0.0})
    problem = climbed(kind)
    flat = problem.solve(problem.layout.start())
    restless = dataclasses.replace(flat, rests=False)

    def solved(more: float) -> int:
        """How often heights are solved for with which, after three steps, one of two costs so much more."""
        costs = iter([MarginalCost(0.0, np.zeros(2)), MarginalCost(0.0, np.array([99.0, more]))])
        monkeypatch.setattr(unseen_climbs, "marginal_cost", lambda *_: next(costs))
        asked: list[Array] = []

        def solve(x: Array, **_: float) -> Solution:
            asked.append(x)
            return restless

        def build(other: FusionState) -> Problem:
            trial = problem_of(other)
            monkeypatch.setattr(trial, "solve", solve)
            return trial

        find_unseen_climb(problem, flat, build, RESTING)
        return len(asked)

    assert solved(-1.0) == 2
    assert solved(1.0) == (1 if kind is power else 2)
    assert solved(unseen_climbs.HOPELESS + 1.0) == 1
