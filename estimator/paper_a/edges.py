"""Measurements in paper A's network: ranges, ranges from RSSI, and GPS fixes (sections IV-A to IV-D)."""

import numpy as np

from estimator.estimate import Vector3
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi
from estimator.paper_a import noise
from estimator.paper_a.lifecycle import ORIGIN, join, move
from estimator.paper_a.node import GraphNode
from estimator.paper_a.state import PaperAState


def pair(state: PaperAState, reading: Range | Rssi) -> None:
    """A relative range between two nodes that both have a position."""
    if isinstance(reading, Rssi):
        range_m = noise.range_of(reading.dbm, reading.tx_dbm)
        sigma_m = noise.rssi_sigma_m(range_m)
    else:
        range_m, sigma_m = reading.range_m, reading.sigma_m or noise.RANGE_SIGMA_M
    ends = [state.node_of(name, "breadcrumb", reading.t) for name in (reading.a, reading.b)]
    for node in ends:
        if node.mode in ("undecided", "retired"):
            text = f"{node.node} is {node.mode}: what is measured to it is set aside"
            state.refuse("not_fused", reading.t, node.node, text)
            return
        if _is_past(state, node, reading.t):
            return
    first, second = (_at(state, node, reading.t) for node in ends)
    if first.mode == "anchor":
        first, second = second, first
    if first.mode == "vertex":  # between two anchors there is nothing to learn
        state.network.add_range(first.vertex, state.end(second), range_m, noise.within_limits(sigma_m))
    state.fused(reading.t, reading.a, reading.b)


def fix(state: PaperAState, reading: Position, place_m: Vector3) -> None:
    """A GPS fix: a relative position to the ground (eq. 12), or where an undecided node joins.

    Args:
        state: changed in place.
        reading: the fix.
        place_m: its position, east, north, up (m).
    """
    node = state.node_of(reading.node, "responder", reading.t)
    sigma = [noise.within_limits(s) for s in reading.sigma_m or noise.FIX_SIGMA_M]
    if node.mode in ("anchor", "retired"):
        text = f"{node.node} is a {node.mode} {node.role}: fixes of it are set aside"
        state.refuse("conflict", reading.t, node.node, text)
        return
    if _is_past(state, node, reading.t):
        return
    if node.mode == "undecided":
        join(state, node, reading.t, np.array(place_m), sigma)
    else:
        node = _at(state, node, reading.t)
        state.network.add_position(node.vertex, ORIGIN, np.array(place_m), sigma)
    state.fused(reading.t, node.node)


def _is_past(state: PaperAState, node: GraphNode, t: float) -> bool:
    """Whether the state that a reading of a mobile node belongs to has been deleted."""
    if node.state_t is None or t >= node.state_t:
        return False
    text = "readings came late: the states that they belong to are deleted"
    state.refuse("too_late", t, node.node, text, count="too_late")
    return True


def _at(state: PaperAState, node: GraphNode, t: float) -> GraphNode:
    """A node's state for a reading at `t`: a mobile node whose unit tells its way waits where it last was."""
    if node.state_t is None or node.reckons or t <= node.state_t:
        return node
    return move(state, node, t, np.zeros(3), noise.unreported_sigma_m(node.role, t - node.state_t))
