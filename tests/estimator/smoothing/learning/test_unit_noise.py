"""How noisy a unit is, learned from its way: the score of the marginal likelihood, and where it leads to."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.holding import flush
from estimator.fusion.memory.ledger import Ledger
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.position import Position
from estimator.smoothing.keyframes import walks
from estimator.smoothing.learning import unit_noise
from estimator.smoothing.learning.wrong_steps import doubts_of
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.windows import entered, problem_of, unlikelihood

FIX_M, FIX_S = 0.02, 2
"""Fixes at keyframes only: what a unit errs between a keyframe and a reading after it is not modelled."""
PLACE = physics.WALK_M_PER_ROOT_M**2 + physics.STAND_M_PER_ROOT_S**2 + physics.DISPLACEMENT_FLOOR_M**2
TURN = physics.HEADING_WALK_RAD_PER_ROOT_M**2 + physics.GYRO_WALK_RAD_PER_ROOT_S**2
"""Variances that are assumed of a metre in a second."""


def walked(
    seconds: int, factors: tuple[float, float], seed: int = 1, dies_s: float = math.inf
) -> FusionState:
    """A unit with so many times the assumed variances walks about, with a sharp fix at each keyframe.

    Args:
        seconds: for how long.
        factors: of position and of heading.
        seed: of chance.
        dies_s: from when on the unit tells nothing.
    """
    chance = np.random.default_rng(seed)
    place, heading_error = np.zeros(3), 0.0
    readings: list[AnyReading] = [entered()]
    for second in range(1, seconds + 1):
        heading_error += math.sqrt(0.5 * factors[1] * TURN) * chance.normal()
        direction = 0.1 * second + 2.0 * math.sin(0.03 * second)
        place = place + np.array([math.cos(direction), math.sin(direction), 0.0])
        told = direction - heading_error
        noise = math.sqrt(factors[0] * PLACE) * chance.normal(0.0, 1.0, 3)
        delta = (math.cos(told) + noise[0], math.sin(told) + noise[1], noise[2])
        heading_error += math.sqrt(0.5 * factors[1] * TURN) * chance.normal()
        if second <= dies_s:
            readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=delta))
        if second % FIX_S == 0:
            e, n, u = (place + chance.normal(0.0, FIX_M, 3)).tolist()
            readings.append(Position(t=float(second), node="ff1", position_m=(e, n, u), sigma_m=(FIX_M,) * 3))
    state = FusionState()
    state.ledger = Ledger(complete=True)
    fold_tick(state, 0.5, readings[:1])
    with pytest.MonkeyPatch.context() as here:
        # These fixes share nothing.
        here.setattr(physics, "ABSOLUTE_SHARED", 0.0)
        for second in range(1, seconds + 1):
            fold_tick(state, float(second), [r for r in readings[1:] if second - 1.0 < r.t <= second])
        flush(state)
    state.keep_poses()
    return state


def assume(state: FusionState, factors: tuple[float, float]) -> None:
    state.nodes["ff1"] = replace(state.nodes["ff1"], walk_factors=factors)


def learn_once(state: FusionState, most: float = 0.3) -> Solution:
    problem = problem_of(state)
    solved = problem.solve(problem.layout.start())
    solved.chain.solve()
    found, ahead, _ = solved.chain.covariances()
    unit_noise.learn_walks(state, problem, solved, doubts_of(problem, solved, found, ahead), most)
    return solved


@pytest.fixture(scope="module", params=[(1.0, 1.0), (3.0, 0.4), (0.4, 4.0)], ids=str)
def truth_and_state(request: pytest.FixtureRequest) -> tuple[tuple[float, float], FusionState]:
    return request.param, walked(1200, request.param)


@pytest.mark.parametrize("off", [10.0, 0.1])
def test_from_far_off_both_factors_are_led_to_the_truth(
    truth_and_state: tuple[tuple[float, float], FusionState], off: float
) -> None:
    truth, state = truth_and_state
    first = (float(np.clip(truth[0] * off, 0.03, 20.0)), float(np.clip(truth[1] * off, 0.03, 20.0)))
    assume(state, first)
    learn_once(state)
    for before, after, right in zip(first, state.nodes["ff1"].walk_factors, truth, strict=True):
        assert abs(math.log(after / right)) < abs(math.log(before / right))
    seen = []
    for _ in range(20):
        learn_once(state)
        seen.append(np.log(state.nodes["ff1"].walk_factors))
    # On a long way each step is as long as it may be: the factors go to and fro about where they belong.
    settled = np.exp(np.mean(seen[-4:], axis=0)).tolist()
    for learned, right in zip(settled, truth, strict=True):
        assert right / 1.6 < learned < right * 1.6


def test_how_a_bearer_goes_while_his_unit_tells_nothing_is_not_its_noise() -> None:
    learned = []
    for seconds in (80, 200):
        state = walked(seconds, (1.0, 1.0), dies_s=80.0)
        for _ in range(12):
            learn_once(state)
        learned.append(state.nodes["ff1"].walk_factors)
    assert learned[1] == pytest.approx(learned[0], rel=0.1)


def score_of(step: float, off: float) -> float:
    """The score that a step of 2 (score − off) / (1 + |score|) has been made from."""
    step = 0.5 * step
    above, below = (step + off) / (1.0 - step), (step + off) / (1.0 + step)
    return above if above >= 0.0 else below


@pytest.mark.parametrize("factors", [(1.0, 1.0), (2.0, 0.7), (0.6, 1.8)])
def test_steps_follow_the_derivative_of_the_marginal_likelihood(
    factors: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(walks, "FLOOR", np.zeros(6))  # what is no part of the factors
    monkeypatch.setattr(unit_noise, "SEEN", 0.0)  # so that a step tells its score
    state = walked(40, (1.2, 1.5))
    assume(state, factors)
    solved = learn_once(state, most=2.0)
    learned = state.nodes["ff1"].walk_factors
    for i in (0, 1):
        score = score_of(math.log(learned[i] / factors[i]), math.log(factors[i]))
        values = []
        for change in (1e-3, -1e-3):
            there = list(factors)
            there[i] *= math.exp(change)
            assume(state, (there[0], there[1]))
            values.append(unlikelihood(problem_of(state), solved))
        assert score == pytest.approx(-(values[0] - values[1]) / 2e-3, rel=1e-3, abs=1e-3)


def test_a_crew_that_stood_still_tells_how_well_the_gyro_of_the_next_one_is_calibrated() -> None:
    state, seconds = FusionState(), range(1, 61)
    fold_tick(state, 0.5, [entered(node=f"ff{i}") for i in range(4)])
    for second in seconds:
        stood = [
            Displacement(
                t=float(second),
                from_t=second - 1.0,
                node=f"ff{i}",
                delta_m=(0.0, 0.0, 0.0),
                heading_rad=math.radians(bias) * second,
            )
            for i, bias in enumerate((0.03, -0.05, 0.04, 0.06))
        ]
        fold_tick(state, float(second), stood)
    before = state.bias_sigma_radps(state.nodes["ff0"])
    problem = problem_of(state)
    unit_noise.learn(state, problem, problem.solve(problem.layout.start()), problem_of)
    fold_tick(state, 61.0, [entered(node="new")])
    assert state.bias_sigma_radps(state.nodes["new"]) < 0.5 * before
    information, product = state.nodes["ff3"].bias_told
    # A turn that is reported and was none turns the unit's frame back by as much.
    assert product / information == pytest.approx(-math.radians(0.06), abs=math.radians(0.02))
