"""Solutions of a window that are compared with the same floors between radios."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from msgspec import structs

from estimator.smoothing.images import likeliest_image as judging
from estimator.smoothing.images.image_starts import ImageSolution, Subject
from estimator.smoothing.images.likeliest_image import likeliest_image
from estimator.smoothing.images.same_floors import hold_floors
from estimator.smoothing.images.solutions import solutions
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.images.test_candidates import crew
from tests.estimator.smoothing.images.test_flip_ambiguity import TWO, crossing, silent, solved_of


def test_heights_that_nobody_measures_do_not_tell_which_of_two_solutions_is_likelier() -> None:
    problem, solved = solved_of(crossing(TWO))
    higher = solved.x.copy()
    problem.layout.states(higher, 0)[:, 2] += 3.0
    hold_floors(problem, solved)
    problem.rows.widen(solved.x, problem.rows.jacobian(solved.x))
    known = problem.rows.sigma.copy()
    problem.rows.widen(higher, problem.rows.jacobian(higher))
    assert np.array_equal(problem.rows.sigma, known)


def test_what_is_known_of_floors_stays_where_it_is_likelier() -> None:
    problem, solved = solved_of(crossing(TWO))
    hold_floors(problem, solved)
    assert problem.rows.floors is not None
    held, higher = problem.rows.floors.copy(), solved.x.copy()
    problem.layout.states(higher, 0)[:, 2] += 3.0
    assert hold_floors(problem, replace(solved, x=higher)).cost <= solved.cost
    assert np.array_equal(problem.rows.floors, held)


def test_floors_are_told_by_heights_again_after_the_images() -> None:
    problem, solved = solved_of(crossing(TWO))
    assert likeliest_image(problem, solved).problem.rows.floors is None


def floors_held(monkeypatch: pytest.MonkeyPatch, problem: Problem, solved: Solution) -> list[bool]:
    """Whether floors were held, of each of whom it was asked where he is instead."""
    held = []

    def asked_with(asked: Subject, *rest: Any) -> list[ImageSolution]:
        held.append(asked.problem.rows.floors is not None)
        return solutions(asked, *rest)

    monkeypatch.setattr(judging, "solutions", asked_with)
    likeliest_image(problem, solved)
    return held


def test_images_of_whose_unit_was_silent_are_compared_by_the_same_floors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    held = floors_held(monkeypatch, *solved_of(silent(36)))
    assert held
    assert all(held)


def test_where_it_is_asked_again_what_a_unit_faces_images_are_compared_by_the_same_floors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem, solved, _ = crew()
    found = [walk._replace(node=structs.replace(walk.node, turned=False)) for walk in problem.layout.walks]
    problem.layout.walks[:] = found
    held = floors_held(monkeypatch, problem, solved)
    assert held
    assert all(held)
