"""A node that begins anew where readings put it, and what takes that back."""

import numpy as np
import pytest

from estimator.fusion.entering.introduce import NO_PRIOR_SIGMA_M, place
from estimator.fusion.entering.leaving import retire
from estimator.fusion.memory.ledger import ECHO
from estimator.fusion.memory.state import FusionState
from estimator.fusion.report import estimate_of
from estimator.fusion.tick import fold_tick
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.smoothing.changes.branch import branch, reunite
from estimator.smoothing.changes.relocation import MovedNode
from tests.estimator.smoothing.windows import fused

TURNED_S = 30.0
WIDE_M = (NO_PRIOR_SIGMA_M, NO_PRIOR_SIGMA_M, 1.0)


def walked(*more: AnyReading) -> FusionState:
    """Someone walks east and back, and measures how far a breadcrumb is that he dropped on his way."""
    readings: list[AnyReading] = [Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0))]
    for second in range(1, 61):
        east = 1.0 if second <= TURNED_S else -1.0
        t = float(second)
        readings.append(Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(east, 0.0, 0.0)))
        at = min(second, 60 - second)
        if second > 10:
            readings.append(Range(t=t, a="ff1", b="b1", range_m=abs(at - 10.0), technology="uwb"))
    return fused([*readings, Drop(t=10.0, node="b1", by="ff1"), *more])


def numbers_of(state: FusionState) -> set[int]:
    """The numbers of the breadcrumb under which readings stand."""
    mine = {number for number, owner in enumerate(state.owners) if owner == "b1"}
    ends = np.unique(state.ledger.table("pairs")[:, 2:4]).astype(int).tolist()
    return mine & set(ends)


@pytest.mark.parametrize("found", [False, True], ids=["still sought", "found"])
def test_where_readings_put_it_last_is_taken_back(found: bool) -> None:
    state = walked()
    before, pairs = state.nodes["b1"], state.ledger.table("pairs").copy()
    stands = state.ledger.table("stands").copy()
    branch(state, MovedNode("b1", TURNED_S, 25))
    if found:
        place(state, state.nodes["b1"], 60.0, (15.0, 3.0, 0.0), WIDE_M)
    assert len(numbers_of(state)) == 2
    assert reunite(state)
    assert (state.ledger.table("pairs") == pairs).all()
    assert (state.ledger.table("stands") == stands).all()
    after = state.nodes["b1"]
    assert (after.index, after.mode) == (before.index, "static")
    assert after.position in state.graph
    assert "b1" not in state.sightings


def test_of_two_places_only_the_last_is_taken_back() -> None:
    """Nobody would ask again about the first."""
    state = walked()
    branch(state, MovedNode("b1", TURNED_S, 25))
    second = state.nodes["b1"].index
    place(state, state.nodes["b1"], 45.0, (12.0, 3.0, 0.0), WIDE_M)
    branch(state, MovedNode("b1", 45.0, 15))
    assert reunite(state)
    assert state.nodes["b1"].index == second
    assert len(numbers_of(state)) == 2


def test_what_was_dropped_or_placed_anew_lies_there() -> None:
    for again in (
        Drop(t=40.0, node="b1", by="ff1"),
        Node(t=40.0, node="b1", role="breadcrumb", position_m=(20.0, 1.0, 0.0), sigma_m=0.1),
    ):
        state = walked()
        branch(state, MovedNode("b1", TURNED_S, 25))
        fold_tick(state, 62.0, [again])
        numbers, index = numbers_of(state), state.nodes["b1"].index
        assert not reunite(state)
        assert (numbers_of(state), state.nodes["b1"].index) == (numbers, index)


def test_who_has_been_retired_or_moves_by_itself_since_is_asked_no_more() -> None:
    state = walked()
    branch(state, MovedNode("b1", TURNED_S, 25))
    numbers = numbers_of(state)
    retire(state, Retire(t=61.0, node="b1"), estimate_of(state, "b1"))
    assert not reunite(state)
    assert numbers_of(state) == numbers
    state = walked()
    branch(state, MovedNode("b1", TURNED_S, 25))
    fold_tick(state, 62.0, [Node(t=61.0, node="b1", role="responder", position_m=(9.0, 0.0, 0.0))])
    assert not reunite(state)


def test_where_nothing_was_kicked_nothing_is_taken_back() -> None:
    assert not reunite(walked())


def test_what_jumped_when_it_was_moved_was_no_echo() -> None:
    state = walked()
    pairs = state.ledger.table("pairs").copy()
    pairs[:, ECHO] = 3.0
    state.ledger.replace("pairs", pairs)
    branch(state, MovedNode("b1", TURNED_S, 25))
    pairs = state.ledger.table("pairs")
    since = pairs[:, 0] >= TURNED_S
    assert (pairs[since, ECHO] == 0.0).all()
    assert (pairs[~since, ECHO] == 3.0).all()
