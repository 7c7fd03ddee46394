"""What one radio alone tells for another way, and whether ranges agree with it."""

import math

import numpy as np

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.agreeing_ranges import ranges_agree
from estimator.smoothing.units.told_most import told_most
from tests.estimator.smoothing.windows import entered, fused, problem_of

AFAR_M = ((30.0, 40.0), (30.0, -40.0), (-10.0, 40.0))
SECONDS, FROM_S, PACE_M = 40, 20, 0.8


def walked(wrong_m: float) -> Problem:
    """He walks east among three radios; the first tells ranges that are off by so much from a time on."""
    chance = np.random.default_rng(2)
    readings: list[AnyReading] = [entered()]
    for k, (east, north) in enumerate(AFAR_M):
        readings.append(Node(t=0.0, node=f"r{k}", role="anchor", position_m=(east, north, 0.0), sigma_m=0.1))
    for second in range(1, SECONDS + 1):
        t = float(second)
        readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(PACE_M, 0.0, 0.0)))
        for k, place in enumerate(AFAR_M):
            off_m = wrong_m if k == 0 and second > FROM_S else 0.0
            range_m = math.dist((PACE_M * second, 0.0), place) + off_m + float(chance.normal(0.0, 0.1))
            readings.append(Range(t=t, a="ff1", b=f"r{k}", range_m=range_m, technology="uwb"))
    return problem_of(fused(readings))


def both(problem: Problem) -> tuple[Solution, Solution]:
    """The solution, and one in which he has gone two metres aside since."""
    solved = problem.solve(problem.layout.start(), METRES_OFF)
    aside: Array = solved.x.copy()
    states = problem.layout.states(aside, 0)
    states[problem.layout.times[:, 0] > FROM_S, :2] += (1.2, 1.6)
    return solved, problem.solve(aside, iterations=0)


def test_a_radio_that_was_moved_may_tell_anything() -> None:
    """The other way fits what it tells better, and what both others tell worse."""
    problem = walked(-2.0)
    solved, other = both(problem)
    told = told_most(problem, solved, problem, other, problem.layout.walks[0])
    assert told > 20.0
    assert told > solved.cost - other.cost


def test_no_radio_tells_for_another_way_where_all_fits() -> None:
    problem = walked(0.0)
    solved, other = both(problem)
    assert told_most(problem, solved, problem, other, problem.layout.walks[0]) < 1.0


def test_ranges_agree_with_the_way_that_they_were_measured_along() -> None:
    problem = walked(0.0)
    solved, other = both(problem)
    number = problem.layout.walks[0].number
    assert ranges_agree(problem, solved, number, float(FROM_S))
    assert not ranges_agree(problem, other, number, float(FROM_S))
    assert ranges_agree(problem, other, number, float(SECONDS))
