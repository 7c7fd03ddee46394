"""`status` and `alarm`: shown to the commander, not fused."""

from typing import Annotated, Literal

from msgspec import Meta

from estimator.measurements.base import Identifier, LongText, Reading

AlarmKind = Literal["mayday", "pass", "evacuate", "help"]
AlarmState = Literal["raised", "acknowledged", "cleared"]


class Status(Reading, tag="status", frozen=True):
    """What a unit tells of itself.

    Attributes:
        node: the unit.
        battery: charge, 0 to 1.
        air_bar: pressure left in the air cylinder (bar).
        temperature_c: temperature at the unit (°C).
        motionless_s: for how long it has not moved (s).
        clock_offset_s: its clock less the gateway's (s).
    """

    node: Identifier
    battery: Annotated[float, Meta(ge=0.0, le=1.0)] | None = None
    air_bar: Annotated[float, Meta(ge=0.0, le=1_000.0)] | None = None
    temperature_c: Annotated[float, Meta(ge=-273.15, le=3_000.0)] | None = None
    motionless_s: Annotated[float, Meta(ge=0.0, le=1e6)] | None = None
    clock_offset_s: Annotated[float, Meta(ge=-1e9, le=1e9)] | None = None


class Alarm(Reading, tag="alarm", frozen=True):
    """An alarm of a node, or a change of one.

    Attributes:
        node: whose alarm it is.
        alarm: which one.
        state: raised, acknowledged or cleared.
        text: what was said.
    """

    node: Identifier
    alarm: AlarmKind
    state: AlarmState
    text: LongText | None = None
