"""How likely readings are with heights that nobody measured: over all of these, not at their best."""

import numpy as np
import pytest

from estimator.fusion.memory.state import FusionState
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.smoothing.problem.newton import RESTING, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.held_heights import UP
from estimator.smoothing.units.marginal_cost import marginal_cost
from estimator.smoothing.units.unseen_climbs import find_unseen_climb
from tests.estimator.smoothing.windows import entered, fused, problem_of, unlikelihood

ANCHORS_M = ((1.0, -1.5), (4.0, 3.5), (7.0, -1.5), (9.5, 3.5))
"""Each is passed at a metre and a half: from so near a height would change much of what is heard."""
CLIMB_M2 = 0.09
"""What a second's way is unsure by in height, if its bearer may climb (m²)."""


def crew(seconds: int) -> list[AnyReading]:
    """Two go side by side on one floor, and hear four anchors; their units measure no heights."""
    chance = np.random.default_rng(seconds)
    readings: list[AnyReading] = [entered(node="ff1"), entered(0.0, 2.0, node="ff2")]
    for k, (east, north) in enumerate(ANCHORS_M):
        place = (east, north, 0.0)
        readings.append(Node(t=0.0, node=f"a{k}", role="anchor", position_m=place, sigma_m=0.1))
    for second in range(1, seconds + 1):
        for name, aside in (("ff1", 0.0), ("ff2", 2.0)):
            east = float(10.0 - abs(second % 20 - 10))
            led = 1.0 if (second - 1) % 20 < 10 else -1.0
            readings.append(Displacement(t=float(second), node=name, delta_m=(led, 0.0, 0.0)))
            for k, (e, n) in enumerate(ANCHORS_M):
                off_m = max(float(np.hypot(east - e, aside - n)), 0.5)
                dbm = -42.0 - 22.0 * np.log10(off_m) + chance.normal(0.0, 5.0)
                readings.append(Rssi(t=float(second), a=name, b=f"a{k}", dbm=float(dbm)))
    return readings


def free(state: FusionState) -> Problem:
    """The whole incident with everybody's steps as unsure in height as stairs make them, a little above."""
    other = state.copy()
    steps = other.ledger.table("steps").copy()
    steps[:, 7] = np.maximum(steps[:, 7], CLIMB_M2)
    other.ledger.replace("steps", steps)
    return problem_of(other)


def both() -> list[tuple[Problem, Solution]]:
    """The same incident solved on its floor, and off it."""
    state = fused(crew(60))
    level, climbing = problem_of(state), free(state)
    flat = level.solve(level.layout.start())
    x = flat.x.copy()
    for i in range(2):
        level.layout.states(x, i)[:, UP] += 0.5
    return [(level, flat), (climbing, climbing.solve(x))]


def test_the_likelihood_over_all_heights_is_that_of_the_whole_matrix() -> None:
    (level, flat), (climbing, found) = both()
    before, after = (marginal_cost(p, s).all for p, s in ((level, flat), (climbing, found)))
    expected = unlikelihood(climbing, found) - unlikelihood(level, flat)
    assert after - before == pytest.approx(expected - across(found) + across(flat), abs=1e-6)


def across(solved: Solution) -> float:
    """½ log |Q| of all that is no height: a unit's scale changes it, and is not judged by that."""
    logs = (np.linalg.slogdet(m.noise)[1] - np.log(m.noise[:, UP, UP]) for m in solved.motions)
    return 0.5 * sum(float(each.sum()) for each in logs)


def test_shares_of_walks_whose_readings_are_their_own_add_up_to_nearly_all() -> None:
    (level, flat), (climbing, found) = both()
    before, after = (marginal_cost(p, s) for p, s in ((level, flat), (climbing, found)))
    shares = after.each - before.each
    assert shares.sum() == pytest.approx(after.all - before.all, abs=1.0)


def test_heights_that_fit_what_powers_scatter_by_are_not_likelier() -> None:
    (level, flat), (climbing, found) = both()
    assert found.cost < flat.cost
    assert marginal_cost(climbing, found).all > marginal_cost(level, flat).all


def test_on_one_floor_the_powers_of_ten_minutes_let_nobody_climb() -> None:
    state = fused(crew(600))
    level = problem_of(state)
    flat = level.solve(level.layout.start())
    same, _ = find_unseen_climb(level, flat, problem_of, RESTING)
    assert same is level
    assert not any(node.climbs for node in state.nodes.values())
