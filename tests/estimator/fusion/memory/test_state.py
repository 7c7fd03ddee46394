"""What the fusion keeps of an incident."""

from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.measurements.position import Position
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


def test_landmarks_are_those_whose_places_are_told_from_outside() -> None:
    """A responder is told where he stands at the door only, and a breadcrumb lies where he has been."""
    state, here_m = FusionState(), (4.0, 2.0, 0.0)
    fold_tick(
        state,
        1.0,
        [
            Node(t=0.0, node="base", role="base"),
            Node(t=0.0, node="engine", role="anchor", position_m=(20.0, -9.0, 2.0), sigma_m=0.2),
            Node(t=0.0, node="ff", role="responder", position_m=here_m, sigma_m=0.5),
            Node(t=0.0, node="uav", role="uav"),
            Drop(t=0.5, node="b", by="ff"),
        ],
    )
    assert state.landmarks() == {"engine"}
    fold_tick(state, 2.0, [Position(t=1.5, node="uav", position_m=(9.0, 9.0, 12.0))])
    assert state.landmarks() == {"engine", "uav"}
