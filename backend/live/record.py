"""The picture of an incident as the worker makes it: what is known, whenever it is looked at."""

import zlib
from typing import Literal

import msgspec

from backend.errors import Unavailable
from estimator.estimate import Covariance6, Vector3
from estimator.measurements.node import Role
from estimator.measurements.status import AlarmKind, AlarmState

VERSION = 1


class UnknownRecord(Unavailable):
    """A record that was written by another version."""


class RecordNode(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """What is known of one node.

    Attributes:
        node: the node.
        role: what it is.
        t: epoch of its newest fused reading, Unix seconds.
        position_m: east, north, up (m); None while its position is not decided.
        covariance_m2: of the position at `t`; None with it.
        heading_rad: where it faces, from east, anticlockwise (rad).
        heading_sigma_rad: standard deviation of `heading_rad` (rad).
        speed_mps: horizontal speed (m/s).
        retired: it has left.
        callsign: how it is called by radio.
        crew: the crew of a responder.
        battery: charge, 0 to 1.
        air_bar: pressure left in the air cylinder (bar).
        temperature_c: temperature at the unit (°C).
        motionless_s: for how long it had not moved at its newest status (s).
        moved_t: when it was last noticed to have been moved, Unix seconds.
        retire_reason: why it has left, where that was said.
        battery_t: epoch of the status that told it, Unix seconds; a unit may go on without its sensors.
        air_t: the same of `air_bar`.
        temperature_t: the same of `temperature_c`.
        motionless_t: the same of `motionless_s`.
        air_first_bar: the highest pressure that the cylinder in use was reported with (bar).
        air_least_bar: the lowest one (bar).
    """

    node: str
    role: Role
    t: float
    position_m: Vector3 | None = None
    covariance_m2: Covariance6 | None = None
    heading_rad: float | None = None
    heading_sigma_rad: float | None = None
    speed_mps: float | None = None
    retired: bool = False
    callsign: str | None = None
    crew: str | None = None
    battery: float | None = None
    air_bar: float | None = None
    temperature_c: float | None = None
    motionless_s: float | None = None
    moved_t: float | None = None
    retire_reason: str | None = None
    battery_t: float | None = None
    air_t: float | None = None
    temperature_t: float | None = None
    motionless_t: float | None = None
    air_first_bar: float | None = None
    air_least_bar: float | None = None


class RecordAlarm(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """An alarm that stands.

    Attributes:
        node: whose alarm it is.
        alarm: which one.
        state: raised, acknowledged, or cleared before any person had acknowledged it.
        t: when it was raised, Unix seconds.
        text: what was said, a line each.
    """

    node: str
    alarm: AlarmKind
    state: AlarmState
    t: float
    text: str | None = None


class RecordNotice(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
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
    node: str | None = None


class RecordAside(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """Who was heard without a reading that can be used since.

    Attributes:
        name: as which it speaks; empty where it does not say.
        gateway: by which it was heard.
        since_t: when the first such reading came, by the incident's clock, Unix seconds.
        t: when the newest one came.
        code: what was wrong with that, for programs.
        text: the same for people.
        callsign: as it calls itself by radio.
        crew: as it says.
    """

    name: str
    gateway: str
    since_t: float
    t: float
    code: str
    text: str
    callsign: str | None = None
    crew: str | None = None


ClockOf = Literal["gateway", "units"]


class RecordClock(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """A clock that is behind: whoever is heard by it seems to have been heard long ago.

    Attributes:
        gateway: by which the readings came.
        t: when the newest of them came, by the incident's clock, Unix seconds.
        behind_s: by how much it is behind the server's (s).
        clock_of: the gateway's own, or that of the units which it hears.
    """

    gateway: str
    t: float
    behind_s: float
    clock_of: ClockOf


class PictureRecord(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """What is known of an incident after a log entry, apart from the moment at which it is looked at.

    Attributes:
        t: newest epoch in it, Unix seconds; None before the first reading.
        nodes: all nodes ever introduced, in order of introduction.
        alarms: alarms that stand, oldest first.
        notices: the newest notices, oldest first.
        set_aside: whose readings were set aside, all of them, the longest silent first.
        clocks: those that are behind.
    """

    t: float | None = None
    nodes: tuple[RecordNode, ...] = ()
    alarms: tuple[RecordAlarm, ...] = ()
    notices: tuple[RecordNotice, ...] = ()
    set_aside: tuple[RecordAside, ...] = ()
    clocks: tuple[RecordClock, ...] = ()


EMPTY = PictureRecord()

_encode = msgspec.msgpack.Encoder().encode
_decode = msgspec.msgpack.Decoder(PictureRecord).decode


def encode(record: PictureRecord) -> bytes:
    """A record as bytes, for the database and the link.

    The first byte is the format's version; the fastest compression takes off what rows repeat.
    """
    return bytes([VERSION]) + zlib.compress(_encode(record), level=1)


def readable(encoded: bytes) -> bool:
    """Whether this version can decode a record."""
    return encoded[:1] == bytes([VERSION])


def decode(encoded: bytes) -> PictureRecord:
    """The inverse of `encode`.

    Raises:
        UnknownRecord: another version wrote it.
    """
    if not readable(encoded):
        version = encoded[0] if encoded else "none"
        raise UnknownRecord(f"This picture was recorded in version {version} of its format, not {VERSION}.")
    return _decode(zlib.decompress(memoryview(encoded)[1:]))
