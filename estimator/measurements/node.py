"""`node`: introduces or renames a node."""

from typing import Literal

from estimator.measurements.base import AngleRad, Identifier, Reading, ShortText, SigmaM, SigmaRad, Vector3M

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
