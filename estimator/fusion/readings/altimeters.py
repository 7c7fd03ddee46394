"""Altimeters: their first readings tell what they are off by; from then on that drifts, as a state."""

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.altimeter_zero import AltimeterZero
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.recent_places import offset_of
from estimator.fusion.readings.altimeter_jumps import jump
from estimator.fusion.readings.unseen_rises import doubt_height, new_altimeter
from estimator.graph.variable import Variable

NOTHING_M2 = 1e-9
"""Below it no walk is worth its work."""


def heard_altimeter(
    state: FusionState, node: NodeState, t: float, up_m: float, sigmas_m: tuple[float, float]
) -> NodeState:
    """The node after its altimeter has been heard, whose offset has walked on since its last reading.

    Args:
        state: the fusion, changed in place.
        node: who carries it, whose position is decided.
        t: epoch of the reading (s).
        up_m: what it reads (m).
        sigmas_m: its standard deviation as one of many that share their error, and by itself, which tells
            whether it has jumped (m).
    """
    (sigma_m, alone_m), known = sigmas_m, node.absolute.zeroed
    if node.role in physics.OUTSIDE_ROLES:
        return node
    if known.name is None:
        known = _zero(state, node, known, t, up_m, sigma_m)
        if known.name is not None and not node.heights and node.unseen_up_m2 > 0.0:
            # Before it is fused: or what its bearer has climbed unseen would be what it is off by.
            doubt_height(state, node, t, node.unseen_up_m2)
            node = replace(node, unseen_up_m2=0.0)
    else:
        variable = Variable("altimeter", known.name)
        _drift(state, variable, t - known.t)
        expected_m = float(state.graph.value(variable)[0]) + _up_m(state, node, t)
        known = known.after(t, up_m, node.way_m, up_m - expected_m, alone_m)
        found = known.has_jumped(alone_m, _unsure_m2(state, node, variable)) if known.lasts else None
        if node.mode == "unit" and node.level and not (found and known.steep(found[1])):
            # What is expected of his height follows him slowly, and whatever his altimeter reads.
            found = known.steeper()
        if found is not None:
            return jump(state, node, known, *found)
    state.nodes[node.node] = replace(node, absolute=replace(node.absolute, zeroed=known))
    return state.nodes[node.node]


def _zero(
    state: FusionState, node: NodeState, known: AltimeterZero, t: float, up_m: float, sigma_m: float
) -> AltimeterZero:
    """Hold one of its first readings against where its bearer is."""
    known = known.with_one(t, up_m - _up_m(state, node, t))
    if not known.enough(t):
        return known
    row = state.graph.starts[node.position] + 2
    unseen_m2 = 0.0 if node.heights else node.unseen_up_m2
    off_m, doubt_m = known.judged(sigma_m, float(state.graph.covariance()[row, row]) + unseen_m2)
    if off_m:
        text = f"the altimeter of {node.node} is off by {off_m:+.1f} m: it was not zeroed"
        state.say("outlier", t, node.node, text)
    return replace(known, name=new_altimeter(state, node, 0.0, doubt_m), t=t)


def _up_m(state: FusionState, node: NodeState, t: float) -> float:
    return float(state.place(node)[2]) + offset_of(state, node, t)[2]


def _unsure_m2(state: FusionState, node: NodeState, altimeter: Variable) -> float:
    rows = [state.graph.starts[node.position] + 2, state.graph.starts[altimeter]]
    return float(state.graph.covariance()[np.ix_(rows, rows)].sum())


def _drift(state: FusionState, altimeter: Variable, waited_s: float) -> None:
    walked_m2 = physics.HEIGHT_WALK_M_PER_ROOT_S**2 * max(waited_s, 0.0)
    if walked_m2 > NOTHING_M2:
        rows = np.array([[state.graph.starts[altimeter]]])
        moved = state.graph.reference[rows]
        state.graph.advance(rows, moved, np.eye(1)[None], np.full((1, 1, 1), walked_m2))
