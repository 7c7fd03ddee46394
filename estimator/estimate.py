"""The values that leave a tracker: what is known of each node, and what the tracker has to say."""

from typing import Literal

import msgspec

from estimator.measurements.node import Role

Vector3 = tuple[float, float, float]
Covariance6 = tuple[float, float, float, float, float, float]
"""Upper triangle of a 3 × 3 covariance: ee, en, eu, nn, nu, uu (m²)."""


class NodeEstimate(msgspec.Struct, frozen=True, kw_only=True, array_like=True, gc=False):
    """What is known of one node after the readings folded so far.

    Attributes:
        node: the node.
        role: what it is.
        t: epoch of its newest fused reading, Unix seconds.
        position_m: east, north, up (m); None while its position is not decided.
        covariance_m2: of the position; None with it.
        heading_rad: where it faces, from east, anticlockwise (rad); None if unknown or static.
        heading_sigma_rad: standard deviation of `heading_rad` (rad).
        speed_mps: horizontal speed (m/s); None if unknown or static.
        retired: it has been marginalised; it may come back.
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


NoticeCode = Literal[
    "not_fused",
    "too_late",
    "introduced_late",
    "node_moved",
    "came_back",
    "unit_changed",
    "link_changed",
    "outlier",
    "conflict",
    "unknown_node",
    "no_origin",
    "unsolved",
]


class Notice(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """Something that the tracker did not fuse or that it noticed, for the log and the screen.

    Attributes:
        code: what it is, for programs.
        t: epoch it refers to, Unix seconds.
        node: the node it concerns, if one.
        text: what it is, for people.
    """

    code: NoticeCode
    t: float
    text: str
    node: str | None = None


class Relative(msgspec.Struct, frozen=True, kw_only=True):
    """The position of one node relative to another, from their joint covariance.

    Attributes:
        delta_m: position of `b` less that of `a` (m).
        covariance_m2: of `delta_m`, cross terms included.
    """

    delta_m: Vector3
    covariance_m2: Covariance6


class TrackPoint(msgspec.Struct, frozen=True, kw_only=True, array_like=True, gc=False):
    """One epoch of a smoothed track.

    Attributes:
        t: epoch, Unix seconds.
        position_m: east, north, up (m).
        covariance_m2: of the position.
    """

    t: float
    position_m: Vector3
    covariance_m2: Covariance6
