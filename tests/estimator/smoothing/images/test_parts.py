"""Some walks of a window by themselves, up to some keyframe, with all others held where they are."""

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.heading_images import facing, turn
from estimator.smoothing.images.parts import Parts
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.problem.newton import Problem
from tests.estimator.smoothing.problem.test_marginals import window_from
from tests.estimator.smoothing.windows import fused, problem_of
from tests.estimator.walks import two_responders


def going_on() -> Problem:
    """The second half of what two responders, who hear each other, have gone: the first half is its prior.

    It tells enough that nothing ends far from where the prior was linearised: there rows and costs disagree.
    """
    whole = problem_of(fused(two_responders(seconds=80)))
    solved, cut = whole.solve(whole.layout.start()), whole.layout.length // 2
    return window_from(whole, solved, cut)


def pulled(problem: Problem, x: Array) -> Array:
    """The gradient at an estimate, flat."""
    linear = problem.linearise(x)
    problem.rows.widen(x, linear.jacobian)
    return problem.assemble(x, linear, problem.weigh(linear.residual), problem.motions(x)).slope()


def solved_alone(problem: Problem, moving: int) -> tuple[Array, Array, Problem, Unknowns]:
    """An estimate with one walk 0.3 m off, that walk solved alone from there, and its part of the problem."""
    layout, x = problem.layout, problem.layout.start()
    layout.states(x, moving)[1:, :2] += 0.3
    part = Parts(problem, x).of({moving}, layout.length - 1)
    there = x.copy()
    there[part.numbers.kept] = part.problem.solve(part.numbers.taken(x), iterations=60, resting=1e-12).x
    return x, there, part.problem, part.numbers


@pytest.mark.parametrize("problem", [problem_of(fused(two_responders(seconds=40))), going_on()])
@pytest.mark.parametrize("moving", [0, 1])
def test_who_is_held_stays_and_nothing_pulls_the_others_any_more(problem: Problem, moving: int) -> None:
    layout = problem.layout
    x, there, part, numbers = solved_alone(problem, moving)
    assert np.array_equal(layout.states(there, 1 - moving), layout.states(x, 1 - moving))
    assert np.abs(layout.states(there, moving) - layout.states(x, moving)).max() > 0.1
    strongest = np.abs(layout.states(pulled(problem, there), 1 - moving)).max()
    assert np.abs(pulled(part, numbers.taken(there))).max() < 1e-4 * strongest


@pytest.mark.parametrize("moving", [0, 1])
def test_who_rests_by_himself_rests_among_all(moving: int) -> None:
    """What they hear of each other, and the border, pull him as they do among all."""
    problem = problem_of(fused(two_responders(seconds=40)))
    _, there, _, _ = solved_alone(problem, moving)
    own, other = (
        np.abs(problem.layout.states(pulled(problem, there), i)).max() for i in (moving, 1 - moving)
    )
    assert own < 1e-4 * other


@pytest.mark.parametrize("problem", [problem_of(fused(two_responders(seconds=40))), going_on()])
def test_what_one_goes_elsewhere_costs_as_much_more_as_among_all(problem: Problem) -> None:
    """Images of one way are weighed by it: nobody else has gone another way."""
    x = problem.layout.start()
    last = problem.layout.length - 1
    part, here = Parts(problem, x).of({1}, last), problem.at(x).cost
    for off_m in (0.5, 5.0):
        problem.layout.states(x, 1)[5:, :2] += off_m
        assert part.more(x) == pytest.approx(problem.at(x).cost - here, rel=1e-9)


def test_a_beginning_is_told_by_what_was_heard_then() -> None:
    problem = problem_of(fused(two_responders(seconds=40)))
    layout, x = problem.layout, problem.layout.start()
    beginning = Parts(problem, x).of({1}, until=10)
    layout.states(x, 1)[11:, :2] += 3.0
    assert beginning.more(x) == 0.0
    layout.states(x, 1)[5:, :2] += 3.0
    assert 1.0 < beginning.more(x) < Parts(problem, layout.start()).of({1}, layout.length - 1).more(x)


def test_the_rest_of_a_way_goes_along_with_its_beginning() -> None:
    """A way that was turned about where it begins leads back to where it was, all of it."""

    problem = problem_of(fused(two_responders(seconds=40)))
    layout, solved = problem.layout, problem.solve(problem.layout.start())
    turned = solved.x.copy()
    turn(layout, turned, 0, Flip(0, facing(layout.states(turned, 0)[0, :2].copy(), 0.3)))
    back = Parts(problem, solved.x).of({0}, until=10).led(turned, (1.0, 0.3, 0.1), 20)
    was, off = layout.states(solved.x, 0), layout.states(back, 0)
    assert np.hypot(*(layout.states(turned, 0) - was)[:, :2].T).max() > 1.5
    assert np.hypot(*(off - was)[:, :2].T).max() < 1.0
    steps = np.diff(off[10:, :2], axis=0)
    assert np.hypot(*steps.T) == pytest.approx(np.hypot(*np.diff(was[10:, :2], axis=0).T), abs=1e-9)
    assert np.array_equal(layout.states(back, 1), layout.states(solved.x, 1))
