"""Why a fix is where it is, and what would make it surer: the values that leave the estimator."""

from typing import Literal

import msgspec

from estimator.estimate import Covariance6, Vector3

EvidenceKind = Literal[
    "range",
    "rssi",
    "reach",
    "bearing",
    "fix",
    "height",
    "stillness",
    "straightness",
    "drop",
    "displacement",
    "prior",
]


class Measurement(msgspec.Struct, frozen=True, kw_only=True):
    """One edge of the graph and what it does for a fix.

    Attributes:
        kind: what was measured.
        t: its epoch, Unix seconds; of a displacement the end of the way.
        a: the node that measured, or that it is about.
        b: the node at the other end; None where there is none.
        value: what was read, in its own unit: m, dBm, rad, rad/s of a gyro bias; of a displacement its length
            (m); of a radio that fell silent or was heard again, how far radios reach (m); 0 of a drop, and of
            what was known beforehand of a node: where it began, how its unit errs.
        residual: what was read less what the solution says, in the same unit.
        sigma: standard deviation that it was given, in the same unit.
        weight: probability that it is a good reading and no outlier, 0 to 1.
        share: its share of the fix's uncertainty as a current's share of the power (paper A, section IV-D):
            all shares add up to 1.
    """

    kind: EvidenceKind
    t: float
    a: str
    b: str | None = None
    value: float
    residual: float
    sigma: float
    weight: float
    share: float


class Evidence(msgspec.Struct, frozen=True, kw_only=True):
    """What holds a node's fix, with everything known at its epoch.

    Attributes:
        node: the node.
        t: epoch of the fix, Unix seconds.
        position_m: east, north, up (m).
        covariance_m2: of the position.
        held: the measurements with the largest shares, largest first.
        rejected: those near the fix that were taken for outliers, newest first.
        rest: share of all that is not listed.
    """

    node: str
    t: float
    position_m: Vector3
    covariance_m2: Covariance6
    held: list[Measurement]
    rejected: list[Measurement]
    rest: float


class Suggestion(msgspec.Struct, frozen=True, kw_only=True):
    """One thing that could be done, and what it would be worth.

    Attributes:
        action: a breadcrumb dropped by `by` where it stands; or a UAV that measures from `position_m`.
        by: who would do it; None: any UAV.
        position_m: where, east, north, up (m).
        sigma_m: standard deviation (root of the horizontal variances' sum) of the node's position afterwards
            (m).
        gain: share of the present horizontal variance that it would take away, 0 to 1.
    """

    action: Literal["drop", "uav"]
    by: str | None = None
    position_m: Vector3
    sigma_m: float
    gain: float


class Advice(msgspec.Struct, frozen=True, kw_only=True):
    """What would shrink a node's uncertainty most.

    Attributes:
        node: the node.
        t: epoch of its position, Unix seconds.
        sigma_m: root of the sum of its horizontal variances now (m).
        suggestions: best first.
    """

    node: str
    t: float
    sigma_m: float
    suggestions: list[Suggestion]
