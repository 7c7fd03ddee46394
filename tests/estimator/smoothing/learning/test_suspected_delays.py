"""What a delay that a radio may have does to everything, were it there."""

import numpy as np
import pytest

from estimator.fusion.learned.delays import Suspicion
from estimator.graph.robust import Weighted
from estimator.smoothing.learning.delays import scored_delays
from estimator.smoothing.learning.radios import Delay, ranges_by_radio
from estimator.smoothing.learning.suspected_delays import suspects, suspicions
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.learning.test_delays import round_the_vehicle
from tests.estimator.smoothing.windows import dense, fused, problem_of
from tests.estimator.trackers.test_delays_outside import world


def at_rest(delay_m: float) -> tuple[Problem, Solution]:
    problem = problem_of(fused(round_the_vehicle(0, delay_m)))
    return problem, problem.solve(problem.solve(problem.layout.start()).x)


def shorter(weighted: Weighted, ranges: np.ndarray, by_m: float) -> Weighted:
    residual = weighted.residual.copy()
    residual[ranges] -= by_m
    return weighted._replace(residual=residual)


@pytest.mark.parametrize("radio", ["f", "a1"])
def test_everything_is_where_it_would_be_with_ranges_that_are_a_metre_shorter(radio: str) -> None:
    """Against the whole normal equations, solved with such ranges."""
    problem, solved = at_rest(0.0)
    told = ranges_by_radio(problem, solved)
    mine = told.ranges[(told.carried == told.radios.index(("uwb", radio))).any(axis=1)]
    matrix, slope = dense(solved.chain)
    other = shorter(solved.weighted, mine, 1.0)
    pulled = problem.assemble(solved.x, solved.linear, other, solved.motions).slope() - slope
    solved.chain.reduce()
    (found,) = suspects(problem, solved, told, [Delay(("uwb", radio), 0.0, 1.0, True, 0.5)])
    assert found.off_m2 == 0.5
    assert found.moved == pytest.approx(np.linalg.solve(matrix, pulled), rel=1e-4, abs=1e-6)
    assert np.abs(found.moved).max() > 0.1


def told_in_a_window(delay_m: float, middle_m: float) -> dict[str, Suspicion]:
    """What a crew's radios are suspected of, the first of which is off."""
    problem = problem_of(fused(world(53, delay_m, crew=3, unit=True, middle_m=middle_m).readings))
    solved = problem.solve(problem.solve(problem.layout.start()).x)
    solved.chain.reduce()
    told = ranges_by_radio(problem, solved)
    found = suspicions(problem, solved, told, scored_delays(problem, solved, told))
    return {name: suspicion for (_, name), suspicion in found.items()}


@pytest.mark.parametrize("middle_m", [0.0, 18.0])
def test_good_radios_are_soon_not_suspected(middle_m: float) -> None:
    assert told_in_a_window(0.0, middle_m) == {}


def test_one_that_is_off_is_suspected_of_more_than_others() -> None:
    found = told_in_a_window(0.5, 18.0)
    assert not any(suspicion.alone for suspicion in found.values())
    off_m = {name: suspicion.off["uwb"][1] for name, suspicion in found.items()}
    assert 0.1 < off_m.pop("ff0") < 0.6
    assert set(off_m) == {"ff1"}
    assert all(other_m < 0.1 for other_m in off_m.values())
