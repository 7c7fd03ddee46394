"""Which displacements lead their bearers: not all that units tell is how these move."""

from collections.abc import Sequence

from estimator.fusion.entering.carried_bearer import first_step
from estimator.fusion.entering.separated_unit import go_beside
from estimator.fusion.memory.state import FusionState
from estimator.inertial.displacement import InertialDisplacement
from estimator.measurements.displacement import Displacement


def leading(state: FusionState, readings: Sequence[Displacement]) -> list[Displacement]:
    """The displacements that move somebody.

    Not those of units that are apart, which go on by themselves (decision 0055), nor those of units that
    stand while their bearers are carried (decision 0126).

    Args:
        state: the fusion.
        readings: in order of epoch.
    """
    found: list[Displacement] = []
    for reading in readings:
        node, told = state.nodes.get(reading.node), None
        if node is None or node.mode != "unit":
            told = reading
        elif node.apart is not None:
            go_beside(state, node, node.apart, reading)
        elif node.carried_t is not None:
            told = first_step(state, node, node.carried_t, reading)
        else:
            told = reading
        if told is not None:
            found.append(told)
        elif not isinstance(reading, InertialDisplacement):
            state.count("not_fused")
    return found
