"""Gyro biases that units tell, as readings that are kept."""

import math

import numpy as np
import pytest

from estimator.fusion import physics
from estimator.fusion.memory.ledger import GYRO_BIAS, Ledger
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node

LEG_S = 25


def after_legs(rates_radps: list[float], responders: tuple[str, ...] = ("ff1",)) -> FusionState:
    """Everybody walks the same legs, a corner after each, that turn at these rates in his unit's frame."""
    state = FusionState()
    state.ledger = Ledger(complete=True)
    begins = [Node(t=0.0, node=n, role="responder", position_m=(0.0, 0.0, 0.0)) for n in responders]
    fold_tick(state, 0.5, begins)
    facings = [
        math.radians(90.0) * corner + rate * second
        for corner, rate in enumerate(rates_radps)
        for second in range(LEG_S)
    ]
    for second, facing in enumerate([*facings, facings[-1] + math.radians(90.0)]):
        moved = (math.cos(facing), math.sin(facing), 0.0)
        t = second + 1.0
        fold_tick(state, t, [Displacement(t=t, from_t=t - 1.0, node=n, delta_m=moved) for n in responders])
    return state


def test_a_straight_leg_moves_the_bias_of_its_unit_towards_what_it_shows() -> None:
    state = after_legs([-0.004])
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
