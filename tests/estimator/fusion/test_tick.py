"""In which order the readings of one tick are folded."""

from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire

BASE = Node(t=0.0, node="base", role="base")
ENTERS = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.5)
STEP = Displacement(t=1.0, from_t=0.0, node="ff1", delta_m=(1.0, 0.0, 0.0))


def test_what_is_heard_of_who_is_retired_in_the_same_tick_still_counts() -> None:
    heard = Range(t=0.8, a="ff1", b="base", range_m=0.8, technology="uwb")
    retired = Retire(t=1.0, node="ff1")
    fused = []
    both: tuple[list[AnyReading], ...] = ([BASE, ENTERS, STEP, retired], [BASE, ENTERS, heard, STEP, retired])
    for readings in both:
        state = FusionState()
        fold_tick(state, 1.0, readings)
        assert state.nodes["ff1"].mode == "retired"
        fused.append(state.counts["fused"])
    assert fused[1] == fused[0] + 1


def test_who_is_retired_and_introduced_again_in_one_tick_is_back() -> None:
    state = FusionState()
    fold_tick(state, 1.0, [BASE, ENTERS, STEP])
    called = Node(t=1.7, node="ff1", role="responder", position_m=(5.0, 0.0, 0.0), sigma_m=0.5)
    fold_tick(state, 2.0, [Retire(t=1.3, node="ff1"), called])
    fold_tick(state, 3.0, [Displacement(t=3.0, from_t=2.0, node="ff1", delta_m=(1.0, 0.0, 0.0))])
    assert state.nodes["ff1"].mode != "retired"
    assert abs(state.place(state.nodes["ff1"])[0] - 6.0) < 0.1


def test_what_was_noticed_in_a_tick_is_not_told_again_in_the_next() -> None:
    state = FusionState()
    fold_tick(
        state, 1.0, [BASE, ENTERS, Displacement(t=1.0, from_t=0.0, node="ff1", delta_m=(50.0, 0.0, 0.0))]
    )
    assert [notice.node for notice in state.notices] == ["ff1"]
    fold_tick(state, 2.0, [])
    assert state.notices == []
