"""Nodes join paper A's network, move in it, and leave it (sections IV-D and IV-E)."""

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from estimator.graph.dense import Array
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.navigation import navigate
from estimator.inertial.samples import pieces
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.imu import Imu
from estimator.measurements.node import MOVING_ROLES, Node
from estimator.measurements.retire import Retire
from estimator.paper_a import noise
from estimator.paper_a.node import GraphNode
from estimator.paper_a.state import PaperAState, upper_triangle, vector3

ORIGIN = np.zeros(3)


def introduce(state: PaperAState, reading: Node) -> None:
    """A `node` reading: a new node, a name for a guessed one, or news of a known one.

    Where a node stands is taken from its first `node` reading that tells it; after that its measurements say.
    """
    known = state.node_of(reading.node, reading.role, reading.t)
    if known.mode == "retired" and reading.t > known.t and reading.role in MOVING_ROLES:
        # Who has left is introduced again: he enters anew.
        state.navigations.pop(known.node, None)
        known = GraphNode(node=known.node, role=reading.role, t=reading.t)
    if known.role != reading.role and not _may_become(known, reading):
        text = f"{known.node} is a {known.role} and cannot become a {reading.role}: the reading is set aside"
        state.refuse("conflict", reading.t, known.node, text)
        return
    node = state.nodes[known.node] = replace(known, role=reading.role, named=True)
    if node.mode == "undecided" and reading.role == "base":
        place_m = reading.position_m or (0.0, 0.0, 0.0)
        state.nodes[node.node] = replace(node, mode="anchor", place_m=place_m, covariance_m2=(0.0,) * 6)
    elif node.mode == "undecided" and reading.position_m is not None:
        usual = noise.PLACED_SIGMA_M.get(reading.role, noise.PLACED_SIGMA_OTHER_M)
        sigma = noise.within_limits(reading.sigma_m or usual)
        join(state, node, reading.t, np.array(reading.position_m), (sigma,) * 3)
    state.fused(reading.t, node.node)


def _may_become(known: GraphNode, reading: Node) -> bool:
    if known.named or known.mode == "retired":
        return False
    return known.mode == "undecided" or (
        reading.role != "base" and known.moves == (reading.role in MOVING_ROLES)
    )


def join(
    state: PaperAState, node: GraphNode, t: float, place_m: Array, sigma_m: Sequence[float]
) -> GraphNode:
    """AddNode+ of an undecided node, connected to the ground by what is known of its position.

    Args:
        state: changed in place.
        node: the node.
        t: epoch of the position, Unix seconds.
        place_m: its position, 3 (m).
        sigma_m: √P per axis (m).

    Returns:
        The node as it is now.
    """
    node = replace(node, mode="vertex", state_t=t if node.moves else None)
    state.network.add_node(node.vertex, ORIGIN, place_m, sigma_m)
    state.nodes[node.node] = node
    return node


def enter(state: PaperAState, node: GraphNode, t: float) -> GraphNode:
    """A firefighter whose first position nobody gave enters at the base."""
    return join(state, node, t, state.base_place(), noise.ENTRY_SIGMA_M)


def displace(state: PaperAState, reading: Displacement) -> None:
    """What a PDR unit measured: its bearer's next state, and the edge to the one before (section IV-E).

    The unit's frame is taken to be east, north, up: the paper knows no heading error.
    """
    node = _bearer(state, reading.node, reading.t)
    if not node.moves or node.mode == "retired":
        text = f"{node.node} is a {node.mode} {node.role}: its displacements are set aside"
        state.refuse("conflict", reading.t, node.node, text)
        return
    if node.mode == "undecided":
        node = enter(state, node, reading.t if reading.from_t is None else reading.from_t)
        if reading.from_t is None:  # since when is not known: its end is as near to the base
            state.fused(reading.t, node.node)
            return
    since = reading.t if node.state_t is None else node.state_t
    if reading.t <= since:
        text = "displacements came late: the states that they lead to are there already"
        state.refuse("too_late", reading.t, node.node, text, count="too_late")
        return
    begin = since if reading.from_t is None else reading.from_t
    delta, duration = np.array(reading.delta_m), reading.t - begin
    way = float(np.sqrt(delta @ delta))
    if node.role == "responder" and way > noise.FASTEST_MPS * duration:
        text = f"faster than {noise.FASTEST_MPS:g} m/s: the displacement is dropped"
        state.refuse("outlier", reading.t, node.node, text, count="outlier")
        return
    share = min((reading.t - since) / duration, 1.0) if duration > 0.0 else 1.0
    sigma = (reading.sigma_m or noise.pdr_sigma_m(node.way_m, way)) * share**0.5
    silent = noise.unreported_sigma_m(node.role, begin - since) if node.reckons else 0.0
    node = move(state, node, reading.t, share * delta, float(np.hypot(sigma, silent)))
    east, north, _ = reading.delta_m
    speed = float(np.hypot(east, north)) / duration if duration > 0.0 else None
    state.nodes[node.node] = replace(node, reckons=True, way_m=node.way_m + way, speed_mps=speed)
    state.fused(reading.t, node.node)


