"""Readings as they are held against the graph: fixes and heights against one node, pairs between two."""

from typing import Literal

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.calibration import bias_sigma_m, scale_sigma
from estimator.fusion.introduce import place
from estimator.fusion.motion import offset_at
from estimator.fusion.nodes import NodeState
from estimator.fusion.noise import Link, link_sigma
from estimator.fusion.rows import End, Linear, Pair
from estimator.fusion.state import FusionState
from estimator.graph.robust import Mixture
from estimator.graph.variable import Variable
from estimator.measurements.altitude import Altitude, Pressure, height_above
from estimator.measurements.bearing import Bearing
from estimator.measurements.position import Position, east_north_up
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi

SENT = "sent"
"""Owner of the path-loss states of radios that tell the power they send with; "" for those that do not."""


def fix(state: FusionState, reading: Position) -> list[Linear]:
    """Rows of an absolute fix; the first one of a node decides where it begins."""
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
    if node.mode == "undecided":
        place(state, node, reading.t, position, sigma)
        state.count("fused")
        return []
    offset = offset_at(state, node, reading.t)
    floor = physics.SIGMA_FLOOR_M
    state.count("fused")
    for i in range(3):
        _enter_single(state, node, reading.t, i, position[i], max(sigma[i], floor), physics.FIX_NOISE)
    return [
        Linear(node.position, i, position[i] - float(offset[i]), max(sigma[i], floor), physics.FIX_NOISE)
        for i in range(3)
    ]


def height(state: FusionState, reading: Altitude | Pressure) -> list[Linear]:
    """The row of a height, or of an air pressure over the base's own."""
    node = state.nodes.get(reading.node)
    if isinstance(reading, Pressure) and node is not None and node.role == "base":
        state.reference_pa = reading.pressure_pa
        state.count("fused")
        return []
    node = state.node_of(reading.node, "responder", reading.t)
    if not _takes(state, node, reading.t, "height"):
        return []
    if node.mode == "undecided":
        state.count("not_fused")
        return []
    up, sigma = _height(state, node, reading)
    if up is None:
        text = f"the pressure of {node.node} waits for one of the base: there is no reference"
        state.say("not_fused", reading.t, node.node, text, once="no reference pressure")
        state.count("not_fused")
        return []
    if isinstance(reading, Pressure):
        state.nodes[node.node] = replace(node, pressure_t=reading.t)
    state.count("fused")
    _enter_single(state, node, reading.t, 2, up, max(sigma, physics.SIGMA_FLOOR_M), physics.HEIGHT_NOISE)
    up -= float(offset_at(state, node, reading.t)[2])
    return [Linear(node.position, 2, up, max(sigma, physics.SIGMA_FLOOR_M), physics.HEIGHT_NOISE)]


def _enter_single(
    state: FusionState, node: NodeState, t: float, axis: int, value: float, sigma: float, noise: Mixture
) -> None:
    state.ledger.add("singles", t, node.index, axis, value, sigma, physics.NOISES.index(noise))


def _height(state: FusionState, node: NodeState, reading: Altitude | Pressure) -> tuple[float | None, float]:
    if isinstance(reading, Altitude):
        return reading.up_m, reading.sigma_m or physics.ALTITUDE_SIGMA_M
    if state.reference_pa is None:
        return None, 0.0
    above = height_above(state.reference_pa, reading.pressure_pa)
    sigma = np.hypot(reading.sigma_m or physics.PRESSURE_SIGMA_M, physics.LAYER_SIGMA * above)
    if node.pressure_t is not None:
        # Pressures soon after each other share their error: together they may weigh as one per correlation
        # time.
        since = np.clip(reading.t - node.pressure_t, 0.01, physics.PRESSURE_CORRELATION_S)
        sigma *= np.sqrt(physics.PRESSURE_CORRELATION_S / since)
    return state.base_place()[2] + above, float(sigma)


def _takes(state: FusionState, node: NodeState, t: float, what: str) -> bool:
    if node.mode in ("fixed", "retired"):
        text = f"{node.node} is {node.mode}: its {what} is set aside"
        state.say("conflict", t, node.node, text, once=f"{what} of {node.mode} {node.node}")
        state.count("not_fused")
        return False
    return True


def end_of(state: FusionState, node: NodeState, t: float) -> End:
    """A decided node as one end of a reading at `t`."""
    if node.mode == "fixed" and node.place_m is not None:
        return End(None, node.place_m)
    east, north, up = offset_at(state, node, t).tolist()
    return End(node.position, (east, north, up))


