"""Paper A's system as written: a Kirchhoff matrix of positions, PDR displacements and ranges from RSSI.

Nothing is added to it: no heading, bias, scale or path loss is a state, no noise is robust, nothing is
linearised again, and its covariance is L⁻¹ as it stands (eq. 5). The parts are in `estimator.paper_a`.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Self

import msgspec

from estimator.estimate import NodeEstimate, Notice, Relative
from estimator.graph.dense import Array
from estimator.graph.record import ArrayRecord, pack, unpack
from estimator.graph.variable import Variable
from estimator.inertial.record import NavigationRecord, navigation_of, record_of
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.bearing import Bearing
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.imu import Imu
from estimator.measurements.node import Node
from estimator.measurements.position import Position, east_north_up
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.rssi import Rssi
from estimator.measurements.status import Alarm, Status
from estimator.paper_a import edges, lifecycle
from estimator.paper_a.network import Network
from estimator.paper_a.node import GraphNode
from estimator.paper_a.state import PaperAState
from estimator.trackers.base import TrackerSettings
from estimator.trackers.snapshot import read_snapshot

VERSION = 9
ORDER: dict[type, int] = {
    Node: 0,
    Displacement: 1,
    Imu: 1,
    Position: 2,
    Drop: 3,
    Range: 4,
    Rssi: 4,
    Retire: 6,
}
"""Of one epoch, first who is there and where it went, then what was measured there."""

_encode = msgspec.msgpack.Encoder().encode


class _Snapshot(msgspec.Struct, frozen=True, array_like=True):
    version: int
    settings: TrackerSettings
    vertices: list[Variable]
    storage: tuple[ArrayRecord, ArrayRecord, ArrayRecord]
    nodes: list[GraphNode]
    counts: dict[str, int]
    notices: list[Notice]
    said: list[str]
    navigations: dict[str, NavigationRecord]


class PaperATracker:
    """Folds readings into paper A's network; see `estimator.trackers.base.Tracker`.

    The paper has no lag: a state is deleted as soon as its successor is there. Readings of one batch are put
    in order; one that comes after its node has moved on is counted as too late.
    """

    def __init__(self, settings: TrackerSettings | None = None) -> None:
        self.settings = settings or TrackerSettings()
        self._state = PaperAState()
        self._covariance: Array | None = None

    def fold(
        self,
        readings: Sequence[AnyReading],
        known_t: float = math.inf,  # noqa: ARG002 - what is late goes by each node's own state
    ) -> None:
        """Fold readings, those of one call in order of their epochs."""
        self._covariance = None
        for reading in sorted(readings, key=lambda r: (r.until_t, ORDER.get(type(r), 5), _encode(r))):
            self._state.counts["received"] += 1
            self._take(reading)

    def _take(self, reading: AnyReading) -> None:
        state = self._state
        match reading:
            case Node():
                lifecycle.introduce(state, reading)
            case Displacement():
                lifecycle.displace(state, reading)
            case Drop():
                lifecycle.drop(state, reading)
            case Range() | Rssi():
                edges.pair(state, reading)
            case Position():
                self._fix(reading)
            case Retire():
                lifecycle.retire(state, reading)
            case Status() | Alarm():
                state.counts["not_fused"] += 1
            case Imu():
                lifecycle.navigate_boot(state, reading)
            case Bearing() | Altitude() | Pressure():
                name = reading.a if isinstance(reading, Bearing) else reading.node
                state.node_of(name, "responder", reading.t)
                text = f"paper A's system has no place for {type(reading).__name__.lower()} readings"
                state.refuse("not_fused", reading.t, name, text)

    def _fix(self, reading: Position) -> None:
        place_m, origin = reading.position_m, self.settings.origin_wgs84
        if reading.wgs84 is not None and origin is not None:
            place_m = east_north_up(reading.wgs84, origin)
        if place_m is None:
            self._state.node_of(reading.node, "responder", reading.t)
            text = "the incident has no WGS84 origin: fixes in WGS84 cannot be fused"
            self._state.refuse("no_origin", reading.t, reading.node, text)
            return
        edges.fix(self._state, reading, place_m)

    def _sigma(self) -> Array:
        """Σ of all vertices, n × n (m²)."""
        if self._covariance is None:
            self._covariance = self._state.network.covariance()
        return self._covariance

    def estimates(self) -> list[NodeEstimate]:
        """Every node ever introduced, in order of introduction."""
        return self._state.estimates(self._sigma())

    def relative(self, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a`, from their joint covariance; None where either is undecided.

        Raises:
            KeyError: a node is not known.
        """
        return self._state.relative(self._sigma(), a, b)

    def settle(self) -> bool:
        """Nothing is ever left to be done."""
        return False

    def settled(self) -> None:
        """Nothing is ever folded in a hurry."""
        return

    def take_notices(self) -> list[Notice]:
        """What was noticed since the last call."""
        taken, self._state.notices = self._state.notices, []
        return taken

    def counts(self) -> Mapping[str, int]:
        """How many readings were received, fused, not fused, dropped as outliers, and too late."""
        return dict(self._state.counts)

    def snapshot(self) -> bytes:
        """The whole state, exact to the last bit."""
        state = self._state
        matrix, vector, reference = state.network.graph.storage()
        return _encode(
            _Snapshot(
                VERSION,
                self.settings,
                list(state.network.graph.starts),
                (pack(matrix), pack(vector), pack(reference)),
                list(state.nodes.values()),
                state.counts,
                state.notices,
                list(state.said),
                {name: record_of(known) for name, known in state.navigations.items()},
            )
        )

    @classmethod
    def restore(cls, state: bytes) -> Self:
        """A tracker that goes on where `snapshot` was taken.

        Raises:
            ValueError: `state` was written by another version, or is no snapshot.
        """
        snapshot = read_snapshot(state, _Snapshot, VERSION)
        tracker = cls(snapshot.settings)
        matrix, vector, reference = (unpack(record) for record in snapshot.storage)
        restored = tracker._state
        restored.network = Network.of(snapshot.vertices, (matrix, vector, reference))
        restored.nodes = {node.node: node for node in snapshot.nodes}
        restored.counts, restored.notices = snapshot.counts, snapshot.notices
        restored.said = dict.fromkeys(snapshot.said)
        restored.navigations = {n: navigation_of(known) for n, known in snapshot.navigations.items()}
        return tracker
