"""A chain of states, tick after tick: who has just been found is looked at with a window at once."""

import pytest

from estimator.fusion.memory.encode import record_of
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.trackers.chain import Chain, found_m
from tests.estimator.trackers.entry import BASE, step

UNSURE_M, OFF_M = 8.0, 6.0


def walks(sigma_m: float) -> FusionState:
    """He has walked a metre since he entered at a place known so well."""
    state = FusionState()
    enters = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=sigma_m)
    fold_tick(state, 1.0, [BASE, enters, step(1.0, (1.0, 0.0, 0.0))])
    return state


def fix(east_m: float, sigma_m: float = 1.0) -> Position:
    return Position(t=2.0, node="ff1", position_m=(east_m, 0.0, 0.0), sigma_m=(sigma_m, sigma_m, sigma_m))


def test_readings_find_whom_nobody_knew_where_he_was() -> None:
    before = walks(UNSURE_M)
    after = before.copy()
    fold_tick(after, 2.0, [step(2.0, (1.0, 0.0, 0.0)), fix(2.0 + OFF_M)])
    assert found_m(before, after) == pytest.approx(OFF_M, rel=0.1)


def test_who_was_known_is_not_found_and_no_step_finds_anybody() -> None:
    for sigma_m, readings in ((0.5, [fix(2.0 + OFF_M, 0.3)]), (UNSURE_M, [])):
        before = walks(sigma_m)
        after = before.copy()
        fold_tick(after, 2.0, [step(2.0, (5.0, 0.0, 0.0)), *readings])
        assert found_m(before, after) == 0.0


def test_the_window_is_solved_in_the_tick_that_finds_him() -> None:
    readings: dict[int, list[AnyReading]] = {2: [step(2.0, (1.0, 0.0, 0.0)), fix(2.0 + OFF_M)]}
    state = walks(UNSURE_M)
    state.begun_t = state.refreshed_t = 1.0
    chain = Chain([(1, state)])
    chain.extend([2], readings, {})
    assert chain.state.refreshed_t > 1.0


def test_what_was_folded_before_its_turn_is_not_folded_again_unless_something_comes_for_it() -> None:
    readings = {k: [step(float(k), (1.0, 0.0, 0.0))] for k in range(2, 8)}
    ahead, in_turn = (Chain([(1, walks(0.5))]) for _ in range(2))
    for tick in (2, 3, 4, 5, 6):
        ahead.fold_ahead(tick, readings[tick])
    assert ahead.folded == 1
    states = {tick: state for tick, state, _ in ahead.ahead}
    ahead.extend([2, 3], readings, {})
    assert ahead.state is states[3]
    for chain in (ahead, in_turn):
        chain.roll_back(5)
        readings[5] = [step(5.0, (0.0, 1.0, 0.0))]
        chain.extend(range(chain.folded + 1, 8), readings, {})
    assert ahead.checkpoints[-4][1] is states[4]
    assert record_of(ahead.state) == record_of(in_turn.state)
