"""What a `node` reading tells of who has entered already: he stands elsewhere, or faces elsewhere.

Gateways repeat introductions: what was told before is no news.
"""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.introduce import attach_unit, introduce, place, told_sigma_m
from estimator.fusion.entering.reentry import note_introduction
from estimator.fusion.entering.reinitialise import CONTRADICTED, SET_OFF_M, error_of, known_before
from estimator.fusion.entering.replaced_unit import announce, reports_another_unit
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.measurements.bearing import within_pi
from estimator.measurements.node import Node
from estimator.measurements.position import Position

SAME_M = 0.05
"""Two gateways may round what they were told."""


def take(state: FusionState, reading: Node) -> list[Position]:
    """Take in a `node` reading.

    Args:
        state: the fusion, changed in place.
        reading: an introduction, the first of its node or a later one.

    Returns:
        Where it tells a node to be that has a place already, as a fix that is still to be held.
    """
    known = state.nodes.get(reading.node)
    if known is not None and known.mode == "retired":
        note_introduction(state, reading)
        return []
    changes = known is not None and reports_another_unit(known, reading)
    if not introduce(state, reading):
        return []
    if changes:
        announce(state, reading)
    told = [] if known is None or not known.decided else _told_again(state, known, reading)
    if not told:
        state.count("fused")
    return told


def _told_again(state: FusionState, known: NodeState, reading: Node) -> list[Position]:
    node, where_m = state.nodes[reading.node], reading.position_m
    if known.mode == "unit" and node.changed is None and _faces_elsewhere(known, reading):
        _face(state, node, reading)
        node = state.nodes[reading.node]
    sigma, told_m = told_sigma_m(reading), known.absolute.told_m
    if where_m is None or node.mode == "fixed":
        return []
    if told_m is not None and math.dist(where_m, told_m) <= max(sigma, SAME_M):
        return []
    began = node.way_m > SET_OFF_M and known.absolute.beginning != "unheard"
    if node.moving and (began or (told_m is not None and known.mode == "free")):
        text = f"{node.node} is on the way already: where it began is set aside (a fix tells where it is)"
        state.say("conflict", reading.t, node.node, text, once=f"{node.node} told again")
        return []
    state.nodes[node.node] = node = replace(node, absolute=replace(node.absolute, told_m=where_m))
    if node.mode == "static":
        off_m = np.asarray(where_m[:2]) - state.place(node)[:2]
        if error_of(state, node, off_m.tolist(), sigma) > CONTRADICTED:
            state.graph.delete_nodes([node.position])
            state.mistold.pop(node.node, None)
            node = replace(node, mode="undecided", index=state.number(node.node), otherwise=())
            node = replace(node, absolute=replace(node.absolute, disbelieved_m=None))
            place(state, node, reading.t, where_m, (sigma, sigma, sigma))
            text = f"{node.node} lies elsewhere than it did: its gateway says where"
            state.say("node_moved", reading.t, node.node, text)
            return []
    return [Position(t=reading.t, node=node.node, position_m=where_m, sigma_m=(sigma, sigma, sigma))]


def _faces_elsewhere(known: NodeState, reading: Node) -> bool:
    if reading.heading_rad is None:
        return False
    if known.heading_rad is None:
        return True
    return abs(within_pi(reading.heading_rad - known.heading_rad)) > physics.HEADING_SIGMA_RAD


def _face(state: FusionState, node: NodeState, reading: Node) -> None:
    """Let a unit's frame begin anew with what it is told to face; too late where its bearer has set off."""
    if node.way_m > SET_OFF_M or known_before(state, node):
        text = f"{node.node} is on the way already: what he faced at the start is set aside"
        state.say("conflict", reading.t, node.node, text, once=f"{node.node} told to face")
        return
    state.graph.delete_nodes([node.unit])
    across, upwards = physics.SPEED_SIGMA_MPS[node.role]
    state.graph.add_node(node.velocity, (0.0, 0.0, 0.0), (across, across, upwards))
    attach_unit(state, replace(node, mode="free", turned=False), node.first_heading_rad, node.raw)
    state.due = True
