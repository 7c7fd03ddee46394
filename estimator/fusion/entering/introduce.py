"""Nodes enter: by a `node` reading, at a fix, at the base, or where a responder drops them."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.measurements.node import MOVING_ROLES, Node

NO_PRIOR_SIGMA_M = 1e3


def introduce(state: FusionState, reading: Node) -> bool:
    """Take in a `node` reading: a new node, a name for a guessed one, or news of a known one.

    Returns:
        Whether the node is what the reading says that it is, and where.
    """
    known = state.nodes.get(reading.node)
    if known is None:
        number = state.number(reading.node)
        node = NodeState(
            node=reading.node,
            role=reading.role,
            named=True,
            t=reading.t,
            index=number,
            introduced_t=reading.t,
        )
    elif known.role != reading.role and not _may_become(state, known, reading):
        return False
    else:
        known = state.nodes[reading.node]
        # Of who has a place a name is no news: his fix is as old as it was.
        since_t = known.t if known.decided else max(known.t, reading.t)
        introduced_t = known.introduced_t if known.named else reading.t
        node = replace(known, role=reading.role, named=True, t=since_t, introduced_t=introduced_t)
    if reading.heading_rad is not None:
        node = replace(node, heading_rad=reading.heading_rad)
    if reading.heading_sigma_rad is not None:
        node = replace(node, heading_sigma_rad=reading.heading_sigma_rad)
    if reading.device is not None:
        node = replace(node, device=reading.device, device_told_t=reading.t)
    if reading.crew is not None:
        node = replace(node, crew=reading.crew)
    if reading.position_m is not None:
        node = replace(node, place_told_t=reading.t)
    state.nodes[node.node] = node
    if node.mode == "undecided":
        _place_new(state, node, reading)
    elif node.mode == "fixed" and reading.position_m not in (None, node.place_m):
        state.say("conflict", reading.t, node.node, f"{node.node} is fixed and is not moved")
        state.count("not_fused")
        return False
    return True


def _may_become(state: FusionState, known: NodeState, reading: Node) -> bool:
    if not known.named and known.mode == "undecided":
        state.sightings.pop(known.node, None)
        return True
    if not known.named and known.mode == "static" and reading.role in MOVING_ROLES:
        # Guessed from readings that came before its introduction: they tell where it sets out from.
        where, rows = state.graph.value(known.position).tolist(), state.graph.rows(known.position)
        own = np.sqrt(np.diag(state.graph.covariance()[rows, rows]))
        state.graph.delete_nodes([known.position])
        anew = replace(
            known, role=reading.role, mode="undecided", index=state.number(known.node), otherwise=()
        )
        if reading.position_m is None:
            place(state, anew, reading.t, where, np.hypot(own, physics.ENTRY_SIGMA_M).tolist())
        else:
            state.nodes[known.node] = anew
        return True
    both_move = known.role in MOVING_ROLES and reading.role in MOVING_ROLES
    both_stand = not {known.role, reading.role} & (MOVING_ROLES | {"base"})
    if not known.named and known.mode != "retired" and (both_move or both_stand):
        return True
    text = f"{known.node} is a {known.role} and cannot become a {reading.role}: the reading is set aside"
    state.say("conflict", reading.t, known.node, text)
    state.count("not_fused")
    return False


def _place_new(state: FusionState, node: NodeState, reading: Node) -> None:
    if reading.role == "base":
        where = reading.position_m or (0.0, 0.0, 0.0)
        state.nodes[node.node] = replace(node, mode="fixed", place_m=where)
    elif reading.position_m is not None:
        sigma = told_sigma_m(reading)
        node = replace(node, absolute=replace(node.absolute, told_m=reading.position_m))
        place(state, node, reading.t, reading.position_m, (sigma, sigma, sigma))


def told_sigma_m(reading: Node) -> float:
    """Standard deviation of a told position along each axis (m)."""
    usual = {"anchor": physics.ANCHOR_SIGMA_M, "uav": physics.FIX_SIGMA_M[0]}
    return reading.sigma_m or usual.get(reading.role, physics.SURVEY_SIGMA_M)


class Entry(NamedTuple):
    """Since when somebody is followed whom readings have found, and what was known of him without them.

    Attributes:
        t: epoch of the first of them (s).
        position_m: east, north, up (m).
        sigma: standard deviation of each (m).
    """

    t: float
    position_m: Sequence[float]
    sigma: Sequence[float]


def place(
    state: FusionState,
    node: NodeState,
    t: float,
    position_m: Sequence[float] | Array,
    sigma: Sequence[float],
    entered: Entry | None = None,
) -> None:
    """Decide an undecided node's position by a prior: static nodes stay there, the others begin to move.

    Args:
        state: the fusion.
        node: an undecided node.
        t: epoch of the position.
        position_m: east, north, up (m).
        sigma: standard deviation of each (m).
        entered: of who moves, where readings have told the position: the window is solved with them.
    """
    floored = [max(s, physics.SIGMA_FLOOR_M) for s in sigma]
    state.graph.add_node(node.position, position_m, floored)
    state.sightings.pop(node.node, None)
    state.tried.pop(node.node, None)
    east, north, up = (float(c) for c in position_m)
    if node.role in MOVING_ROLES:
        uav = float(node.role == "uav")
        since = Entry(t, (east, north, up), floored) if entered is None else entered
        state.ledger.add("begins", since.t, node.index, 0.0, uav, *since.position_m, *since.sigma, 0.0, 0.0)
        across, upwards = physics.SPEED_SIGMA_MPS[node.role]
        state.graph.add_node(node.velocity, (0.0, 0.0, 0.0), (across, across, upwards))
        state.nodes[node.node] = replace(node, mode="free", pose_t=t, t=max(t, node.t))
        if node.role == "responder" and state.entered_t is None:
            state.entered_t = since.t
    else:
        state.ledger.add("stands", t, node.index, east, north, up, *floored)
        state.nodes[node.node] = replace(node, mode="static", t=max(t, node.t))


def attach_unit(
    state: FusionState, node: NodeState, unit_heading_rad: float | None, raw: bool = False
) -> None:
    """A node that moved freely is known to carry a PDR unit: its velocity goes, ψ, β and s come.

    Args:
        state: the fusion.
        node: a free node.
        unit_heading_rad: what the unit's first displacement gives as heading, if it does.
        raw: its displacements are made here, from samples.
    """
    state.graph.delete_nodes([node.velocity])
    boot = state.navigations.get(node.node) if raw else None
    node = replace(node, raw=raw)
    turn = initial_turn(node.heading_rad, unit_heading_rad)
    if boot is not None:
        # Its frame is known: it is that in which it was told to begin.
        turn = within_pi((boot.began_rad if node.heading_rad is None else node.heading_rad) - boot.began_rad)
    sigma = (turn_sigma(node), state.bias_sigma_radps(node), state.scale_sigma(node))
    state.graph.add_node(node.unit, (turn, 0.0, 0.0), sigma)
    uav = float(node.role == "uav")
    nothing = (0.0,) * 6
    state.ledger.add("begins", node.pose_t, node.index, 1.0, uav, *nothing, turn, sigma[0])
    turned = sigma[0] > physics.TURNED_SIGMA_RAD
    state.nodes[node.node] = replace(node, mode="unit", turned=turned, first_heading_rad=unit_heading_rad)


def turn_sigma(node: NodeState) -> float:
    """Prior standard deviation of ψ (rad)."""
    told = node.heading_sigma_rad or physics.HEADING_SIGMA_RAD
    return float(min(max(told, physics.HEADING_FLOOR_RAD), np.pi))


def initial_turn(node_heading_rad: float | None, unit_heading_rad: float | None) -> float:
    """Prior mean of ψ, the turn of the unit's frame (rad).

    The frame is nominally east (0), unless the node's `heading_rad` says otherwise. Gateways give there
    either the direction of the frame's x axis or that in which the bearer faces at the start; the unit's
    own first heading tells which: two of the three possible turns then agree.
    """
    if node_heading_rad is None:
        return 0.0
    if unit_heading_rad is None:
        return within_pi(node_heading_rad)
    faced = within_pi(node_heading_rad - unit_heading_rad)
    axis = within_pi(node_heading_rad)
    if abs(within_pi(faced - axis)) <= min(abs(faced), abs(axis)):
        return axis
    return 0.0


def drop(state: FusionState, name: str, by: NodeState, where_m: Array, t: float, unsure_m2: Array) -> bool:
    """A breadcrumb lies where its bearer stood: an edge p − p_by = offset with an honest sigma.

    Args:
        state: the fusion.
        name: the breadcrumb.
        by: the responder, decided.
        where_m: where `by` stood at `t`, 3 (m).
        t: epoch of the drop.
        unsure_m2: variances of that for what his unit has not told, 3 (m²).

    Returns:
        Whether the breadcrumb may be dropped at all.
    """
    node = state.node_of(name, "breadcrumb", t)
    if node.mode not in ("undecided", "static") or node.role in MOVING_ROLES:
        text = f"{name} is a {node.mode} {node.role}: it cannot be dropped by {by.node}"
        state.say("conflict", t, name, text)
        return False
    if node.mode == "static":
        state.graph.delete_nodes([node.position])
        state.say("node_moved", t, name, f"{name} was dropped anew by {by.node}")
    if node.mode == "static" or name in state.sightings:
        # What was measured to it before was measured to another place, or to a hand that carried it.
        node = replace(node, mode="undecided", index=state.number(name))
    wide = (NO_PRIOR_SIGMA_M,) * 3
    node = replace(node, otherwise=by.otherwise, unseen_up_m2=by.doubt_up_m2, place_told_t=t)
    if math.isinf(node.introduced_t):
        node = replace(node, introduced_t=t)
    place(state, node, t, where_m, wide)
    state.ledger.add("drops", t, node.index, by.index)
    start = state.graph.rows(state.nodes[name].position).start
    known = np.array([s**-2 for s in physics.DROP_SIGMA_M])
    information = known / (1.0 + known * unsure_m2)
    axes = np.arange(3)
    if by.mode == "fixed":
        columns, jacobian = (start + axes)[:, None], np.ones((3, 1))
    else:
        other = state.graph.rows(by.position).start
        columns = np.column_stack([start + axes, other + axes])
        jacobian = np.column_stack([np.ones(3), -np.ones(3)])
    state.graph.add_measurements(columns, jacobian, information, np.zeros(3))
    return True


def tuple_of(vector: Array) -> Vector3:
    """Three numbers as they leave the tracker."""
    east, north, up = vector.tolist()
    return east, north, up


def upper_triangle(matrix: Array) -> tuple[float, float, float, float, float, float]:
    """ee, en, eu, nn, nu, uu of a 3 × 3 covariance."""
    (ee, en, eu), (_, nn, nu), (_, _, uu) = matrix.tolist()
    return ee, en, eu, nn, nu, uu
