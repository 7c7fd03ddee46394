"""What is known of a solved window."""

import numpy as np

from tests.estimator.smoothing.images.test_flip_ambiguity import TWO, crossing, solved_of


def test_the_equations_of_a_solution_are_those_at_its_estimate_and_are_made_once() -> None:
    problem, solved = solved_of(crossing(TWO))
    linear, motions = problem.linearise(solved.x), problem.motions(solved.x)
    there = problem.assemble(solved.x, linear, solved.weighted, motions)
    assert np.array_equal(solved.chain.slope(), there.slope())
    solved.chain.reduce()
    again = solved.assemble()
    assert solved.chain is not again
    assert np.array_equal(again.slope(), there.slope())