def navigate_boot(state: PaperAState, reading: Imu) -> None:
    """What raw samples of a boot make is what a PDR unit would have measured: the paper's are such boots."""
    node, led, text = _bearer(state, reading.node, reading.t), list[InertialDisplacement](), None
    for piece in pieces(reading):
        done = navigate(state.navigations.get(node.node), piece, 0.0)
        state.navigations[node.node] = done.navigation
        led, text = led + done.displacements, done.text or text
    if led:
        east, north, up = np.sum([each.delta_m for each in led], axis=0).tolist()
        whole = Displacement(t=led[-1].t, node=node.node, delta_m=(east, north, up), from_t=led[0].from_t)
        displace(state, whole)
    elif text is not None:
        state.refuse("not_fused", reading.t, node.node, f"{node.node}: {text}")
    else:
        state.fused(reading.t)


def _bearer(state: PaperAState, name: str, t: float) -> GraphNode:
    """A node that walks: if its role was guessed otherwise from what it measured, it is known better now."""
    node = state.node_of(name, "responder", t)
    if node.mode == "undecided" and not node.named and not node.moves:
        node = state.nodes[name] = replace(node, role="responder")
    return node


def move(state: PaperAState, node: GraphNode, t: float, offset_m: Array, sigma_m: float) -> GraphNode:
    """A mobile node's state at `t`, in place of the one before.

    Args:
        state: changed in place.
        node: the node.
        t: the new timestamp, Unix seconds; later than the last one.
        offset_m: what it has moved since, 3 (m).
        sigma_m: √P per axis (m).

    Returns:
        The node as it is now.
    """
    moved = replace(node, state_t=t)
    state.network.move(node.vertex, moved.vertex, offset_m, (noise.within_limits(sigma_m),) * 3)
    state.nodes[node.node] = moved
    return moved


def drop(state: PaperAState, reading: Drop) -> None:
    """A breadcrumb joins where its bearer stands; one dropped before has been picked up since."""
    by = _bearer(state, reading.by, reading.t)
    crumb = state.node_of(reading.node, "breadcrumb", reading.t)
    if by.mode == "undecided" and by.moves:
        by = enter(state, by, reading.t)
    if by.mode not in ("vertex", "anchor") or crumb.mode not in ("undecided", "vertex") or crumb.moves:
        text = f"{crumb.node}, a {crumb.role}, cannot be dropped by {by.node}, a {by.role}"
        state.refuse("conflict", reading.t, crumb.node, text)
        return
    if crumb.mode == "vertex":
        state.network.delete_node(crumb.vertex)
    state.network.add_node(crumb.vertex, state.end(by), np.zeros(3), (noise.DROP_SIGMA_M,) * 3)
    state.nodes[crumb.node] = replace(crumb, mode="vertex")
    state.fused(reading.t, crumb.node, by.node)


def retire(state: PaperAState, reading: Retire) -> None:
    """DeleteNode of a node for good; its last estimate stays to be shown."""
    node = state.node_of(reading.node, "responder", reading.t)
    if node.mode == "retired":
        state.refuse("conflict", reading.t, node.node, f"{node.node} is retired already")
        return
    if node.mode == "vertex":
        rows = state.network.graph.rows(node.vertex)
        place_m = vector3(state.network.place(node.vertex))
        covariance_m2 = upper_triangle(state.network.covariance()[rows, rows])
        state.network.delete_node(node.vertex)
        node = replace(node, place_m=place_m, covariance_m2=covariance_m2)
    state.nodes[node.node] = replace(node, mode="retired", state_t=None)
    state.fused(reading.t, node.node)
