"""What is kept of late and out-of-order readings in a snapshot."""

import msgspec

from estimator.estimate import Notice
from estimator.inertial.samples import AnyFolded
from estimator.trackers.catch_up import CatchUp
from estimator.trackers.first_reports import FirstReports


class Leap(msgspec.Struct, frozen=True, array_like=True):
    """A reading that put the newest epoch forward by more than the lag: what goes on from before is too late.

    Attributes:
        node: the node that it names first.
        from_t: the newest epoch before it (s); None: there was none.
        to_t: the newest epoch with it (s).
    """

    node: str
    from_t: float | None
    to_t: float


class LagRecord(msgspec.Struct, frozen=True, array_like=True):
    """`Lag` in plain values, but for its states: the oldest and the newest one are kept beside it.

    Attributes:
        newest_t: see `Lag`.
        too_late: see `Lag`.
        received: see `Lag`.
        readings: readings of each tick.
        checkpoints: tick of each state kept.
        notices: noticed in each tick.
        given: notices of each tick that were taken.
        loose: notices not taken yet that belong to no tick.
        late: see `Lag`.
        leaps: see `Lag`.
        hurry: see `CatchUp`.
        first: see `FirstReports`.
        shown: tick of each state kept of the chain in a hurry; they come after the others.
    """

    newest_t: float | None
    too_late: int
    received: int
    readings: list[tuple[int, list[AnyFolded]]]
    checkpoints: list[int]
    notices: dict[int, list[Notice]]
    given: dict[int, list[Notice]]
    loose: list[Notice]
    late: dict[str, int] = msgspec.field(default_factory=dict)
    leaps: list[Leap] = msgspec.field(default_factory=list)
    hurry: CatchUp = msgspec.field(default_factory=CatchUp)
    first: FirstReports = msgspec.field(default_factory=FirstReports)
    shown: list[int] = msgspec.field(default_factory=list)
