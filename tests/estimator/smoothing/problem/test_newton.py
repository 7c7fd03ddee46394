"""Where a solution may start from, and where its search ends."""

from typing import Any

import numpy as np
from msgspec.structs import replace

from estimator.graph.dense import Array
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.newton import METRES_OFF, UPHILL, Problem
from tests.estimator.smoothing.learning.test_wrong_steps import walk
from tests.estimator.smoothing.windows import fused, problem_of


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


def test_units_found_to_be_noisier_are_solved_as_in_a_problem_made_anew() -> None:
    state = fused(walk())
    problem = problem_of(state)
    x = problem.solve(problem.layout.start()).x
    for walked in problem.layout.walks:
        state.keep(replace(state.life(walked.number), walk_factors=(9.0, 4.0)))
    anew = problem_of(state)
    found = problem.with_units(anew.layout).solve(x)
    expected = Problem(anew.layout, problem.rows, None).solve(x)
    assert np.array_equal(found.x, expected.x)
    assert found.cost == expected.cost
    assert np.abs(found.x - x).max() > 1e-3


class _Elsewhere(Problem):
    """A problem whose first-estimate Jacobians point elsewhere than its cost falls."""

    tried = 0

    def jacobian(self, x: Array) -> Array:
        return -super().jacobian(x)

    def assemble(self, *args: Any) -> Chain:
        self.tried += 1
        return super().assemble(*args)


def test_a_search_that_only_leads_uphill_ends_soon_where_it_is() -> None:
    plain = problem_of(fused(walk()))
    rest = plain.solve(plain.layout.start())
    found = (problem := _Elsewhere(plain.layout, plain.rows, None)).solve(rest.x)
    assert np.array_equal(found.x, rest.x)
    assert found.stuck
    assert not found.rests
    assert problem.tried == UPHILL


def test_where_whole_steps_have_led_uphill_the_search_begins_again_without_them() -> None:
    plain = problem_of(fused(walk()))
    x = plain.solve(plain.layout.start()).x
    misled = _Elsewhere(plain.layout, plain.rows, None)
    assert misled.solve(x, METRES_OFF, len(METRES_OFF) + UPHILL).cost == misled.solve(x).cost


def test_a_search_that_rests_is_not_stuck() -> None:
    problem = problem_of(fused(walk()))
    found = problem.solve(problem.layout.start())
    assert found.rests
    assert not found.stuck
