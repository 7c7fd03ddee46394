"""What a solution says of radios that may be off, whose anchors stand close together."""

import math

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.learning.delays import delay_of, delays, doubted
from estimator.smoothing.learning.radios import Delay, ranges_by_radio
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.windows import fused, problem_of

VEHICLE_M = {
    "a0": (0.7, 0.9, 0.5),
    "a1": (2.6, 0.9, 2.0),
    "a2": (2.6, -0.9, 2.0),
    "a3": (2.6, -0.9, 0.5),
}
SECONDS, SIGMA_M = 120, 0.1


def round_the_vehicle(seed: int, delay_m: float) -> list[AnyReading]:
    """Somebody without PDR walks round a vehicle, twenty metres off; his radio's ranges are all too long."""
    chance = np.random.default_rng(seed)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=place) for name, place in VEHICLE_M.items()
    ]
    readings.append(Node(t=0.0, node="f", role="responder", position_m=(22.0, 0.0, 1.0), sigma_m=0.5))
    for second in range(SECONDS):
        for k, (name, place) in enumerate(VEHICLE_M.items()):
            t = second + 0.1 + 0.23 * k
            at_m = 2.0 + 20.0 * math.cos(t / 20.0), 20.0 * math.sin(t / 20.0), 1.0
            range_m = math.dist(at_m, place) + delay_m + chance.normal(0.0, SIGMA_M)
            readings.append(Range(t=t, a="f", b=name, range_m=range_m, technology="uwb"))
    return readings


def at_rest(readings: list[AnyReading]) -> tuple[Problem, Solution]:
    problem = problem_of(fused(readings))
    begun = problem.solve(problem.layout.start(), METRES_OFF)
    return problem, problem.solve(begun.x)


def told(problem: Problem, solved: Solution, farther_m: float) -> tuple[list[Delay], float]:
    """What is said with him somewhat farther from the vehicle than he is, and what is left to be gained."""
    x = solved.x.copy()
    states = problem.layout.states(x, 0)
    states[:, :2] *= 1.0 + farther_m / np.hypot(states[:, 0], states[:, 1])[:, None]
    there = problem.solve(x, iterations=0)
    there.chain.solve()
    return delays(problem, there), there.chain.promised


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("farther_m", [-0.002, 0.002])
def test_what_a_solution_has_left_undone_is_no_delay(seed: int, farther_m: float) -> None:
    """Two millimetres, at which a window may rest, times 480 ranges are more than all that tells of one."""
    problem, solved = at_rest(round_the_vehicle(seed, 0.0))
    rested, _ = told(problem, solved, 0.0)
    found, undone = told(problem, solved, farther_m)
    assert undone < 0.1
    assert not doubted(found)
    assert {one.radio: round(one.odds) for one in found} == {one.radio: round(one.odds) for one in rested}


@pytest.mark.parametrize("farther_m", [-0.002, 0.0, 0.002])
def test_a_delay_is_the_same_wherever_a_solution_rests(farther_m: float) -> None:
    problem, solved = at_rest(round_the_vehicle(0, 3.0))
    (first, *_), _ = told(problem, solved, farther_m)
    assert first.radio == ("uwb", "f")
    assert first.bias_m == pytest.approx(3.0, abs=1.0)


@pytest.mark.parametrize("information", [0.0, 0.5, 20.0, 400.0])
@pytest.mark.parametrize("bias_m", [0.0, 0.2, -0.5, 1.5])
def test_a_radio_may_be_off_by_what_readings_and_both_kinds_of_radios_leave_open(
    information: float, bias_m: float
) -> None:
    """Against the mixture's density, summed up over all delays."""
    found = delay_of(("uwb", "f"), np.full(2, 0.5 * information * bias_m), 0.5 * information * np.eye(2))
    usual = physics.RANGE_BIAS_SIGMA_M["uwb"] ** 2
    wide = usual + physics.DELAY_SIGMA_M**2
    off_m = np.linspace(-15.0, 15.0, 300_001)
    usually, rarely = (np.exp(-0.5 * off_m**2 / variance) / math.sqrt(variance) for variance in (usual, wide))
    density = (1.0 - physics.DELAYED) * usually + physics.DELAYED * rarely
    density *= np.exp(-0.5 * information * (bias_m - off_m) ** 2)
    square = float((density * off_m**2).sum() / density.sum())
    assert found is not None
    assert found.off_m2 == pytest.approx(max(square - usual, 0.0), rel=1e-6, abs=1e-9)


def test_the_halves_of_the_time_are_those_of_epochs_whatever_the_order_of_the_ledger() -> None:
    state = fused(round_the_vehicle(0, 0.0))
    pairs = state.ledger.table("pairs")
    state.ledger.replace("pairs", pairs[np.argsort(pairs[:, 3], kind="stable")])
    problem = problem_of(state)
    told_of = ranges_by_radio(problem, problem.solve(problem.layout.start()))
    t, (radio,) = problem.rows.t[told_of.ranges], [r for r, (_, n) in enumerate(told_of.radios) if n == "f"]
    end = np.argmax(told_of.carried == radio, axis=1)
    late = told_of.half[np.arange(len(t)), end] == 1
    assert late.any()
    assert t[~late].max() <= t[late].min()


def test_a_breadcrumb_that_only_anchors_range_may_have_a_delay() -> None:
    """Nobody moves: a window has no walks, and is asked all the same."""
    chance = np.random.default_rng(1)
    corners = {"a0": (0.0, 0.0), "a1": (20.0, 0.0), "a2": (0.0, 20.0), "a3": (20.0, 20.0), "a4": (10.0, -8.0)}
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*place, 0.0), sigma_m=0.1)
        for name, place in corners.items()
    ]
    readings.append(Node(t=0.0, node="b1", role="breadcrumb", position_m=(8.0, 6.0, 0.0), sigma_m=1.0))
    for second in range(SECONDS):
        for k, (name, place) in enumerate(corners.items()):
            range_m = math.dist((8.0, 6.0), place) + 2.0 + float(chance.normal(0.0, SIGMA_M))
            readings.append(Range(t=second + 0.1 * k, a="b1", b=name, range_m=range_m, technology="uwb"))
    problem = problem_of(fused(readings), 0.0)
    assert not problem.layout.walks
    solved = problem.solve(problem.layout.start(), METRES_OFF)
    solved.chain.solve()
    (first, *_) = delays(problem, solved)
    assert first.radio == ("uwb", "b1")
    assert first.bias_m == pytest.approx(2.0, abs=0.1)
