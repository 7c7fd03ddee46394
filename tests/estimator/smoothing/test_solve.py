"""Where a solution may start from."""

import numpy as np
import pytest

from estimator.smoothing.solve import Problem
from estimator.smoothing.walks import STATES
from tests.estimator.smoothing.test_marginals import window_from
from tests.estimator.smoothing.test_slips import walk
from tests.estimator.smoothing.windows import fused, problem_of
from tests.estimator.walks import two_responders


def going_on() -> Problem:
    """The second half of what two responders, who hear each other, have gone: the first half is its prior."""
    whole = problem_of(fused(two_responders(seconds=40)))
    solved, cut = whole.solve(whole.layout.start()), whole.layout.length // 2
    return window_from(whole, solved, cut)


def test_since_an_epoch_a_unit_goes_its_own_way_and_before_it_nothing_changes() -> None:
    problem = problem_of(fused(walk()))
    layout = problem.layout
    x = layout.start()
    since = int(np.searchsorted(layout.grid, 60.0))
    kinked = x.copy()
    kinked[: layout.length * layout.width].reshape(layout.length, STATES)[since + 1 :, :2] += 5.0
    assert max(np.abs(problem.motions(kinked)[0].residual[since])) > 4.0
    reckoned = problem.going.reckoned(kinked, float(layout.grid[since]))
    assert np.abs(problem.motions(reckoned)[0].residual[since:]).max() < 1e-9
    before = slice(0, (since + 1) * layout.width)
    assert np.array_equal(reckoned[before], x[before])
    border = slice(layout.length * layout.width, None)
    assert np.array_equal(reckoned[border], x[border])


def test_rows_that_are_left_out_neither_pull_nor_cost() -> None:
    problem = problem_of(fused(walk()))
    left_out = np.arange(0, len(problem.rows.pairs), 3)
    others = problem.without(left_out)
    x = problem.layout.start()
    found = others.solve(x)
    assert abs(found.cost - problem.solve(x).cost) > 1.0
    problem.rows.readings.value[left_out] += 50.0
    again = others.solve(x)
    assert np.abs(again.x - found.x).max() < 1e-9
    assert again.cost == found.cost


@pytest.mark.parametrize("problem", [problem_of(fused(two_responders(seconds=40))), going_on()])
@pytest.mark.parametrize("moving", [0, 1])
def test_who_is_held_stays_and_the_others_rest_where_nothing_pulls_them_any_more(
    problem: Problem, moving: int
) -> None:
    layout, x = problem.layout, problem.layout.start()
    layout.states(x, moving)[1:, :2] += 0.3
    found = problem.beside({moving}, problem.motions(x)).solve(x, iterations=60, resting=1e-12)
    assert np.array_equal(layout.states(found.x, 1 - moving), layout.states(x, 1 - moving))
    assert np.abs(layout.states(found.x, moving) - layout.states(x, moving)).max() > 0.1
    there = problem.at(found.x)
    assert found.cost == pytest.approx(there.cost, rel=1e-12)
    linear = problem.linearise(found.x)
    whole = problem.assemble(found.x, linear, problem.weigh(linear.residual), there.motions)
    pulled = whole.slope()
    size = layout.length * layout.width
    strongest = np.abs(layout.states(pulled, 1 - moving)).max()
    assert np.abs(layout.states(pulled, moving)).max() < 1e-4 * strongest
    assert np.abs(pulled[size:]).max() < 1e-4 * strongest


def test_who_is_not_held_costs_as_much_as_among_all() -> None:
    """Images of one way are weighed by it: nobody else has gone another way."""
    problem = problem_of(fused(two_responders(seconds=40)))
    x = problem.layout.start()
    beside = problem.beside({1}, problem.motions(x))
    for off_m in (0.5, 5.0):
        problem.layout.states(x, 1)[10:, :2] += off_m
        assert beside.at(x).cost == pytest.approx(problem.at(x).cost, rel=1e-12)
