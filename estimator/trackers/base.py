"""The interface of a tracker, and of a smoother. A new estimator is one new file in this folder."""

import math
from collections.abc import Mapping, Sequence
from typing import Protocol, Self

import msgspec

from estimator.estimate import NodeEstimate, Notice, Relative, TrackPoint
from estimator.evidence import Advice, Evidence
from estimator.measurements import AnyReading
from estimator.trackers.heard import Heard


class TrackerSettings(msgspec.Struct, frozen=True, kw_only=True):
    """What an incident tells its tracker.

    Attributes:
        lag_s: readings later than this behind the newest epoch are counted, not fused (s); of introductions
            what they say of a node for good counts.
        origin_wgs84: latitude (°), longitude (°), height above the ellipsoid (m) of the origin, if known.
    """

    lag_s: float = 60.0
    origin_wgs84: tuple[float, float, float] | None = None


class Tracker(Protocol):
    """Folds readings into estimates; a deterministic function of what it is given."""

    def fold(self, readings: Sequence[AnyReading], known_t: float = math.inf) -> None:
        """Fold readings, in any order of epochs; those within the lag lose no accuracy by being late.

        Args:
            readings: they are.
            known_t: when they came, by a clock that can be trusted (s): an epoch beyond it is that of a
                wrong clock, and makes no other reading late.
        """

    def estimates(self) -> list[NodeEstimate]:
        """Every node ever introduced, in order of introduction."""

    def relative(self, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a`; None where either has no decided position.

        Raises:
            KeyError: a node is not known.
        """

    def settle(self) -> bool:
        """Do a little of the work of `settled`, so that readings that come meanwhile need not wait for all.

        Returns:
            There is more of it, beside what the next readings may change.
        """

    def settled(self) -> Self | None:
        """Where late readings were folded in a hurry: a tracker that tells what they make without one.

        It is to be asked, and nothing is to be folded with it: this one goes on as if nothing had been. None:
        this one tells all that there is.
        """

    def take_notices(self) -> list[Notice]:
        """What was noticed since the last call."""

    def counts(self) -> Mapping[str, int]:
        """How many readings were fused, not fused, too late, rejected as outliers, in all."""

    def snapshot(self) -> bytes:
        """The whole state: `restore` of it continues with results equal to the last bit."""

    @classmethod
    def restore(cls, state: bytes) -> Self:
        """A tracker that goes on where `snapshot` was taken.

        Raises:
            ValueError: `state` was written by another version, or is no snapshot: fold the log anew.
        """


Told = Sequence[AnyReading] | Heard
"""All readings of an incident, in any order, or what keeps them and has folded the older ones."""


class Smoother(Protocol):
    """Solves a whole incident with everything known."""

    def smooth(self, told: Told) -> dict[str, list[TrackPoint]]:
        """Every node's track, a point at each whole second from its first to its last reading."""

    def evidence(self, told: Told, node: str) -> Evidence | None:
        """What holds a node's newest fix; None where its position is not decided.

        Raises:
            KeyError: there is no such node.
        """

    def advice(self, told: Told, node: str) -> Advice | None:
        """What would make a node's newest position surer; None where it is not decided.

        Raises:
            KeyError: there is no such node.
        """
