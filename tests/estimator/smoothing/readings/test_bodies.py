"""What bearers' bodies do to the readings of a window."""

import math

import numpy as np
import pytest

from estimator.graph.dense import Array
from estimator.graph.variable import BODY
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node, Role
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.smoothing.problem.newton import Problem
from tests.estimator.smoothing.windows import entered, fused, problem_of

WEST_M, NORTH_M, DOES = -60.0, 60.0, 0.5
GOES_S, STANDS_S = 20, 10


def walked(*, turned_rad: float = 0.0, role: Role = "anchor", units: bool = True) -> list[AnyReading]:
    """He goes east for twenty seconds, away from one radio and past another one, and stands.

    Args:
        turned_rad: what his unit faces, against what it says.
        role: of the radio in the west.
        units: he has a unit.
    """
    readings: list[AnyReading] = [
        Node(t=0.0, node="west", role=role, position_m=(WEST_M, 0.0, 0.0), sigma_m=0.05),
        Node(t=0.0, node="north", role="anchor", position_m=(10.0, NORTH_M, 0.0), sigma_m=0.05),
        entered()
        if turned_rad == 0.0
        else Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0)),
    ]
    for second in range(1, GOES_S + STANDS_S + 1):
        t, east_m = float(second), float(min(second, GOES_S))
        step_m = 1.0 if second <= GOES_S else 0.0
        told = step_m * math.cos(turned_rad), -step_m * math.sin(turned_rad), 0.0
        if units:
            readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=told))
        for name, off_m in (("west", east_m - WEST_M), ("north", math.hypot(east_m - 10.0, NORTH_M))):
            readings.append(Range(t=t, a="ff1", b=name, range_m=off_m, technology="uwb"))
            readings.append(Rssi(t=t, a=name, b="ff1", dbm=-45.0 - 22.0 * math.log10(off_m)))
    return readings


def does(problem: Problem) -> dict[tuple[str, float], Array]:
    """What bodies do to each radio's readings of him, second by second, by its name and their kind."""
    state, rows = problem.layout.state, problem.rows
    x = problem.layout.start()
    size = problem.layout.length * problem.layout.width
    for start in problem.layout.technologies.values():
        x[size + start + BODY] = DOES
    found = rows.bodies(x)
    names = [
        next(n for n in (state.owners[int(a)], state.owners[int(b)]) if n != "ff1")
        for a, b in rows.pairs[:, 2:4]
    ]
    told: dict[tuple[str, float], list[float]] = {}
    for name, kind, one in zip(names, rows.pairs[:, 1].tolist(), found.tolist(), strict=True):
        told.setdefault((name, kind), []).append(one)
    return {key: np.array(each) for key, each in told.items()}


RANGE, POWER = 0.0, 1.0


def test_a_range_to_what_lies_behind_him_is_longer_and_a_power_from_it_lower() -> None:
    found = does(problem_of(fused(walked())))
    assert found["west", RANGE] == pytest.approx(DOES, rel=0.01)
    assert found["west", POWER] == pytest.approx(-DOES, rel=0.01)


def test_what_he_passes_is_ahead_and_then_behind_and_stays_so_while_he_stands() -> None:
    found = does(problem_of(fused(walked())))["north", RANGE]
    assert found[:9].max() < 0.0 < found[11:].min()
    assert found[GOES_S - 1 :] == pytest.approx(DOES * 10.0 / math.hypot(10.0, NORTH_M), rel=0.05)


def test_the_window_predicts_each_reading_with_what_bodies_do() -> None:
    problem = problem_of(fused(walked()))
    x, size = problem.layout.start(), problem.layout.length * problem.layout.width
    bodies = [size + start + BODY for start in problem.layout.technologies.values()]
    x[bodies] = 0.0
    before = problem.rows.residual(x)
    x[bodies] = DOES
    after = problem.rows.residual(x)
    pairs = len(problem.rows.pairs)
    assert before[:pairs] - after[:pairs] == pytest.approx(problem.rows.bodies(x), abs=1e-9)


def test_where_he_faces_is_turned_as_his_units_frame_is() -> None:
    """His unit says that he goes south: radios tell that he goes east."""
    found = does(problem_of(fused(walked(turned_rad=math.pi / 2.0))))
    assert found["west", RANGE][-1] == pytest.approx(DOES, rel=0.05)


def test_of_who_has_no_unit_nobody_knows_what_he_faces() -> None:
    found = does(problem_of(fused(walked(units=False))))
    assert {float(np.abs(each).max()) for each in found.values()} == {0.0}
