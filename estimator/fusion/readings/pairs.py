"""Readings between two nodes as they are held against the graph, all those of a tick together."""

from collections.abc import Sequence

import numpy as np

from estimator.fusion import physics
from estimator.fusion.entering.technologies import (
    REACH,
    TOLD_POWER,
    path_loss_states,
    technology_states,
)
from estimator.fusion.learned import reach
from estimator.fusion.learned.calibration import Calibration
from estimator.fusion.learned.delays import source_of
from estimator.fusion.memory.hearing import Crossing
from estimator.fusion.memory.ledger import BEARING, BODY_BEARING, RANGE, RSSI, UNTOLD_POWER
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.long_displacements import STRAIGHT_S
from estimator.fusion.motion.recent_places import Mark, TrailEnd, end_of, table_of_marks
from estimator.fusion.motion.silence import SILENT_S
from estimator.fusion.readings.between_reports import widen
from estimator.fusion.readings.impossible_ranges import is_impossible
from estimator.fusion.readings.pair_rows import PAIR, Technology, pair_rows
from estimator.fusion.readings.repeated_ranges import is_repeated
from estimator.fusion.rows.rows import FIELDS, table_from
from estimator.graph.dense import Array
from estimator.measurements.bearing import Bearing
from estimator.measurements.node import MOVING_ROLES
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi

NO_ROWS: Array = np.empty((0, FIELDS))
NO_EPOCHS: Array = np.zeros(0)
AnyPair = Range | Rssi | Bearing | Crossing


Named = tuple[NodeState, int, bool, bool]
"""A node that a reading names; its row among the ends of the tick's readings; whether readings can be held
against its position; whether that is known exactly."""


