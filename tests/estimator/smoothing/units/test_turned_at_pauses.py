"""Whose unit faces elsewhere after a pause: asked of a whole incident."""

import math

import numpy as np
import pytest

from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.rssi import Rssi
from estimator.smoothing.keyframes.pauses import PAUSE_S
from estimator.smoothing.keyframes.walks import HEADING
from estimator.smoothing.problem.newton import METRES_OFF, RESTING, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.turned_at_pauses import pauses, turned_at_pauses
from tests.estimator.smoothing.windows import entered, fused, problem_of

OFF_S, ON_S, SECONDS, SIDE_M = 60, 68, 140, 16.0
ANCHORS_M = ((-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0), (0.0, -14.0), (14.0, 0.0))


def walked(turned_rad: float, off_s: int = ON_S - OFF_S) -> tuple[Problem, Solution]:
    """He goes round a square among six radios; his unit is off for a while, and turned then."""
    chance, at, faces = np.random.default_rng(3), np.zeros(2), 0.0
    readings: list[AnyReading] = [entered()]
    for k, place in enumerate(ANCHORS_M):
        readings.append(Node(t=0.0, node=f"a{k}", role="anchor", position_m=(*place, 0.0), sigma_m=0.1))
    for second in range(1, SECONDS + 1):
        if second % 15 == 0:
            faces += 0.5 * math.pi
        step = np.array([math.cos(faces), math.sin(faces)])
        at = at + step
        by = turned_rad if second > OFF_S else 0.0
        east, north = (
            math.cos(by) * step[0] + math.sin(by) * step[1],
            math.cos(by) * step[1] - math.sin(by) * step[0],
        )
        if not OFF_S < second <= OFF_S + off_s:
            told = (float(east + chance.normal(0.0, 0.03)), float(north + chance.normal(0.0, 0.03)), 0.0)
            readings.append(Displacement(t=float(second), from_t=second - 1.0, node="ff1", delta_m=told))
        for k, place in enumerate(ANCHORS_M):
            dbm = -42.0 - 25.0 * math.log10(max(math.dist(at, place), 0.5)) + float(chance.normal(0.0, 4.0))
            readings.append(Rssi(t=float(second), a="ff1", b=f"a{k}", dbm=dbm))
    problem = problem_of(fused(readings))
    return problem, problem.solve(problem.layout.start(), METRES_OFF)


def test_a_pause_is_when_a_unit_told_nothing_and_then_again() -> None:
    (pause,) = pauses(walked(0.0)[0].layout, 0)
    assert (pause.since_t, pause.until_t) == pytest.approx((OFF_S, ON_S), abs=1.5)


def test_a_lost_report_is_no_pause() -> None:
    assert pauses(walked(0.0, int(PAUSE_S) - 1)[0].layout, 0) == []


def test_a_unit_that_faces_what_it_faced_has_not_turned() -> None:
    problem, solved = walked(0.0)
    assert turned_at_pauses(problem, solved, problem_of, RESTING) == (problem, solved)


def test_a_unit_that_has_turned_in_a_pause_is_found() -> None:
    problem, solved = walked(1.0)
    state = problem.layout.state
    steps = state.ledger.table("steps")
    # The first pass may have found it already.
    state.ledger.replace("steps", steps[steps[:, 8] < 1.0])
    problem = problem_of(state)
    solved = problem.solve(problem.layout.start(), METRES_OFF)
    found, there = turned_at_pauses(problem, solved, problem_of, RESTING)
    assert found is not problem
    headings = found.layout.states(there.x, 0)[:, HEADING]
    times = found.layout.times[:, 0]
    before, after = (float(headings[np.searchsorted(times, t)]) for t in (OFF_S - 5.0, ON_S + 5.0))
    assert after - before == pytest.approx(1.0, abs=0.3)
    assert pauses(found.layout, 0) == []
