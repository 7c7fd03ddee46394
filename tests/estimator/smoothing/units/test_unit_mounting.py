"""When it is asked how units are worn: seldom where nothing speaks, sooner where something does."""

from msgspec.structs import replace

from estimator.fusion.entering.unit_mounting import RIGHT
from estimator.fusion.learned.rival import DOUBTED, Rival
from estimator.measurements import AnyReading
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.units.unit_mounting import (
    BENT,
    HINTED,
    MOST,
    SOME,
    YOUNG_S,
    asked_of,
    bent_headings,
)
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.trackers.test_unit_mounting import entry

TOLD_RAD = 0.05
"""How surely it is told in these walks what units face."""


def until(seconds: float, odds: float | None = None) -> Problem:
    """A window of three who are well ranged so far; so much speaks against the unit of one (log odds)."""
    readings: list[AnyReading] = [r for r in entry(RIGHT, 0)[0] if r.t <= seconds]
    problem, _ = solved_of(readings)
    state = problem.layout.state
    for i, walk in enumerate(problem.layout.walks):
        speaks = odds if walk.node.node == "ff2" else None
        rival = None if speaks is None else Rival(b"", b"", speaks)
        state.keep(replace(state.life(walk.number), rival=rival))
        problem.layout.walks[i] = walk._replace(node=state.life(walk.number))
    return problem


def test_a_young_window_is_asked_when_it_is_half_as_long_again() -> None:
    problem = until(40.0)
    assert len(asked_of(problem, 20.0, {})) == SOME
    assert asked_of(problem, 39.0, {}) == []


def test_an_older_one_is_asked_only_where_something_hints_at_a_bad_unit() -> None:
    assert asked_of(until(YOUNG_S + 20.0), 30.0, {}) == []
    assert len(asked_of(until(YOUNG_S + 20.0, HINTED + 0.1), 30.0, {})) == SOME


def test_where_anything_speaks_against_a_unit_it_is_asked_sooner_and_of_that_one_first() -> None:
    problem = until(80.0, DOUBTED + 0.1)
    asked = asked_of(problem, 70.0, {})
    assert 0 < len(asked) <= MOST
    assert problem.layout.walks[asked[0]].node.node == "ff2"
    assert asked_of(until(80.0, HINTED + 0.1), 70.0, {}) == []


def test_the_last_solution_of_the_whole_incident_is_asked_only_where_something_speaks() -> None:
    assert asked_of(until(40.0), None, {}) == []
    assert asked_of(until(40.0, DOUBTED + 0.1), None, {}) != []


def test_a_heading_that_a_solution_has_far_from_what_was_told_is_asked_about_first() -> None:
    problem = until(80.0)
    numbers = [walk.number for walk in problem.layout.walks]
    asked = asked_of(problem, 70.0, {numbers[2]: BENT + 1.0, numbers[1]: BENT + 0.5})
    assert [problem.layout.walks[i].number for i in asked[:2]] == [numbers[2], numbers[1]]


def test_it_is_asked_at_once_when_a_solution_first_bends_a_heading_and_then_by_the_clock() -> None:
    problem = until(80.0)
    state, number = problem.layout.state, problem.layout.walks[2].number
    bent = {number: BENT + 1.0}
    assert problem.layout.walks[asked_of(problem, 79.0, bent)[0]].number == number
    state.keep(replace(state.life(number), bent=True))
    assert asked_of(problem, 79.0, bent) == []


def test_headings_are_held_against_what_was_told_of_them_where_the_unit_began() -> None:
    problem = until(40.0)
    layout, x = problem.layout, problem.layout.start()
    assert bent_headings(layout, x) == {}
    layout.states(x, 1)[:, 3] += 4.0 * TOLD_RAD
    assert list(bent_headings(layout, x)) == [layout.walks[1].number]
    assert 3.0 < bent_headings(layout, x)[layout.walks[1].number] < 5.0
