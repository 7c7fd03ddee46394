"""Of whom it is asked where he may be instead: the sooner, the less his readings fit, and nobody never."""

from copy import deepcopy
from functools import cache

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion.images import Alternative, Image
from estimator.smoothing.images.candidates import FOUND, IN_TURN, MISPLACED, SETTLED, SETTLED_S, asked_of
from estimator.smoothing.images.flip_ambiguity import LIVE, WHOLE
from estimator.smoothing.images.image_estimates import Loose
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.images.test_companions import ONE, readings_of, through
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of

CREW = 8


@cache
def solved_crew() -> tuple[Problem, Solution]:
    ways = {f"ff{i}": through((0.0, 2.0 * i), (20.0, 2.0 * i)) for i in range(CREW)}
    return solved_of(readings_of(ways, ONE, dict.fromkeys(ways, 0)))


def crew() -> tuple[Problem, Solution, Loose]:
    """Eight people beside each other whom units that may face anything have led; no image is told."""
    problem, solved = deepcopy(solved_crew())
    for i, walk in enumerate(problem.layout.walks):
        problem.layout.walks[i] = walk._replace(node=replace(walk.node, otherwise=()))
    return problem, solved, {i: np.zeros(problem.layout.length, dtype=np.bool_) for i in range(CREW)}


def test_in_the_smoothed_view_all_are_asked() -> None:
    problem, solved, loose = crew()
    assert asked_of(problem, solved, loose, [], WHOLE) == list(range(CREW))


def test_live_some_are_asked_each_time_and_all_of_them_in_turn() -> None:
    problem, solved, loose = crew()
    asked = list[int]()
    for second in range(CREW // IN_TURN):
        problem.layout.grid[-1] = 20.0 + second
        each = asked_of(problem, solved, loose, [], LIVE)
        assert len(each) == IN_TURN + MISPLACED
        asked += each
    assert set(asked) == set(range(CREW))


def test_who_is_shown_where_he_is_not_is_asked_first() -> None:
    problem, solved, loose = crew()
    for misplaced in range(CREW):
        x = solved.x.copy()
        problem.layout.states(x, misplaced)[:, :2] += 6.0
        there = problem.solve(x, iterations=0)
        assert misplaced in asked_of(problem, there, loose, [], LIVE)


@pytest.mark.parametrize("period_s", [1, 3, 8, 32])
def test_in_whatever_rhythm_windows_are_solved_nobody_is_left_out(period_s: int) -> None:
    problem, solved, loose = crew()
    found, asked = list(range(CREW)), set[int]()
    for count in range(CREW):
        problem.layout.grid[-1] = 20.0 + period_s * count
        asked.update(asked_of(problem, solved, loose, found, LIVE))
    assert asked == set(found)


def test_in_one_window_the_same_are_asked_each_time() -> None:
    problem, solved, loose = crew()
    assert asked_of(problem, solved, loose, [], LIVE) == asked_of(problem, solved, loose, [], LIVE)


def test_of_those_who_were_found_one_is_asked_again_each_time_and_all_of_them_in_turn() -> None:
    problem, solved, loose = crew()
    found, asked = list(range(CREW)), set[int]()
    for second in range(CREW):
        problem.layout.grid[-1] = 20.0 + second
        each = asked_of(problem, solved, loose, found, LIVE)
        assert len(each) == FOUND
        asked.update(each)
    assert asked == set(found)


def test_whose_image_is_told_is_always_asked() -> None:
    problem, solved, loose = crew()
    walk = problem.layout.walks[3]
    image = Alternative(of=walk.number, share=0.4, image=Image(), since_t=0.0, way=Image())
    problem.layout.walks[3] = walk._replace(node=replace(walk.node, otherwise=(image,)))
    for second in range(CREW):
        problem.layout.grid[-1] = 20.0 + second
        assert 3 in asked_of(problem, solved, loose, [], LIVE)


def test_whom_ranges_alone_have_led_is_always_asked() -> None:
    problem, solved, loose = crew()
    free = {**loose, 3: ~loose[3]}
    for second in range(CREW):
        problem.layout.grid[-1] = 20.0 + second
        assert 3 in asked_of(problem, solved, free, [], LIVE)


def test_who_was_silent_long_ago_and_has_no_image_is_asked_in_his_turn() -> None:
    """A gap of the whole crew's would else be looked at in each window until it has left it."""
    problem, solved, loose = crew()
    silent = {i: np.arange(problem.layout.length) == 1 for i in loose}
    problem.layout.walks[:] = [w._replace(node=replace(w.node, turned=False)) for w in problem.layout.walks]
    ended_t, asked = float(problem.layout.grid[2]), set[int]()
    assert asked_of(problem, solved, silent, [], LIVE) == list(range(CREW))
    for count in range(CREW):
        problem.layout.grid[-1] = ended_t + SETTLED_S + 8.0 * (count + 1)
        each = asked_of(problem, solved, silent, [], LIVE)
        assert len(each) == SETTLED
        asked.update(each)
    assert asked == set(range(CREW))
    assert asked_of(problem, solved, silent, [], WHOLE) == list(range(CREW))
