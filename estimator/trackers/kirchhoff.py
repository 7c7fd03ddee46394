"""The default tracker: paper A's Kirchhoff state with headings, biases, scales and path loss as states.

A responder has position, heading error ψ, gyro bias β and step scale s; a ranging technology has scale and
bias; radio has P0 and n; static nodes have positions.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Self

import msgspec

from estimator.estimate import NodeEstimate, Notice, Relative
from estimator.fusion import report
from estimator.fusion.memory.encode import FusionRecord, record_of, state_of
from estimator.fusion.memory.state import FusionState
from estimator.fusion.picture import look
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.trackers.base import TrackerSettings
from estimator.trackers.lag import Lag
from estimator.trackers.lag_record import LagRecord
from estimator.trackers.snapshot import read_snapshot

VERSION = 66


class _Snapshot(msgspec.Struct, frozen=True, array_like=True):
    version: int
    settings: TrackerSettings
    lag: LagRecord
    fusion: list[FusionRecord]


class KirchhoffTracker:
    """Folds readings into the Kirchhoff state; see `estimator.trackers.base.Tracker`."""

    def __init__(self, settings: TrackerSettings | None = None) -> None:
        self.settings = settings or TrackerSettings()
        self._lag = Lag(self.settings.lag_s, FusionState(self.settings.origin_wgs84))
        self._shown: tuple[FusionState, Array] | None = None

    def fold(self, readings: Sequence[AnyReading], known_t: float = math.inf) -> None:
        """Fold readings, in any order of epochs; those within the lag lose no accuracy by being late.

        The work is done when something is asked for, so folding batch by batch costs no more than at once.
        """
        self._lag.add(readings, known_t)
        self._shown = None

    def _picture(self) -> tuple[FusionState, Array]:
        """The state to be shown and its covariance; what waits for a displacement is held against it here."""
        if self._shown is None:
            self._shown = _told(self._lag.state())
        return self._shown

    def settle(self) -> bool:
        """Fold the next second of what `settled` tells; False: it has all but the newest few."""
        return self._lag.settle()

    def settled(self) -> Self | None:
        """What to ask where late readings were folded in a hurry, and there is time; None: this one."""
        state = self._lag.settled()
        return None if state is None else self._showing(self.settings, state)

    @classmethod
    def _showing(cls, settings: TrackerSettings, state: FusionState) -> Self:
        tracker = cls(settings)
        tracker._shown = _told(state)
        return tracker

    def estimates(self) -> list[NodeEstimate]:
        """Every node ever introduced, in order of introduction."""
        return report.estimates(*self._picture())

    def relative(self, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a`, from their joint covariance; None where either is undecided.

        Raises:
            KeyError: a node is not known.
        """
        return report.relative(*self._picture(), a, b)

    def take_notices(self) -> list[Notice]:
        """What was noticed since the last call."""
        return self._lag.take_notices()

    def counts(self) -> Mapping[str, int]:
        """How many readings were received, fused, not fused, weighed as outliers, and too late."""
        return {"received": self._lag.received, **self._lag.state().counts, "too_late": self._lag.too_late}

    def snapshot(self) -> bytes:
        """The oldest state that late readings may need, and all readings after it; exact to the last bit."""
        lag, states = self._lag.record()
        return msgspec.msgpack.encode(_Snapshot(VERSION, self.settings, lag, [record_of(s) for s in states]))

    @classmethod
    def restore(cls, state: bytes) -> Self:
        """A tracker that goes on where `snapshot` was taken.

        Raises:
            ValueError: `state` was written by another version, or is no snapshot.
        """
        snapshot = read_snapshot(state, _Snapshot, VERSION)
        tracker = cls(snapshot.settings)
        tracker._lag = Lag.of(snapshot.settings.lag_s, snapshot.lag, [state_of(r) for r in snapshot.fusion])
        return tracker


def _told(state: FusionState) -> tuple[FusionState, Array]:
    if state.waiting or state.navigations:
        state = state.copy()
        look(state)
    return state, report.covariance_of(state)