class Pairs:
    """The readings between two nodes of a tick; what is the same for many of them is looked up once.

    Nothing else may change the nodes' places or the learned noise meanwhile.

    Attributes:
        fused_t: epoch of the newest reading that is held against each node's place (s).
        epochs: of the rows that were made (s).
    """

    def __init__(self, state: FusionState) -> None:
        self._state = state
        self._told: list[float] = []
        self._named: dict[str, Named] = {}
        self._ends: list[TrailEnd] = []
        self._marks: list[Mark] = []
        self._technologies: list[Technology] = []
        self._held: dict[str, int] = {}
        self._sighted: dict[str, int] = {}
        self._known: Array | None = None
        self.fused_t: dict[str, float] = {}
        self.epochs = NO_EPOCHS

    def take(self, readings: Sequence[AnyPair]) -> None:
        """Take readings in, in order of epoch."""
        state, named, told = self._state, self._named, self._told
        links, held, fused, fused_t = state.links, self._held, 0, self.fused_t
        for reading in readings:
            # By its type it is told far sooner that a reading is not of a kind than by `isinstance`.
            t, name_a, name_b = reading.t, reading.a, reading.b
            a, row_a, decided_a, fixed_a = named.get(name_a) or self._name(name_a, t)
            b, row_b, decided_b, fixed_b = named.get(name_b) or self._name(name_b, t)
            if type(reading) is Range and is_impossible(state, reading, a, b, self._covariance):
                state.count("not_fused")
                continue
            between, crossing = decided_a and decided_b, False
            if not between and not self._sights(a, b, reading):
                continue
            if fixed_a and fixed_b and between:
                state.count("not_fused")
                continue
            numbers, constant = held if between else self._sighted, 0.0
            if type(reading) is Rssi:
                kind, source, value, sigma = RSSI, UNTOLD_POWER, reading.dbm, physics.RSSI_SIGMA_DB
                if reading.tx_dbm is not None:
                    source, constant = TOLD_POWER, reading.tx_dbm
            elif type(reading) is Crossing:
                kind, source, value, sigma, crossing = RSSI, REACH, 0.0, reach.NOMINAL_DB, True
            elif type(reading) is Range:
                kind, source, value = RANGE, reading.technology or "unnamed", reading.range_m
                usual = physics.RANGE_SIGMA_M.get(source, physics.RANGE_SIGMA_OTHER_M)
                sigma = max(reading.sigma_m or usual, physics.SIGMA_FLOOR_M)
                if state.delayed:
                    source = source_of(source, name_a, name_b, state.delayed)
            else:
                if type(reading) is Bearing and self._bear(a, row_a, row_b, reading):
                    fused += 1
                    fused_t[name_a] = fused_t[name_b] = t
                continue
            if kind == RANGE and source not in state.calibrations and "unit" in (a.mode, b.mode):
                state.calibrations[source] = Calibration()
            technology = numbers.get(source)
            if technology is None:
                technology = self._technology(kind, source, between)
            link = links.numbers.get(
                (source, name_a, name_b) if name_a < name_b else (source, name_b, name_a)
            )
            if link is None:
                link = links.number(source, name_a, name_b)
            if kind == RANGE and is_repeated(links, link, t, value, a, b):
                state.count("not_fused")
                continue
            told += (t, value, sigma, constant, technology, link, row_a, row_b)
            if between and not crossing:
                fused += 1
                fused_t[name_a] = fused_t[name_b] = t
        state.count("fused", fused)

    def enter(self) -> Array:
        """Enter what was taken into the ledger.

        Returns:
            Rows of the readings between decided nodes, m × `FIELDS`; see `rows.Row`.
        """
        if not self._told:
            return NO_ROWS
        state = self._state
        made = pair_rows(
            np.fromiter(self._told, np.float64, len(self._told)).reshape(-1, PAIR),
            table_from(self._technologies, len(Technology._fields)),
            table_from(self._ends, len(TrailEnd._fields)),
            table_of_marks(self._marks),
            state.links.table,
            state.graph.reference,
        )
        state.ledger.extend("pairs", made.entered)
        self.epochs = made.epochs
        named = zip(self._ends, self._named.values(), strict=True)
        ends = [(end.start, node) for end, (node, *_) in named if node.report_s > STRAIGHT_S]
        if ends:
            widen(made.table, made.epochs, state.graph.reference, ends)
        return made.table

    def _covariance(self) -> Array:
        """Of all places, once for all ranges of the tick that are too long: a gateway may send many such."""
        if self._known is None:
            self._known = self._state.graph.covariance()
        return self._known

    def _name(self, name: str, t: float) -> Named:
        node = self._state.node_of(name, "breadcrumb", t)
        end = end_of(self._state, node, self._marks)
        found = self._named[name] = node, len(self._ends), end.decided, node.mode == "fixed"
        self._ends.append(end)
        return found

    def _sights(self, a: NodeState, b: NodeState, reading: AnyPair) -> bool:
        """Whether a reading tells where an undecided node is; if so, it is counted for it."""
        state = self._state
        if isinstance(reading, Crossing):
            return False
        if "retired" in (a.mode, b.mode):
            node, other = (a, b) if a.mode == "retired" else (b, a)
            text = f"{node.node} is retired: what {other.node} measures to it is set aside"
            state.say("conflict", reading.t, node.node, text, once=f"pair with retired {node.node}")
            state.count("not_fused")
            return False
        undecided, other = (b, a) if a.decided else (a, b)
        moving = other.moving and undecided.role in MOVING_ROLES
        if not other.decided or isinstance(reading, Bearing) or moving:
            state.count("not_fused")
            return False
        state.sightings[undecided.node] = state.sightings.get(undecided.node, 0) + 1
        return True

    def _technology(self, kind: int, source: str, between: bool) -> int:
        state, start = self._state, -1
        usual = physics.NOISES[kind]
        if between:
            states = technology_states(state, source) if kind == RANGE else path_loss_states(state, source)
            start = state.graph.starts[states]
        known = Technology(
            kind,
            state.source(source),
            start,
            *state.learned(source).terms(usual.outliers),
            usual.shift,
            usual.spread,
        )
        numbers = self._held if between else self._sighted
        numbers[source] = len(self._technologies)
        self._technologies.append(known)
        return numbers[source]

    def _bear(self, node: NodeState, row_a: int, row_b: int, reading: Bearing) -> bool:
        """Take a bearing of a decided node in, unless nobody knows what it is counted from."""
        state, kind, heading = self._state, BEARING, 0.0
        if reading.frame == "body":
            known = node.unit_heading_rad if node.mode == "unit" else node.heading_rad
            silent = node.mode == "unit" and reading.t > (node.unit_t or node.pose_t) + SILENT_S
            if known is None or node.mode == "free" or silent:
                # Since a unit fell silent its bearer may have turned.
                text = f"{node.node} has no heading now: its bearings in the body frame are set aside"
                state.say("not_fused", reading.t, node.node, text, once=f"bearing from {node.node}")
                state.count("not_fused")
                return False
            kind, heading = BODY_BEARING, known
        sigma = max(reading.sigma_rad or physics.BEARING_SIGMA_RAD, physics.HEADING_FLOOR_RAD)
        technology = self._held.setdefault(f"bearing {reading.frame}", len(self._technologies))
        if technology == len(self._technologies):
            known_of = Technology(kind, state.source(""), -1, 1.0, 0.0, *physics.BEARING_NOISE)
            self._technologies.append(known_of)
        told = (reading.t, reading.bearing_rad, sigma, heading)
        self._told += (*told, technology, -1, row_a, row_b)
        return True
