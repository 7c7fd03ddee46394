"""Somebody is carried while his unit stands: what it tells meanwhile is not how he moves.

Who is down is dragged or carried out, or rides in a lift; his boot hardly moves against what it lies on,
and his unit tells that he stands. He goes on where readings put him, as one whose unit is silent, until it
steps.
"""

import math
from collections.abc import Sequence

from msgspec.structs import replace

from estimator.fusion.entering.unbelieved_steps import leave_behind, unbelieve
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.state import FusionState
from estimator.inertial.displacement import InertialDisplacement
from estimator.measurements.displacement import Displacement

HARDLY_MPS = 0.1
"""A unit that tells less stands, but for the jolts of being carried; who crawls gets farther."""


def set_aside(state: FusionState, readings: Sequence[Displacement]) -> list[Displacement]:
    """The displacements that move somebody: not those of units that stand while their bearers are carried.

    Args:
        state: the fusion.
        readings: in order of epoch.
    """
    moving: list[Displacement] = []
    for reading in readings:
        node = state.nodes.get(reading.node)
        if node is None or node.carried_t is None or node.mode != "unit":
            moving.append(reading)
            continue
        since_t = node.carried_t if reading.from_t is None else reading.from_t
        if math.hypot(*reading.delta_m) < HARDLY_MPS * (reading.t - since_t):
            state.nodes[node.node] = replace(node, carried_t=max(node.carried_t, reading.t))
            if not isinstance(reading, InertialDisplacement):
                state.count("not_fused")
        else:
            state.nodes[node.node] = replace(node, carried_t=None, joined_t=since_t)
            moving.append(reading if reading.from_t is not None else replace(reading, from_t=since_t))
    return moving


def let_be_carried(state: FusionState, name: str, since_t: float, until_t: float, placed: bool) -> None:
    """Let somebody have been carried while his unit stood.

    Args:
        state: the fusion, changed in place; its window is to be solved again.
        name: of the node.
        since_t: since when (s).
        until_t: and until when (s); up to the newest step: he still is.
        placed: see `unbelieved_steps.unbelieve`.
    """
    node = state.nodes[name]
    leave_behind(state, node.index, since_t, until_t)
    unbelieve(state, node.index, since_t, until_t, placed)
    still_is = node.unit_t is not None and until_t >= node.unit_t
    state.nodes[name] = replace(
        node,
        carried_t=node.unit_t if still_is else None,
        rival=None,
        walk_factors=(1.0, 1.0),
        still=None if still_is else node.still,
        straight=StraightLegs() if still_is else node.straight,
        trail=() if still_is else node.trail,
    )
    # What was learned meanwhile a wrong way has made.
    state.noise, state.due = {}, True
    text = (
        f"{name} moves while the unit of {name} stands: carried, or in a lift, or without the unit; "
        f"call {name} by voice"
    )
    state.say("conflict", state.newest_t, name, text)
