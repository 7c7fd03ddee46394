"""Readings as they are held against the graph: fixes and heights against one node, pairs between two."""

import math
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.calibration import bias_sigma_m, narrow_sigma, scale_sigma
from estimator.fusion.introduce import place
from estimator.fusion.ledger import BEARING, BODY_BEARING, RANGE, RSSI
from estimator.fusion.nodes import NodeState
from estimator.fusion.noise import Link, link_sigma
from estimator.fusion.rows import Row, Single
from estimator.fusion.state import FusionState
from estimator.fusion.way import Way
from estimator.graph.robust import Mixture
from estimator.graph.variable import Variable
from estimator.measurements.altitude import Altitude, Pressure, height_above
from estimator.measurements.bearing import Bearing
from estimator.measurements.position import Position, east_north_up
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi

SENT = "sent"
"""Owner of the path-loss states of radios that tell the power they send with; "" for those that do not."""


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
    if node.mode == "undecided":
        place(state, node, reading.t, position, sigma)
        state.count("fused")
        return []
    state.count("fused")
    singles, offset = [], Way(state, node).offset(reading.t)
    for i in range(3):
        spread = max(sigma[i], physics.SIGMA_FLOOR_M)
        _enter_single(state, node, reading.t, i, position[i], spread, physics.FIX_NOISE)
        singles.append(Single(node.position, i, position[i] - offset[i], spread, physics.FIX_NOISE))
    return singles


def height(state: FusionState, reading: Altitude | Pressure) -> list[Single]:
    """What a height says, or of an air pressure over the base's own."""
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
    sigma, noise = max(sigma, physics.SIGMA_FLOOR_M), physics.HEIGHT_NOISE
    _enter_single(state, node, reading.t, 2, up, sigma, noise)
    up -= Way(state, node).offset(reading.t)[2]
    return [Single(node.position, 2, up, sigma, noise)]


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


class Told(NamedTuple):
    """What a range or RSSI says.

    Attributes:
        kind: `RANGE` or `RSSI`.
        value: range (m) or power (dBm).
        sigma: claimed or assumed standard deviation.
        source: the technology that its noise is learned for.
        owner: owner of that technology's states.
        sent: power that was sent (dBm); 0 for ranges, and where it is not told.
    """

    kind: int
    value: float
    sigma: float
    source: str
    owner: str
    sent: float


class Technology(NamedTuple):
    """What is known of a technology in this tick.

    Attributes:
        start: first row of its states.
        number: its number in the ledger.
        noise: how its readings scatter.
        factor: learned standard deviation over the claimed or assumed one.
        shared: share of the variance that successive readings on one link have in common.
    """

    start: int
    number: int
    noise: Mixture
    factor: float
    shared: float


