"""What the fusion keeps of an incident."""

from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements.node import Node
from estimator.measurements.retire import Retire


def test_the_base_is_where_one_is_at_work_or_else_where_one_was() -> None:
    state = FusionState()
    assert state.base_place() == (0.0, 0.0, 0.0)
    first = Node(t=0.0, node="gw1", role="base", position_m=(5.0, 1.0, 0.0))
    fold_tick(state, 1.0, [first, Node(t=0.5, node="gw2", role="base", position_m=(60.0, 0.0, 0.0))])
    assert state.base_place() == (5.0, 1.0, 0.0)
    fold_tick(state, 2.0, [Retire(t=1.5, node="gw1")])
    assert state.base_place() == (60.0, 0.0, 0.0)
    fold_tick(state, 3.0, [Retire(t=2.5, node="gw2")])
    assert state.base_place() == (5.0, 1.0, 0.0)
