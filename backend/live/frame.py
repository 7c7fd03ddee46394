"""What screens get: structs from which both the bytes and the OpenAPI schemas come."""

from collections.abc import Sequence
from typing import Any, Literal, cast

import msgspec

from backend.live.record import ClockOf
from estimator.estimate import Covariance6, Vector3
from estimator.measurements.node import Role
from estimator.measurements.status import AlarmKind, AlarmState

Status = Literal["live", "stale", "lost", "retired"]
AirState = Literal["turn_back", "low"]


class FrameNode(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A node as it is shown.

    Attributes:
        node: the node.
        role: what it is.
        callsign: how it is called by radio.
        crew: the crew of a responder.
        position_m: east, north, up (m); null while its position is not decided.
        covariance_m2: upper triangle ee, en, eu, nn, nu, uu (m²), grown by what it may have moved since.
        heading_rad: where it faces, from east, anticlockwise (rad).
        heading_sigma_rad: standard deviation of `heading_rad` (rad).
        speed_mps: horizontal speed (m/s).
        level: the storey on which it most likely is; null where the incident names no levels.
        level_p: probability of that storey.
        t: epoch of its newest fused reading, Unix seconds.
        status: live, stale, lost or retired.
        battery: charge, 0 to 1.
        air_bar: pressure left in the air cylinder (bar).
        temperature_c: temperature at the unit (°C).
        motionless_s: for how long it had not moved at its newest status (s).
        moved: it was noticed to have been moved in the last ten minutes.
        retire_reason: why it has left, where that was said.
        battery_t: epoch of the status that told it, Unix seconds; a unit may go on without its sensors.
            Left out where it was never told, as the three below.
        air_t: the same of `air_bar`.
        temperature_t: the same of `temperature_c`.
        motionless_t: the same of `motionless_s`.
        air_state: half of the air above the low pressure is used, or the pressure is low; left out before,
            and of who has left.
        air_turn_back_bar: the pressure at which half of it is used (bar); left out where no air was reported.
    """

    node: str
    role: Role
    callsign: str | None
    crew: str | None
    position_m: Vector3 | None
    covariance_m2: Covariance6 | None
    heading_rad: float | None
    heading_sigma_rad: float | None
    speed_mps: float | None
    level: int | None
    level_p: float | None
    t: float
    status: Status
    battery: float | None
    air_bar: float | None
    temperature_c: float | None
    motionless_s: float | None
    moved: bool
    retire_reason: str | None
    battery_t: float | None = None
    air_t: float | None = None
    temperature_t: float | None = None
    motionless_t: float | None = None
    air_state: AirState | None = None
    air_turn_back_bar: float | None = None


class FrameAlarm(msgspec.Struct, frozen=True, kw_only=True):
    """An alarm that stands: until it is cleared, and a call for help until a person has acknowledged it too.

    Attributes:
        node: whose alarm it is.
        alarm: which one.
        state: raised, acknowledged, or cleared before any person had acknowledged it.
        t: when it was raised, Unix seconds.
        text: what was said, by who raised it and by who answered, a line each.
    """

    node: str
    alarm: AlarmKind
    state: AlarmState
    t: float
    text: str | None


class FrameNotice(msgspec.Struct, frozen=True, kw_only=True):
    """Something that the estimator noticed or did not fuse.

    Attributes:
        code: what it is, for programs.
        t: epoch it refers to, Unix seconds.
        text: what it is, for people.
        node: the node it concerns, if one.
    """

    code: str
    t: float
    text: str
    node: str | None


class FrameAside(msgspec.Struct, frozen=True, kw_only=True):
    """Who is heard, and not live on the map, because none of its readings can be used.

    Attributes:
        name: as which it speaks, which may be no identifier; empty where it does not say.
        callsign: as it calls itself by radio.
        crew: as it says.
        gateway: by which it was heard.
        t: when it was heard last, by the incident's clock, Unix seconds.
        code: what is wrong with its readings, for programs.
        text: the same, for people.
    """

    name: str
    callsign: str | None
    crew: str | None
    gateway: str
    t: float
    code: str
    text: str


class FrameClock(msgspec.Struct, frozen=True, kw_only=True):
    """A clock that is behind: whoever is heard by it seems to have been heard long ago, or is not followed.

    Attributes:
        gateway: by which the readings come.
        behind_s: by how much it is behind the server's (s).
        clock_of: the gateway's own, or that of the units which it hears.
    """

    gateway: str
    behind_s: float
    clock_of: ClockOf


class Frame(msgspec.Struct, frozen=True, kw_only=True):
    """The picture of an incident at one moment.

    Attributes:
        incident: the incident.
        seq: the newest log entry in it.
        t: the moment at which it is looked at, Unix seconds: ages count up to it.
        clock_t: the same, under the name that says so.
        newest_t: the newest epoch folded, Unix seconds; null before the first reading.
        nodes: all nodes ever introduced.
        alarms: alarms that stand.
        notices: the newest notices of the estimator, and why somebody who has no position comes too late.
        set_aside: who is heard, and not live on the map, because none of its readings can be used.
        clocks: those that are behind, of gateways that are heard.
    """

    incident: str
    seq: int
    t: float
    clock_t: float
    newest_t: float | None
    nodes: tuple[FrameNode, ...]
    alarms: tuple[FrameAlarm, ...]
    notices: tuple[FrameNotice, ...]
    set_aside: tuple[FrameAside, ...]
    clocks: tuple[FrameClock, ...]


class FrameMessage(Frame, frozen=True, kw_only=True, tag_field="type", tag="frame"):
    """A whole frame: the first message, and again where deltas would have been missed."""


class DeltaMessage(Frame, frozen=True, kw_only=True, tag_field="type", tag="delta"):
    """What has changed since the last message: `nodes` holds the changed ones whole, the rest is complete."""


class HeartbeatMessage(
    msgspec.Struct, frozen=True, kw_only=True, tag_field="type", tag="heartbeat", omit_defaults=True
):
    """A sign of life, at least every 2 s.

    Attributes:
        t: now: the server's clock, the newest reading of a recorded incident, or the replay's time.
        seq: the newest log entry in the picture.
        paused: replay only: time stands still.
        speed: replay only: incident seconds per second.
        ended: replay only: the end has been reached.
    """

    t: float
    seq: int
    paused: bool | None = None
    speed: float | None = None
    ended: bool | None = None


class ErrorMessage(msgspec.Struct, frozen=True, kw_only=True, tag_field="type", tag="error"):
    """What the client sent was not understood; nothing has changed.

    Attributes:
        detail: what was wrong, and what to send.
    """

    detail: str


class Track(msgspec.Struct, frozen=True, kw_only=True):
    """Where a node was.

    Attributes:
        node: the node.
        points: t (Unix s), e, n, u (m), ee, en, eu, nn, nu, uu (m²) each.
    """

    node: str
    points: list[tuple[float, float, float, float, float, float, float, float, float, float]]


class Tracks(msgspec.Struct, frozen=True, kw_only=True):
    """Tracks of an incident's nodes."""

    tracks: list[Track]


class RelativePosition(msgspec.Struct, frozen=True, kw_only=True):
    """Where one node is relative to another.

    Attributes:
        delta_m: position of `b` less that of `a`, east, north, up (m).
        covariance_m2: of it, from the joint covariance (m²).
        distance_m: its length (m).
        distance_sigma_m: standard deviation of the length (m).
    """

    delta_m: Vector3
    covariance_m2: Covariance6
    distance_m: float
    distance_sigma_m: float


def message(
    kind: type[FrameMessage] | type[DeltaMessage], frame: Frame, nodes: Sequence[FrameNode | msgspec.Raw]
) -> FrameMessage | DeltaMessage:
    """A frame as a message.

    Args:
        kind: of the message.
        frame: what is shown.
        nodes: those that go into it, as they are or encoded already.
    """
    return kind(
        incident=frame.incident,
        seq=frame.seq,
        t=frame.t,
        clock_t=frame.clock_t,
        newest_t=frame.newest_t,
        nodes=cast("tuple[FrameNode, ...]", nodes),
        alarms=frame.alarms,
        notices=frame.notices,
        set_aside=frame.set_aside,
        clocks=frame.clocks,
    )


MESSAGES = {
    "frame": FrameMessage,
    "delta": DeltaMessage,
    "heartbeat": HeartbeatMessage,
    "error": ErrorMessage,
}


def message_schemas() -> dict[str, Any]:
    """Schemas of everything in this file, for `components.schemas` of the OpenAPI document."""
    types = [Frame, *MESSAGES.values(), Tracks, RelativePosition]
    _, schemas = msgspec.json.schema_components(types, ref_template="#/components/schemas/{name}")
    mapping = {tag: f"#/components/schemas/{kind.__name__}" for tag, kind in MESSAGES.items()}
    schemas["LiveMessage"] = {
        "title": "LiveMessage",
        "description": "What comes over the `live` and `replay` sockets.",
        "oneOf": [{"$ref": ref} for ref in mapping.values()],
        "discriminator": {"propertyName": "type", "mapping": mapping},
    }
    return schemas
