"""`node`: introduces or renames a node."""

from typing import Literal, Self

import msgspec

from estimator.measurements.base import (
    AngleRad,
    EpochSeconds,
    Identifier,
    Reading,
    ShortText,
    SigmaM,
    SigmaRad,
    Vector3M,
)

Role = Literal["base", "anchor", "beacon", "breadcrumb", "responder", "uav"]
"""base: static, known; anchor: static, given with sigma; beacon, breadcrumb: static, unknown; others move."""

MOVING_ROLES: frozenset[str] = frozenset({"responder", "uav"})


class Node(Reading, tag="node", frozen=True):
    """Introduces a node, or changes what is known of it.

    Attributes:
        node: the node.
        role: what it is.
        callsign: how it is called by radio.
        crew: the crew of a responder.
        position_m: where it stands, east, north, up (m).
        sigma_m: standard deviation of `position_m` per axis (m).
        heading_rad: the direction its own x axis points to, from east, anticlockwise (rad).
        heading_sigma_rad: standard deviation of `heading_rad` (rad).
        device: what hardware it is.
    """

    node: Identifier
    role: Role
    callsign: ShortText | None = None
    crew: ShortText | None = None
    position_m: Vector3M | None = None
    sigma_m: SigmaM | None = None
    heading_rad: AngleRad | None = None
    heading_sigma_rad: SigmaRad | None = None
    device: ShortText | None = None


class LateNode(Node, tag="late_node", frozen=True, kw_only=True):
    """A `node` reading that came too late for its own epoch: `t` is the oldest one that it can be taken of.

    Attributes:
        told_t: its own epoch, Unix seconds.
    """

    told_t: EpochSeconds

    @classmethod
    def of(cls, reading: Node, t: float) -> Self:
        """A reading, as of an epoch that it can still be taken of, Unix seconds."""
        return cls(**{**msgspec.structs.asdict(reading), "t": t}, told_t=reading.t)