class Pairs:
    """The readings between two nodes that are held against the graph together.

    Nothing may change the nodes' places or the learned noise meanwhile.

    Attributes:
        rows: of those between decided nodes.
        links: key of each link among them.
    """

    def __init__(self, state: FusionState) -> None:
        self._state = state
        self.rows: list[Row] = []
        self.links: dict[str, int] = {}
        self._ways: dict[str, Way] = {}
        self._technologies: dict[str, Technology] = {}

    def take(self, a: NodeState, b: NodeState, reading: Range | Rssi | Bearing) -> None:
        """Hold a reading between two decided nodes, and enter it into the ledger."""
        made = self._bearing(a, b, reading) if isinstance(reading, Bearing) else self._radio(a, b, reading)
        if made is not None:
            self.rows.append(made)
            self._state.counts["fused"] += 1

    def _radio(self, a: NodeState, b: NodeState, reading: Range | Rssi) -> Row:
        told = told_by(reading)
        known = self._technologies.get(told.source) or self._technology(told)
        link, key = enter(self._state, a, b, reading.t, told)
        from_a, from_b = self._way(a), self._way(b)
        at_a, at_b = from_a.offset(reading.t), from_b.offset(reading.t)
        sigma = link_sigma(known.factor, known.shared, told.sigma, link.alike)
        through = abs(from_a.up_m + at_a[2] - from_b.up_m - at_b[2]) > physics.FLOOR_M
        if through and not physics.OUTSIDE_ROLES & {a.role, b.role}:
            # It tells nothing of what its technology is like where no floor is between.
            sigma = math.hypot(sigma, physics.FLOOR_SIGMA[told.kind == RSSI])
            number = line = -1
        else:
            number, line = known.number, self.links.setdefault(key, len(self.links))
        return Row(
            told.kind,
            from_a.start,
            told.value,
            sigma,
            *known.noise,
            told.sigma,
            from_b.start,
            known.start,
            told.sent,
            number,
            line,
            *at_a,
            *at_b,
        )

    def _bearing(self, a: NodeState, b: NodeState, reading: Bearing) -> Row | None:
        state, extra, heading = self._state, -1, 0.0
        if reading.frame == "body":
            known = a.unit_heading_rad if a.mode == "unit" else a.heading_rad
            if known is None or a.mode == "free":
                text = f"{a.node} has no heading: its bearings in the body frame are set aside"
                state.say("not_fused", reading.t, a.node, text, once=f"bearing from {a.node}")
                state.count("not_fused")
                return None
            extra, heading = state.graph.starts[a.unit] if a.mode == "unit" else -1, known
        sigma = max(reading.sigma_rad or physics.BEARING_SIGMA_RAD, physics.HEADING_FLOOR_RAD)
        frame = BODY_BEARING if reading.frame == "body" else BEARING
        row = (a.index, b.index, reading.bearing_rad, sigma, state.source(""), heading, 1.0, -1.0)
        state.ledger.add("pairs", reading.t, frame, *row)
        from_a, from_b, t = self._way(a), self._way(b), reading.t
        told = (reading.bearing_rad, sigma, *physics.BEARING_NOISE, sigma)
        at = (*from_a.offset(t), *from_b.offset(t))
        return Row(BEARING, from_a.start, *told, from_b.start, extra, heading, -1, -1, *at)

    def _way(self, node: NodeState) -> Way:
        found = self._ways.get(node.node)
        if found is None:
            found = self._ways[node.node] = Way(self._state, node)
        return found

    def _technology(self, told: Told) -> Technology:
        state, ranged = self._state, told.kind == RANGE
        states = technology_states(state, told.owner) if ranged else path_loss_states(state, told.owner)
        learned, usual = state.learned(told.source), physics.RANGE_NOISE if ranged else physics.RSSI_NOISE
        found = self._technologies[told.source] = Technology(
            state.graph.starts[states],
            state.source(told.source),
            usual._replace(outliers=learned.outliers(usual.outliers)),
            learned.factor,
            learned.shared,
        )
        return found


def enter(state: FusionState, a: NodeState, b: NodeState, t: float, told: Told) -> tuple[Link, str]:
    """Enter a range or RSSI between two nodes at `t` into the ledger, and follow its link."""
    key = f"{told.source} {a.node} {b.node}" if a.node < b.node else f"{told.source} {b.node} {a.node}"
    links, way = state.links, _way_m(a, t) + _way_m(b, t)
    before = links.get(key)
    link = links[key] = Link(t, way, len(links)) if before is None else before.next(t, way)
    if told.kind == RANGE and "unit" in (a.mode, b.mode):
        state.uncalibrated.setdefault(told.source, physics.UNCALIBRATED)
    row = (told.value, told.sigma, state.source(told.source), told.sent, link.alike, link.number)
    state.ledger.add("pairs", t, told.kind, a.index, b.index, *row)
    return link, key


def _way_m(node: NodeState, t: float) -> float:
    """How far a node has walked by `t`, for what its readings have in common.

    Without PDR the way is what the readings themselves tell: were they trusted less where it stands still, it
    would seem to stand still ever after. So it is thought to walk slowly all the time.
    """
    return node.way_m if node.mode != "free" else physics.FREE_WAY_MPS * t


def told_by(reading: Range | Rssi) -> Told:
    """What a range or RSSI says."""
    if isinstance(reading, Range):
        technology = reading.technology or "unnamed"
        sigma = reading.sigma_m or physics.RANGE_SIGMA_M.get(technology, physics.RANGE_SIGMA_OTHER_M)
        return Told(RANGE, reading.range_m, max(sigma, physics.SIGMA_FLOOR_M), technology, technology, 0.0)
    if reading.tx_dbm is None:
        return Told(RSSI, reading.dbm, physics.RSSI_SIGMA_DB, "rssi ", "", 0.0)
    return Told(RSSI, reading.dbm, physics.RSSI_SIGMA_DB, f"rssi {SENT}", SENT, reading.tx_dbm)


def technology_states(state: FusionState, technology: str) -> Variable:
    """The block of scale and bias of a ranging technology, added when first used."""
    states = Variable("range", technology)
    if states not in state.graph:
        scale = scale_sigma(state.uncalibrated.get(technology, 0.0), narrow_sigma(state.outliers(technology)))
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
