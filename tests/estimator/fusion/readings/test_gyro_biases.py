"""Gyro biases that units tell, as readings that are kept."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.ledger import GYRO_BIAS, Ledger
from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.gyro_biases import is_in_question
from estimator.fusion.tick import fold_tick
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node

LEG_S = 25


def after_legs(
    rates_radps: list[float],
    responders: tuple[str, ...] = ("ff1",),
    *,
    corner: bool = True,
    heading_sigma_rad: float = 0.1,
) -> FusionState:
    """Everybody walks the same legs, a corner after each, that turn at these rates in his unit's frame."""
    state = FusionState()
    state.ledger = Ledger(complete=True)
    begins = [
        Node(
            t=0.0,
            node=n,
            role="responder",
            position_m=(0.0, 0.0, 0.0),
            heading_sigma_rad=heading_sigma_rad,
        )
        for n in responders
    ]
    fold_tick(state, 0.5, begins)
    facings = [
        math.radians(90.0) * number + rate * second
        for number, rate in enumerate(rates_radps)
        for second in range(LEG_S)
    ]
    for second, facing in enumerate([*facings, *([facings[-1] + math.radians(90.0)] if corner else [])]):
        moved = (math.cos(facing), math.sin(facing), 0.0)
        t = second + 1.0
        fold_tick(state, t, [Displacement(t=t, from_t=t - 1.0, node=n, delta_m=moved) for n in responders])
    return state


@pytest.mark.parametrize("corner", [False, True])
def test_a_straight_leg_moves_the_bias_of_its_unit_towards_what_it_shows(corner: bool) -> None:
    """While he is on it as well as afterwards: all that it has told is kept as one reading."""
    state = after_legs([-0.004], corner=corner)
    ((_, node, axis, value, sigma, noise, _),) = state.ledger.table("singles")
    assert (node, axis) == (state.nodes["ff1"].index, GYRO_BIAS)
    assert physics.NOISES[int(noise)] is physics.STRAIGHT_NOISE
    assert value == pytest.approx(0.004, rel=1e-6)
    assert sigma > physics.STRAIGHT_SHARED_RADPS
    assert 0.001 < float(state.graph.value(state.nodes["ff1"].unit)[1]) < 0.004


def test_what_earlier_legs_told_is_weighed_anew_once_another_one_differs() -> None:
    once, twice = after_legs([-0.004], ("ff1", "ff2")), after_legs([-0.004, 0.006], ("ff1", "ff2"))
    legs = twice.nodes["ff1"].straight
    assert legs.bent > 1.0
    rows, before = twice.ledger.table("singles"), once.ledger.table("singles")
    for name in ("ff1", "ff2"):
        index = twice.nodes[name].index
        first, second = rows[rows[:, 1] == index]
        alone = math.sqrt(before[before[:, 1] == index][0][4] ** 2 - physics.STRAIGHT_SHARED_RADPS**2)
        assert first[4] == pytest.approx(legs.sigma_radps(alone))
        assert second[4] > physics.STRAIGHT_SHARED_RADPS * math.sqrt(2.0)
        assert first[3] == pytest.approx(0.004, rel=1e-6), "what was read stays what was read"


def test_where_it_is_open_what_a_unit_faces_a_leg_is_kept_and_moves_nothing_yet() -> None:
    """The next solution of the window takes it, with all angles that are tried."""
    state = after_legs([-0.004], heading_sigma_rad=math.pi)
    assert state.nodes["ff1"].turned
    assert len(state.ledger.table("singles")) > 0
    assert float(state.graph.value(state.nodes["ff1"].unit)[1]) == pytest.approx(0.0, abs=1e-9)


def test_a_frame_that_stands_far_off_what_was_told_is_in_question_until_a_gyro_may_have_turned_it() -> None:
    state = after_legs([0.0])
    node = state.nodes["ff1"]
    assert not is_in_question(state, node)
    row = state.graph.rows(node.unit).start
    state.graph = state.graph.moved(row, math.radians(60.0))
    assert is_in_question(state, node)
    assert not is_in_question(state, replace(node, pose_t=600.0))


def test_legs_that_are_bent_by_nothing_leave_other_singles_alone() -> None:
    state = after_legs([0.0])
    fix = (30.0, float(state.nodes["ff1"].index), 5.0, 1.0, 0.5, 0.0, -1.0)
    state.ledger.add("singles", *fix)
    for second in range(LEG_S + 2):
        t = LEG_S + 2.0 + second
        fold_tick(state, t, [Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(0.0, 1.0, 0.0))])
    singles = state.ledger.table("singles")
    assert len(singles) >= 2
    assert np.array_equal(singles[singles[:, 2] == 5.0][0], fix)