def pair(state: FusionState, a: NodeState, b: NodeState, reading: Range | Rssi | Bearing) -> Pair | None:
    """A reading between two decided nodes; None where a bearing has nothing to be counted from."""
    ends = end_of(state, a, reading.t), end_of(state, b, reading.t)
    if isinstance(reading, Bearing):
        extra, heading = None, 0.0
        if reading.frame == "body":
            extra = a.unit if a.mode == "unit" else None
            known = a.unit_heading_rad if a.mode == "unit" else a.heading_rad
            if known is None or a.mode == "free":
                text = f"{a.node} has no heading: its bearings in the body frame are set aside"
                state.say("not_fused", reading.t, a.node, text, once=f"bearing from {a.node}")
                state.count("not_fused")
                return None
            heading = known
        sigma = max(reading.sigma_rad or physics.BEARING_SIGMA_RAD, physics.HEADING_FLOOR_RAD)
        noise = physics.BEARING_NOISE
        frame = 3.0 if reading.frame == "body" else 2.0
        row = (a.index, b.index, reading.bearing_rad, sigma, state.source(""), heading, 1.0, -1.0)
        state.ledger.add("pairs", reading.t, frame, *row)
        return Pair("bearing", *ends, extra, reading.bearing_rad, sigma, noise, "", sigma, "", heading)
    value, sigma, technology, sent = measured(reading)
    kind: Literal["range", "rssi"] = "range" if isinstance(reading, Range) else "rssi"
    made = pair_of(state, kind, ends, value, sigma, technology)
    link, name = enter(state, a, b, reading)
    sigma = link_sigma(state.learned(made.source), sigma, link.alike)
    return made._replace(sigma=sigma, link=name, constant=sent)


def enter(state: FusionState, a: NodeState, b: NodeState, reading: Range | Rssi) -> tuple[Link, str]:
    """Enter a range or RSSI into the ledger, and follow its link."""
    value, sigma, technology, sent = measured(reading)
    ranged = isinstance(reading, Range)
    source = technology if ranged else f"rssi {technology}"
    key = f"{source} {min(a.node, b.node)} {max(a.node, b.node)}"
    before, way = state.links.get(key), _way_m(a, reading.t) + _way_m(b, reading.t)
    number = len(state.links) if before is None else before.number
    link = Link(reading.t, way, number) if before is None else before.next(reading.t, way)
    state.links[key] = link
    if ranged and "unit" in (a.mode, b.mode):
        state.uncalibrated.setdefault(source, physics.UNCALIBRATED)
    row = (
        0.0 if ranged else 1.0,
        a.index,
        b.index,
        value,
        sigma,
        state.source(source),
        sent,
        link.alike,
        number,
    )
    state.ledger.add("pairs", reading.t, *row)
    return link, key


def _way_m(node: NodeState, t: float) -> float:
    """How far a node has walked by `t`, for what its readings have in common.

    Without PDR the way is what the readings themselves tell: were they trusted less where it stands still, it
    would seem to stand still ever after. So it is thought to walk slowly all the time.
    """
    return node.way_m if node.mode != "free" else physics.FREE_WAY_MPS * t


def pair_of(
    state: FusionState,
    kind: Literal["range", "rssi"],
    ends: tuple[End, End],
    value: float,
    sigma: float,
    technology: str,
) -> Pair:
    """A range or RSSI between two ends, with its technology's states in the graph and its learned noise."""
    source = technology if kind == "range" else f"rssi {technology}"
    states = technology_states(state, technology) if kind == "range" else path_loss_states(state, technology)
    noise = physics.RANGE_NOISE if kind == "range" else physics.RSSI_NOISE
    known = state.learned(source)
    noise = noise._replace(outliers=known.outliers(noise.outliers))
    return Pair(
        kind, *ends, states, value, max(sigma * known.factor, physics.SIGMA_FLOOR_M), noise, source, sigma
    )


def measured(reading: Range | Rssi) -> tuple[float, float, str, float]:
    """Value, claimed or assumed sigma, owner of the technology's states, and sent power of a reading."""
    if isinstance(reading, Range):
        technology = reading.technology or "unnamed"
        sigma = reading.sigma_m or physics.RANGE_SIGMA_M.get(technology, physics.RANGE_SIGMA_OTHER_M)
        return reading.range_m, max(sigma, physics.SIGMA_FLOOR_M), technology, 0.0
    if reading.tx_dbm is None:
        return reading.dbm, physics.RSSI_SIGMA_DB, "", 0.0
    return reading.dbm, physics.RSSI_SIGMA_DB, SENT, reading.tx_dbm


def technology_states(state: FusionState, technology: str) -> Variable:
    """The block of scale and bias of a ranging technology, added when first used."""
    states = Variable("range", technology)
    if states not in state.graph:
        scale = scale_sigma(state.uncalibrated.get(technology, 0.0))
        state.graph.add_node(states, (0.0, 0.0), (scale, bias_sigma_m(technology)))
    return states


def path_loss_states(state: FusionState, owner: str) -> Variable:
    """The block of P0 and n, added when first used."""
    states = Variable("rssi", owner)
    if states not in state.graph:
        state.graph.add_node(
            states,
            (physics.RSSI_POWER_DBM, physics.RSSI_EXPONENT),
            (physics.RSSI_POWER_SIGMA_DB, physics.RSSI_EXPONENT_SIGMA),
        )
    return states
