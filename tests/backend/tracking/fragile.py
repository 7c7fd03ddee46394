"""A tracker that breaks."""

import math
from collections.abc import Mapping, Sequence
from typing import Self

from estimator.estimate import NodeEstimate, Notice, Relative
from estimator.measurements import AnyReading, Retire, Status
from estimator.trackers.base import TrackerSettings


class Fragile:
    """A tracker that counts readings, breaks at a `retire` or when asked after one, and never settles."""

    def __init__(self, settings: TrackerSettings, folded: int = 0) -> None:
        del settings
        self.folded = folded
        self.newest_t = 0.0
        self.lazy = False
        self.endless = False

    def fold(self, readings: Sequence[AnyReading], known_t: float = math.inf) -> None:
        assert known_t == math.inf, "a recorded incident goes by its readings"
        for reading in readings:
            if isinstance(reading, Retire):
                raise ZeroDivisionError("a defect")
            self.lazy = self.lazy or (isinstance(reading, Status) and reading.node == "late-to-break")
            self.endless = isinstance(reading, Status) and reading.node == "endless"
            self.folded += 1
            self.newest_t = reading.t

    def estimates(self) -> list[NodeEstimate]:
        if self.lazy:
            raise ZeroDivisionError("a defect of which nothing is seen until something is asked")
        return [NodeEstimate(node="ff1", role="responder", t=self.newest_t, speed_mps=float(self.folded))]

    def relative(self, a: str, b: str) -> Relative | None:
        if b == "nobody":
            raise KeyError(b)
        return None if a == "lost" else Relative(delta_m=(1.0, 2.0, 3.0), covariance_m2=(1, 0, 0, 1, 0, 1))

    def settle(self) -> bool:
        return self.endless

    def settled(self) -> Self | None:
        return None

    def take_notices(self) -> list[Notice]:
        return []

    def counts(self) -> Mapping[str, int]:
        return {}

    def snapshot(self) -> bytes:
        return b"%d" % self.folded

    @classmethod
    def restore(cls, state: bytes) -> Self:
        return cls(TrackerSettings(), int(state))
