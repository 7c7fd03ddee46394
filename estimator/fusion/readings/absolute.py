"""Fixes and heights as they are held against the graph."""

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.introduce import place
from estimator.fusion.entering.reinitialise import check_fix
from estimator.fusion.memory.absolute import Absolute
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.heading_arcs import unbend
from estimator.fusion.motion.recent_places import offset_of, turned_m
from estimator.fusion.readings.altimeters import heard_altimeter
from estimator.fusion.readings.receivers import receiver_of
from estimator.fusion.rows.rows import Single
from estimator.graph.robust import Mixture
from estimator.graph.variable import Variable
from estimator.measurements.altitude import Altitude, Pressure, height_above
from estimator.measurements.position import Position, east_north_up


def fix(state: FusionState, reading: Position) -> list[Single]:
    """What an absolute fix says; the first one of a node decides where it begins."""
    position = reading.position_m
    if position is None and reading.wgs84 is not None:
        if state.origin_wgs84 is None:
            text = "a WGS84 fix cannot be fused: the incident has no origin in WGS84"
            state.say("no_origin", reading.t, reading.node, text, once=f"no origin for {reading.node}")
            state.count("not_fused")
            return []
        position = east_north_up(reading.wgs84, state.origin_wgs84)
    node = state.node_of(reading.node, "responder", reading.t)
    if position is None or not _takes(state, node, reading.t, "fix"):
        return []
    sigma = reading.sigma_m or physics.FIX_SIGMA_M
    alike = node.absolute.fixes.with_one(
        reading.t, _way_m(state, node, reading.t), physics.FIX_MEMORY_S, physics.FIX_MEMORY_M
    )
    node = _told(state, node, replace(node.absolute, fixes=alike))
    if node.mode == "undecided":
        node = _told(state, node, replace(node.absolute, beginning="fix", counted_t=reading.t))
        if node.role == "uav":
            # Where he begins nobody knows but by fixes that all are off by the same.
            place(state, node, reading.t, position, (physics.REACH_M,) * 3)
            return []
        place(state, node, reading.t, position, sigma)
        state.count("fused")
        return []
    state.count("fused")
    name = receiver_of(state, node, sigma)
    known = None if name is None else state.receivers[name]
    receiver = None if name is None else Variable("receiver", name)
    t = reading.t if known is None else reading.t - known.late_s
    singles, offset = [], offset_of(state, node, t)
    if node.moving:
        here = state.place(node)
        if receiver is not None:
            here = here + state.graph.value(receiver)[:3]
        off_m = [position[i] - offset[i] - float(here[i]) for i in range(2)]
        node = check_fix(state, node, reading.t, off_m, max(*sigma[:2], physics.SIGMA_FLOOR_M))
    _tell_heights(state, node.node)
    if node.turned:
        # A fix on the arc would seem to be far off its tangent.
        unbend(state, node)
    # Who flies is above what bends the paths of satellites; what all his fixes share is a state.
    shared = 0.0 if node.role in physics.OUTSIDE_ROLES else physics.ABSOLUTE_SHARED
    speed_mps = state.graph.value(node.velocity).tolist() if receiver and node.mode == "free" else [0.0] * 3
    for i in range(3):
        spread = alike.sigma(max(sigma[i], physics.SIGMA_FLOOR_M), shared)
        _enter_single(state, node, t, i, position[i], spread, physics.FIX_NOISE, name)
        if node.turned and i < 2:
            spread = float(np.hypot(spread, turned_m(offset)))
        read_m = position[i] - offset[i]
        singles.append(
            Single(node.position, i, read_m, spread, physics.FIX_NOISE, None, receiver, speed_mps[i])
        )
    return singles


