"""Who was retired comes back under the same name: he enters anew, and what was of him before stays.

A crew that goes in again is introduced again. Gateways repeat introductions, though, and a callsign may be
put right after somebody has left: only who is introduced and then reported of has come back.
"""

from msgspec.structs import replace

from estimator.fusion.entering import introduce
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.measurements.node import MOVING_ROLES, Node, Role


def note_introduction(state: FusionState, reading: Node) -> None:
    """Take down that a retired node is introduced again, if that can mean that it comes back.

    Of what stands somebody has to say where: what has burned may still be on a gateway's list.
    """
    known = state.nodes[reading.node]
    tells = reading.role in MOVING_ROLES or reading.role == "base" or reading.position_m is not None
    if reading.t > known.t and tells:
        state.called[reading.node] = reading
        state.nodes[reading.node] = replace(known, inside=False)
    elif reading.position_m not in (None, known.place_m):
        state.say("conflict", reading.t, known.node, f"{known.node} is retired and is not moved")
        state.count("not_fused")
        return
    state.count("fused")


def re_enter(state: FusionState, name: str, t: float) -> None:
    """Let a node that has been introduced again enter, for something is reported of it.

    Args:
        state: the fusion, changed in place.
        name: the node.
        t: epoch of what is reported (s).
    """
    reading = state.called.get(name)
    if reading is None or t < reading.t:
        return
    inside = state.nodes[name].inside
    begin_anew(state, state.nodes[name], reading.role, reading.t)
    introduce.introduce(state, reading)
    state.nodes[name] = replace(state.nodes[name], inside=inside)
    state.say("came_back", t, name, f"{name} has come back: introduced again and reported of")


def begin_anew(state: FusionState, known: NodeState, role: Role, t: float) -> None:
    """End a retired node's life for good, and begin another one with a number of its own.

    Args:
        state: the fusion, changed in place.
        known: the retired node; it is undecided afterwards.
        role: what it comes back as.
        t: since when it is back (s).
    """
    name = known.node
    state.ended[known.index] = known
    for kept in (state.called, state.navigations, state.listeners):
        kept.pop(name, None)
    # Where it was is nowhere near: what radios heard of it then tells of no reach.
    state.listeners = {a: listener.without(name) for a, listener in state.listeners.items()}
    state.nodes[name] = NodeState(
        node=name,
        role=role,
        named=known.named,
        crew=known.crew,
        t=t,
        index=state.number(name),
        introduced_t=t,
    )
