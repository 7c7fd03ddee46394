"""Images of the way of somebody who is followed by ranges alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.images.flip_ambiguity import LIVE, WHOLE, exposed, flips, loose_steps
from estimator.smoothing.images.heard_radios import heard_by
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from tests.estimator.smoothing.windows import fused, problem_of

TWO = {"a1": (0.0, 0.0), "a2": (20.0, 0.0)}
THREE_IN_A_LINE = TWO | {"a3": (8.0, 0.0)}
CORNERS = TWO | {"a3": (0.0, 30.0), "a4": (20.0, 30.0)}
CROSSED_S = 20


def crossing(radios: dict[str, tuple[float, float]], silent_s: range = range(41)) -> list[AnyReading]:
    """Somebody walks north across the line through the first two radios, silent at some seconds."""
    chance = np.random.default_rng(2)
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*at, 0.0)) for name, at in radios.items()
    ]
    entered = (12.0, -float(CROSSED_S), 0.0)
    readings.append(Node(t=0.0, node="ff1", role="responder", position_m=entered, sigma_m=0.2))
    for second in range(1, 41):
        at = np.array([12.0, float(second - CROSSED_S)])
        if second not in silent_s:
            e, n = (np.array([0.0, 1.0]) + chance.normal(0.0, 0.03, 2)).tolist()
            readings.append(
                Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(e, n, 0.0))
            )
        for name, place in radios.items():
            range_m = float(np.hypot(*(at - place)) + chance.normal(0.0, 0.1))
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
    return readings


def solved_of(readings: list[AnyReading]) -> tuple[Problem, Solution]:
    """Their window, solved."""
    problem = problem_of(fused(readings))
    return problem, problem.solve(problem.layout.start())


def places(problem: Problem, solved: Solution) -> Array:
    """Where the walker was at each keyframe, k × 2 (m)."""
    layout = problem.layout
    return solved.x[: layout.length * layout.width].reshape(layout.length, -1)[:, :2]


@pytest.mark.parametrize("radios", [TWO, THREE_IN_A_LINE])
def test_who_crosses_the_line_of_his_radios_may_have_turned_back(
    radios: dict[str, tuple[float, float]],
) -> None:
    problem, solved = solved_of(crossing(radios))
    walk, way_m = problem.layout.walks[0], places(problem, solved)
    heard = heard_by(problem, solved, walk)
    found = flips(heard, way_m, walk, loose_steps(problem, solved, 0), 40.0, LIVE)
    south = [flip for flip in found if np.hypot(*(flip.image.of(np.array([5.0, 7.0])) - [5.0, -7.0])) < 0.2]
    assert any(abs(problem.layout.grid[flip.since] - CROSSED_S) <= 1.0 for flip in south)
    assert exposed(heard, 40.0)


def test_who_was_between_other_radios_before_and_after_may_have_been_beyond_the_line_meanwhile() -> None:
    """He crosses the line through two, and comes back; before and after he hears three others more often."""
    chance = np.random.default_rng(2)
    others = {"b1": (0.0, -30.0), "b2": (20.0, -30.0), "b3": (12.0, -45.0)}
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*at, 0.0)) for name, at in (TWO | others).items()
    ]
    readings.append(Node(t=0.0, node="ff1", role="responder", position_m=(12.0, -20.0, 0.0), sigma_m=0.2))
    for second in range(1, 81):
        at = np.array([12.0, 20.0 - abs(second - 40.0)])
        within = 20 <= second <= 60
        for name, place in (TWO if within else others).items() if second % 4 == 0 or not within else ():
            range_m = float(np.hypot(*(at - place)) + chance.normal(0.0, 0.1))
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
    problem, solved = solved_of(readings)
    heard = heard_by(problem, solved, problem.layout.walks[0])
    way_m, loose = places(problem, solved), loose_steps(problem, solved, 0)
    found = flips(heard, way_m, problem.layout.walks[0], loose, 80.0, WHOLE)
    south = [flip for flip in found if np.hypot(*(flip.image.of(np.array([5.0, 7.0])) - [5.0, -7.0])) < 0.2]
    spans = [(problem.layout.grid[one.since], problem.layout.grid[one.until]) for one in south if one.until]
    assert any(
        since == pytest.approx(20.0, abs=2.0) and until == pytest.approx(60.0, abs=2.0)
        for since, until in spans
    )


def test_who_hears_radios_about_him_cannot_turn_back_unseen() -> None:
    problem, solved = solved_of(crossing(CORNERS))
    walk = problem.layout.walks[0]
    heard = heard_by(problem, solved, walk)
    found = flips(heard, places(problem, solved), walk, loose_steps(problem, solved, 0), 40.0, LIVE)
    assert all(problem.layout.grid[flip.since] > 35.0 for flip in found)
    assert not exposed(heard, 40.0)


@given(st.integers(10, 25))
def test_a_packet_that_was_lost_is_no_silence_in_which_somebody_turns_back(lost_s: int) -> None:
    problem, solved = solved_of(crossing(TWO, range(lost_s, lost_s + 1)))
    assert not loose_steps(problem, solved, 0).any()


@pytest.mark.parametrize("every", [2, 3])
def test_packets_lost_one_by_one_are_no_silence_either(every: int) -> None:
    problem, solved = solved_of(crossing(TWO, range(10, 30, every)))
    assert not loose_steps(problem, solved, 0).any()


def test_a_silent_unit_leaves_its_bearer_to_ranges() -> None:
    problem, solved = solved_of(crossing(TWO, range(15, 28)))
    grid = problem.layout.grid[:-1][loose_steps(problem, solved, 0)[:-1]]
    assert 14.0 <= grid[0] <= 17.0
    assert 24.0 <= grid[-1] <= 27.0


def silent(heard_again_s: int) -> list[AnyReading]:
    """Somebody walks east, is silent for 20 s, and is led on by his unit before he is ranged again."""
    readings: list[AnyReading] = [
        Node(t=0.0, node=name, role="anchor", position_m=(*at, 0.0)) for name, at in TWO.items()
    ]
    readings.append(Node(t=0.0, node="ff1", role="responder", position_m=(0.0, -12.0, 0.0), sigma_m=0.2))
    for second in [*range(1, 11), *range(31, 51)]:
        at = np.array([float(second), -12.0 if second <= 10 else -4.0])
        readings.append(
            Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=(1.0, 0.0, 0.0))
        )
        for name, place in TWO.items() if second <= 10 or second >= heard_again_s else ():
            range_m = float(np.hypot(*(at - place)))
            readings.append(Range(t=float(second), a="ff1", b=name, range_m=range_m, technology="uwb"))
    return readings


@pytest.mark.parametrize("heard_again_s", [31, 32, 36])
def test_who_is_heard_again_once_his_unit_leads_may_be_across_the_line_there(heard_again_s: int) -> None:
    problem, solved = solved_of(silent(heard_again_s))
    walk, way_m, loose = problem.layout.walks[0], places(problem, solved), loose_steps(problem, solved, 0)
    found = flips(heard_by(problem, solved, walk), way_m, walk, loose, 50.0, LIVE)
    met = int(np.searchsorted(problem.layout.grid, heard_again_s))
    led = int(np.flatnonzero(loose)[-1]) + 1
    # What the unit has led on goes along as it is: where it begins is as far from where he is heard again.
    across_m = way_m[met] * [1.0, -1.0] + way_m[led] - way_m[met]
    assert any(np.hypot(*(flip.image.of(way_m[led]) - across_m)) < 1.0 for flip in found)
