"""What is shown but not fused: names, crews, vitals, alarms, notices. A pure fold over readings."""

import math
from collections.abc import Iterable, Sequence

import msgspec

from backend.live.record import PictureRecord, RecordAlarm, RecordAside, RecordNode, RecordNotice
from backend.log.base import LoggedBatch
from backend.tracking import gateway_clocks
from backend.tracking.alarms import AlarmEntry
from backend.tracking.gateway_clocks import GatewayClock
from backend.tracking.set_aside import after_batch
from estimator.estimate import NodeEstimate, Notice
from estimator.fusion.holding import names_of
from estimator.measurements import Alarm, AnyReading, Node, Retire, Status
from estimator.measurements.status import AlarmKind

NOTICES_KEPT = 32

ANOTHER_CYLINDER_BAR = 20.0
"""Pressure that rises by more is that of another cylinder: warming and noise make a few bar."""


class NodeBoard(msgspec.Struct):
    """What a node has told of itself.

    Attributes:
        t: epoch of its newest status or alarm, Unix seconds.
        callsign: how it is called by radio.
        crew: its crew.
        battery: charge, 0 to 1.
        air_bar: pressure left in the air cylinder (bar).
        temperature_c: temperature (°C).
        motionless_s: for how long it has not moved (s).
        status_t: epoch of the newest status, Unix seconds.
        told_t: epoch of the newest status that told each of the four, at most when that came, Unix seconds.
        air_first_bar: the highest pressure that the cylinder in use was reported with (bar).
        air_least_bar: the lowest one (bar).
        moved_t: when it was last noticed to have been moved, Unix seconds.
    """

    t: float
    callsign: str | None = None
    crew: str | None = None
    battery: float | None = None
    air_bar: float | None = None
    temperature_c: float | None = None
    motionless_s: float | None = None
    status_t: float | None = None
    moved_t: float | None = None
    told_t: dict[str, float] = msgspec.field(default_factory=dict)
    air_first_bar: float | None = None
    air_least_bar: float | None = None

    def breathes(self, air_bar: float) -> None:
        """Note a reported pressure (bar), which belongs to the cylinder in use or begins another."""
        first, least = self.air_first_bar, self.air_least_bar
        begins = self.air_bar is None or air_bar > self.air_bar + ANOTHER_CYLINDER_BAR
        self.air_first_bar = air_bar if begins or first is None else max(air_bar, first)
        self.air_least_bar = air_bar if begins or least is None else min(air_bar, least)


