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


def test_what_is_left_on_the_last_keyframe_is_the_same_after_its_equations_have_been_eliminated() -> None:
    problem, solved = solved_of(crossing(TWO))
    last = problem.layout.length - 1
    expected = solved.assemble().remainder(last)
    solved.chain.reduce()
    assert solved.chain.reduced
    found = solved.remainder(last)
    assert np.array_equal(found.matrix, expected.matrix)
    assert np.array_equal(found.vector, expected.vector)


def test_a_chain_that_has_been_reduced_is_reduced_no_further() -> None:
    _, solved = solved_of(crossing(TWO))
    left = solved.chain.reduce().copy()
    before = solved.chain.border_covariance()
    assert np.array_equal(solved.chain.reduce(), left)
    assert np.array_equal(solved.chain.border_covariance(), before)