def height(state: FusionState, reading: Altitude | Pressure) -> list[Single]:
    """What a height says, or of an air pressure over the base's own."""
    node = state.nodes.get(reading.node)
    if isinstance(reading, Pressure) and node is not None and node.role == "base":
        place_m = node.place_m or state.base_place()
        state.reference = reading.pressure_pa, place_m[2]
        state.count("fused")
        return []
    node = state.node_of(reading.node, "responder", reading.t)
    if not _takes(state, node, reading.t, "height"):
        return []
    if node.mode == "undecided":
        state.count("not_fused")
        return []
    up, alone_m = _height(state, reading)
    if up is None:
        text = f"the pressure of {node.node} waits for one of the base: there is no reference"
        state.say("not_fused", reading.t, node.node, text, once="no reference pressure")
        state.count("not_fused")
        return []
    alone_m, noise = max(alone_m, physics.SIGMA_FLOOR_M), physics.HEIGHT_NOISE
    sigma = alone_m * (_correlated(node, reading.t) if isinstance(reading, Pressure) else 1.0)
    node = heard_altimeter(state, node, reading.t, up, (sigma, alone_m))
    name = node.absolute.zeroed.name
    if name is None and node.role not in physics.OUTSIDE_ROLES:
        state.count("not_fused")
        return []
    if isinstance(reading, Pressure):
        state.nodes[node.node] = replace(node, pressure_t=reading.t)
    else:
        alike = node.absolute.heights.with_one(reading.t, 0.0, physics.HEIGHT_MEMORY_S)
        _told(state, node, replace(node.absolute, heights=alike))
        sigma = alike.sigma(sigma, physics.ABSOLUTE_SHARED)
    state.count("fused")
    _tell_heights(state, node.node)
    _enter_single(state, node, reading.t, 2, up, sigma, noise, name)
    up -= offset_of(state, node, reading.t)[2]
    altimeter = None if name is None else Variable("altimeter", name)
    return [Single(node.position, 2, up, sigma, noise, altimeter)]


def _way_m(state: FusionState, node: NodeState, t: float) -> float:
    """How far a node has gone by `t`: by its unit, or as fast as it seems to be since its newest fix (m)."""
    known = node.absolute.fixes
    if node.mode != "free" or known.t is None:
        return node.way_m
    return known.way_m + float(np.linalg.norm(state.graph.value(node.velocity))) * abs(t - known.t)


def _told(state: FusionState, node: NodeState, known: Absolute) -> NodeState:
    """The node with what is known of what was told of its place."""
    state.nodes[node.node] = replace(node, absolute=known)
    return state.nodes[node.node]


def _tell_heights(state: FusionState, name: str) -> None:
    if not state.nodes[name].heights:
        state.nodes[name] = replace(state.nodes[name], heights=True)


def _enter_single(
    state: FusionState,
    node: NodeState,
    t: float,
    axis: int,
    value: float,
    sigma: float,
    noise: Mixture,
    read_by: str | None,
) -> None:
    source = -1 if read_by is None else state.source(read_by)
    state.ledger.add("singles", t, node.index, axis, value, sigma, physics.NOISES.index(noise), source)


def _height(state: FusionState, reading: Altitude | Pressure) -> tuple[float | None, float]:
    """A height, and its standard deviation by itself (m); None: no pressure of the base is told."""
    if isinstance(reading, Altitude):
        return reading.up_m, reading.sigma_m or physics.ALTITUDE_SIGMA_M
    if state.reference is None:
        return None, 0.0
    reference_pa, reference_m = state.reference
    above = height_above(reference_pa, reading.pressure_pa)
    sigma = np.hypot(reading.sigma_m or physics.PRESSURE_SIGMA_M, physics.LAYER_SIGMA * above)
    return reference_m + above, float(sigma)


def _correlated(node: NodeState, t: float) -> float:
    """By how much a pressure is noisier than by itself, as those soon after each other share their error.

    Together they may weigh as one per correlation time.
    """
    if node.pressure_t is None:
        return 1.0
    since_s = np.clip(t - node.pressure_t, 0.01, physics.PRESSURE_CORRELATION_S)
    return float(np.sqrt(physics.PRESSURE_CORRELATION_S / since_s))


def _takes(state: FusionState, node: NodeState, t: float, what: str) -> bool:
    if node.mode in ("fixed", "retired"):
        text = f"{node.node} is {node.mode}: its {what} is set aside"
        state.say("conflict", t, node.node, text, once=f"{what} of {node.mode} {node.node}")
        state.count("not_fused")
        return False
    return True
