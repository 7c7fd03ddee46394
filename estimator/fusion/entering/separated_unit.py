"""A unit and a radio of one name that are not in one place: the radio is followed, the unit beside.

A radio lies on a table while its bearer walks on; a unit was left in the cabin; two firefighters have changed
radios at the door. Each reading is right, and together they are wrong: nothing tells which of both is on him.
The node goes on where ranges put it, as of a unit that is silent, and its ellipse holds the unit's way too.
"""

import numpy as np
from msgspec.structs import replace

from estimator.fusion.entering.replaced_unit import change, framed
from estimator.fusion.entering.unbelieved_steps import unbelieve
from estimator.fusion.images import doubt_m2
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.separated_unit import SeparatedUnit
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.displacement import Displacement


def go_beside(state: FusionState, node: NodeState, apart: SeparatedUnit, reading: Displacement) -> None:
    """Let a unit that is apart go on by itself.

    Args:
        state: the fusion.
        node: of the unit.
        apart: what is known of it.
        reading: what it has told.
    """
    state.nodes[node.node] = replace(node, apart=apart.going(framed(node, reading)))


def part(
    state: FusionState, name: str, since_t: float, place_m: tuple[float, float], turn_rad: float
) -> None:
    """Follow a radio by itself from an epoch on.

    Args:
        state: the fusion, changed in place; its window is to be solved again.
        name: of the node.
        since_t: when radio and unit were together for the last time (s).
        place_m: where that was: east, north (m).
        turn_rad: ψ of the unit's frame then (rad).
    """
    node = state.nodes[name]
    marks = [(since_t, 0.0, 0.0)]
    for t, gone_e, gone_n in unbelieve(state, node.index, since_t)[:, [0, 3, 4]].tolist():
        marks.append((t, marks[-1][1] + gone_e, marks[-1][2] + gone_n))
    known = SeparatedUnit(since_t, place_m, turn_rad, tuple(marks))
    state.nodes[name] = replace(node, apart=known, trail=())
    state.due = True
    text = (
        f"ranges and steps of {name} go different ways: its radio or its unit is not on {name} (left behind,"
        f" or exchanged); call {name} by voice, and find both"
    )
    state.say("conflict", state.newest_t, name, text)


def join(state: FusionState, name: str) -> None:
    """Radio and unit go together again: steps count, and what the unit faces is to be found anew."""
    node = state.nodes[name]
    state.nodes[name] = replace(
        node, apart=None, changed=(node.pose_t, None), still=None, straight=StraightLegs(), trail=()
    )
    change(state, name)
    state.nodes[name] = replace(state.nodes[name], changed=None, joined_t=node.pose_t)
    state.due = True
    state.say("unit_changed", state.newest_t, name, f"radio and unit of {name} go together again")


def elsewhere_m2(node: NodeState, place_m: Array) -> Array:
    """What it adds to the covariance of a place that somebody may be elsewhere, 3 × 3 (m²).

    Args:
        node: who.
        place_m: where he is shown: east, north (m).
    """
    return doubt_m2((*node.otherwise, *node.detours), place_m) + apart_m2(node, place_m)


def apart_m2(node: NodeState, place_m: Array) -> Array:
    """What it adds that a unit may lead astray, or be elsewhere than its radio, 3 × 3 (m²)."""
    found = np.zeros((3, 3))
    if node.apart is not None:
        found += node.apart.doubt_m2(place_m)
    elif node.rival is not None and node.mode == "unit":
        found[:2, :2] += node.rival.doubt_m2(place_m, node.pose_t)
    return found
