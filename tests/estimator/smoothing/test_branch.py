"""A node that begins anew where readings put it, and what takes that back."""

import numpy as np
import pytest

from estimator.fusion.introduce import place, retire
from estimator.fusion.state import FusionState
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.smoothing.branch import branch, reunite
from estimator.smoothing.moved import Moved
from tests.estimator.smoothing.windows import fused

TURNED_S = 30.0


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


@pytest.mark.parametrize("kicked_s", [(30.0,), (30.0, 45.0)], ids=["once", "twice"])
@pytest.mark.parametrize("found", [False, True], ids=["still sought", "found"])
def test_what_was_found_to_lie_elsewhere_is_taken_back_whole(
    kicked_s: tuple[float, ...], found: bool
) -> None:
    state = walked()
    before, pairs = state.nodes["b1"], state.ledger.table("pairs").copy()
    stands = state.ledger.table("stands").copy()
    for t in kicked_s:
        if state.nodes["b1"].mode == "undecided":
            place(state, state.nodes["b1"], t, (12.0, 3.0, 0.0), (1e3, 1e3, 1.0))
        branch(state, Moved("b1", t, 15))
    if found:
        place(state, state.nodes["b1"], 60.0, (15.0, 3.0, 0.0), (1e3, 1e3, 1.0))
    assert state.nodes["b1"].index != before.index
    assert len(numbers_of(state)) == 1 + len(kicked_s)
    reunite(state)
    assert (state.ledger.table("pairs") == pairs).all()
    assert (state.ledger.table("stands") == stands).all()
    after = state.nodes["b1"]
    assert (after.index, after.mode) == (before.index, "static")
    assert after.position in state.graph
    assert "b1" not in state.sightings


def test_what_was_dropped_anew_lies_there() -> None:
    state = walked(Drop(t=40.0, node="b1", by="ff1"))
    numbers = numbers_of(state)
    assert len(numbers) == 2
    reunite(state)
    assert numbers_of(state) == numbers
    branch(state, Moved("b1", 50.0, 10))
    reunite(state)
    assert numbers_of(state) == numbers
    assert state.nodes["b1"].index == max(numbers)


def test_who_has_been_retired_since_stays_so() -> None:
    state = walked()
    first = state.nodes["b1"].index
    branch(state, Moved("b1", TURNED_S, 25))
    retire(state, state.nodes["b1"], 61.0)
    reunite(state)
    assert (state.nodes["b1"].mode, state.nodes["b1"].index) == ("retired", first)
    assert numbers_of(state) == {first}
