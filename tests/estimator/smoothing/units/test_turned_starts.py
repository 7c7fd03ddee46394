"""By how much a unit may be turned: its way is turned about where it begins, and fits where it led."""

import math

import numpy as np
import pytest

from estimator.fusion.entering.unit_mounting import RIGHT, Mounting
from estimator.graph.dense import Array
from estimator.smoothing.images.flip_ambiguity import Flip
from estimator.smoothing.images.heading_images import facing, turn
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.units.turned_starts import SAME_RAD, TRIED, as_turned, same_turn, turned_starts
from tests.estimator.smoothing.images.test_flip_ambiguity import solved_of
from tests.estimator.trackers.test_unit_mounting import entry


def followed() -> tuple[Problem, Array, int]:
    """Forty seconds of three, where they went, and which of them is ff1."""
    problem, solved = solved_of([r for r in entry(RIGHT, 1)[0] if r.t <= 40.0])
    return problem, solved.x, problem.layout.state.nodes["ff1"].index


@pytest.mark.parametrize("by_deg", [-150.0, -75.0, 45.0, 120.0])
def test_the_angle_that_fits_best_leads_a_turned_way_back(by_deg: float) -> None:
    problem, x, number = followed()
    layout, there = problem.layout, x.copy()
    turn(layout, there, 0, Flip(0, facing(layout.states(x, 0)[0, :2].copy(), math.radians(by_deg))))
    starts = turned_starts(problem, there, number)
    assert 0 < len(starts) <= TRIED
    off_m = np.hypot(*(layout.states(starts[0], 0)[:, :2] - layout.states(x, 0)[:, :2]).T)
    assert off_m.max() < 0.5


def test_a_solution_of_a_unit_that_may_face_anything_is_one_of_a_unit_turned_so() -> None:
    """Places stay where they are; what the unit faced at first is then as it was told."""
    problem, x, number = followed()
    layout = problem.layout
    as_told, _ = as_turned(problem, x, number)
    layout.states(x, 0)[:, 3] += 0.6
    way, there = as_turned(problem, x, number)
    again, same = as_turned(problem, there, number)
    assert math.isclose(way.turned_rad - as_told.turned_rad, 0.6, abs_tol=1e-9)
    assert math.isclose(again.turned_rad, 0.0, abs_tol=1e-9)
    assert np.allclose(same, there)
    assert np.allclose(layout.states(there, 0)[:, :3], layout.states(x, 0)[:, :3])


def test_turns_are_the_same_all_round() -> None:
    assert same_turn(Mounting(False, math.pi - 0.1), Mounting(False, 0.1 - math.pi))
    assert not same_turn(Mounting(False, 1.01 * SAME_RAD), Mounting())
    assert not same_turn(Mounting(True), Mounting())