class Board(msgspec.Struct):
    """Everything that is shown but not fused, of one incident.

    Attributes:
        nodes: what each node has told of itself.
        alarms: alarms of each node, by kind.
        notices: the newest notice of each code and node, oldest first.
        came_t: when those were heard of last of whom readings told before their time, Unix seconds.
        retired: when each node was last retired, Unix seconds, and why, where that was said.
        aside: who was heard without a reading that can be used since, by name.
        clocks: how late each gateway's batches come, by gateway.
    """

    nodes: dict[str, NodeBoard] = msgspec.field(default_factory=dict)
    alarms: dict[str, dict[AlarmKind, AlarmEntry]] = msgspec.field(default_factory=dict)
    notices: list[RecordNotice] = msgspec.field(default_factory=list)
    came_t: dict[str, float] = msgspec.field(default_factory=dict)
    retired: dict[str, tuple[float, str | None]] = msgspec.field(default_factory=dict)
    aside: dict[str, RecordAside] = msgspec.field(default_factory=dict)
    clocks: dict[str, GatewayClock] = msgspec.field(default_factory=dict)

    def fold(self, readings: Iterable[AnyReading], known_t: float = math.inf) -> None:
        """Take readings in, in their order.

        Args:
            readings: they are.
            known_t: when they came, where the incident goes by the server's clock, Unix seconds.
        """
        for reading in readings:
            if reading.until_t > known_t or self.came_t:
                self._came(reading, known_t)
            if self.aside:
                for name in names_of(reading):
                    self.aside.pop(name, None)
            match reading:
                case Status():
                    self._told(reading, known_t)
                case Alarm():
                    self._alarmed(reading)
                case Node():
                    self._named(reading)
                case Retire():
                    self._retired(reading)

    def set_aside(self, batch: LoggedBatch, came_t: float, readings: Sequence[AnyReading]) -> None:
        """Note whose readings a batch holds that were set aside.

        Args:
            batch: it is.
            came_t: when it came, by the incident's clock, Unix seconds.
            readings: those of its readings that can be used.
        """
        usable = {name for reading in readings for name in names_of(reading)}
        self.aside = after_batch(self.aside, batch, came_t, usable)

    def hear_clock(self, batch: LoggedBatch, readings: Sequence[AnyReading], came_t: float) -> None:
        """Note how late a batch of an incident that goes by the server's clock has come."""
        self.clocks = gateway_clocks.after_batch(self.clocks, batch, readings, came_t)

    def _came(self, reading: AnyReading, known_t: float) -> None:
        """Note when a node whose clock is ahead was heard of."""
        for name in names_of(reading):
            if reading.until_t > known_t or name in self.came_t:
                heard_t = min(reading.until_t, known_t)
                self.came_t[name] = max(heard_t, self.came_t.get(name, heard_t))

    def notice(self, notices: Iterable[Notice]) -> None:
        """Take in what the tracker has noticed; a notice replaces the last of its code and node."""
        for notice in notices:
            self.tell(RecordNotice(code=notice.code, t=notice.t, text=notice.text, node=notice.node))
            if notice.code == "node_moved" and notice.node is not None:
                self._node(notice.node, notice.t).moved_t = notice.t

    def tell(self, notice: RecordNotice) -> None:
        """Have a notice shown, in place of the last of its code and node."""
        key = (notice.code, notice.node)
        self.notices = [kept for kept in self.notices if (kept.code, kept.node) != key]
        self.notices.append(notice)
        del self.notices[:-NOTICES_KEPT]

    def _node(self, node: str, t: float) -> NodeBoard:
        known = self.nodes.get(node)
        if known is None:
            known = self.nodes[node] = NodeBoard(t=t)
        known.t = max(known.t, t)
        return known

    def _named(self, reading: Node) -> None:
        known = self._node(reading.node, reading.t)
        known.callsign = reading.callsign if reading.callsign is not None else known.callsign
        known.crew = reading.crew if reading.crew is not None else known.crew

    def _retired(self, reading: Retire) -> None:
        # The newest one's, or none: who came back and leaves again does so for a reason of his own.
        if reading.t >= self.retired.get(reading.node, (-math.inf, None))[0]:
            self.retired[reading.node] = reading.t, reading.reason

    def _told(self, reading: Status, known_t: float) -> None:
        known = self._node(reading.node, reading.t)
        if known.status_t is not None and reading.t < known.status_t:
            return  # came late: a newer one is shown
        known.status_t = reading.t
        for name in ("battery", "air_bar", "temperature_c", "motionless_s"):
            value = getattr(reading, name)
            if value is not None:
                if name == "air_bar":
                    known.breathes(value)
                setattr(known, name, value)
                known.told_t[name] = min(reading.t, known_t)

    def _alarmed(self, reading: Alarm) -> None:
        self._node(reading.node, reading.t)
        kinds = self.alarms.setdefault(reading.node, {})
        known = kinds.get(reading.alarm)
        if known is None:
            kinds[reading.alarm] = AlarmEntry.first(reading)
        else:
            known.hear(reading)

    def picture(self, estimates: Iterable[NodeEstimate], newest_t: float | None) -> PictureRecord:
        """The record of what the tracker knows and what stands here."""
        nodes = [self._joined(estimate) for estimate in estimates]
        tracked = {node.node for node in nodes}
        for name, known in self.nodes.items():
            if name not in tracked:
                # Someone in trouble is shown even where the tracker has nothing to say of it.
                nodes.append(self._joined(NodeEstimate(node=name, role="responder", t=known.t)))
        standing = [
            RecordAlarm(node=node, alarm=kind, state=entry.state, t=entry.t, text=entry.text)
            for node, kinds in self.alarms.items()
            for kind, entry in kinds.items()
            if entry.stands(kind)
        ]
        standing.sort(key=lambda alarm: (alarm.t, alarm.node, alarm.alarm))
        return PictureRecord(
            t=newest_t,
            nodes=tuple(nodes),
            alarms=tuple(standing),
            notices=tuple(self.notices),
            set_aside=tuple(self.aside.values()),
            clocks=tuple(gateway_clocks.behind(self.clocks)),
        )

    def _joined(self, estimate: NodeEstimate) -> RecordNode:
        told = self.nodes.get(estimate.node) or NodeBoard(t=estimate.t)
        _, reason = self.retired.get(estimate.node, (0.0, None))
        return _record_of(estimate, told, min(estimate.t, self.came_t.get(estimate.node, math.inf)), reason)


def _record_of(estimate: NodeEstimate, told: NodeBoard, t: float, retire_reason: str | None) -> RecordNode:
    return RecordNode(
        node=estimate.node,
        role=estimate.role,
        t=t,
        position_m=estimate.position_m,
        covariance_m2=estimate.covariance_m2,
        heading_rad=estimate.heading_rad,
        heading_sigma_rad=estimate.heading_sigma_rad,
        speed_mps=estimate.speed_mps,
        retired=estimate.retired,
        callsign=told.callsign,
        crew=told.crew,
        battery=told.battery,
        air_bar=told.air_bar,
        temperature_c=told.temperature_c,
        motionless_s=told.motionless_s,
        moved_t=told.moved_t,
        retire_reason=retire_reason if estimate.retired else None,
        battery_t=told.told_t.get("battery"),
        air_t=told.told_t.get("air_bar"),
        temperature_t=told.told_t.get("temperature_c"),
        motionless_t=told.told_t.get("motionless_s"),
        air_first_bar=told.air_first_bar,
        air_least_bar=told.air_least_bar,
    )
