"""Somebody is carried while his unit stands: what it tells meanwhile is not how he moves.

Who is down is dragged or carried out, or rides in a lift; his boot hardly moves against what it lies on,
and his unit tells that he stands. He goes on where readings put him, as one whose unit is silent, until it
steps.
"""

import math

from msgspec.structs import replace

from estimator.fusion.entering.unbelieved_steps import leave_behind, unbelieve
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.measurements.displacement import Displacement

HARDLY_MPS, JOLT_M = 0.1, 0.5
"""A unit that tells less stands; and one that tells more, until it has got so far: boots are jolted while
somebody is carried."""


def first_step(
    state: FusionState, node: NodeState, stood_t: float, reading: Displacement
) -> Displacement | None:
    """The displacement with which somebody who was carried goes on by himself; None: his unit still stands.

    Args:
        state: the fusion.
        node: of the unit.
        stood_t: epoch of the newest report that it stands (s).
        reading: what it has told.
    """
    since_t = stood_t if reading.from_t is None else reading.from_t
    east, north, up = reading.delta_m
    got_m = (0.0, 0.0)
    if math.hypot(east, north, up) >= HARDLY_MPS * (reading.t - since_t):
        got_m = node.carried_m[0] + east, node.carried_m[1] + north
    if math.hypot(*got_m) < JOLT_M:
        state.nodes[node.node] = replace(node, carried_t=max(stood_t, reading.t), carried_m=got_m)
        return None
    state.nodes[node.node] = replace(node, carried_t=None, joined_t=since_t)
    return reading if reading.from_t is not None else replace(reading, from_t=since_t)


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
        carried_m=(0.0, 0.0),
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
