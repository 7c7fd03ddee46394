"""What fixes, heights and `node` readings have told of where a node is."""

import math
from typing import Literal, Self

import msgspec
from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion.learned.altimeter_zero import AltimeterZero
from estimator.fusion.learned.noise import single_sigma
from estimator.fusion.memory.late_start import LateStart
from estimator.fusion.physics import TICK_S


class SharedError(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """How many readings of one kind share an error that stays for some time.

    Attributes:
        t: epoch of the newest one (s); None: there is none yet.
        way_m: how far its node had gone by then (m).
        kept: how much of the error before still held, 0 to 1.
        count: how many share its error, itself included.
    """

    t: float | None = None
    way_m: float = 0.0
    kept: float = 0.0
    count: float = 0.0

    def with_one(self, t: float, way_m: float, memory_s: float, memory_m: float = math.inf) -> Self:
        """After one more.

        Args:
            t: its epoch (s).
            way_m: how far its node has gone by then (m).
            memory_s: within so much time an error is forgotten (s).
            memory_m: within so much of a way (m).
        """
        waited_s = math.inf if self.t is None else abs(t - self.t)
        kept = math.exp(-waited_s / memory_s - abs(way_m - self.way_m) / memory_m)
        return type(self)(t, way_m, kept, 1.0 + kept * self.count)

    def sigma(self, sigma: float, shared: float) -> float:
        """Standard deviation to give to the newest one.

        k readings that share an error are worth k / (w + k c) together, with w the variance of each alone
        and c the common one. Where it is forgotten as fast as it is read anew, each is worth what one of a
        long row is: 1 / (w + c (1 + ρ) / (1 − ρ)), the spectrum of an error that keeps ρ of itself from one
        reading to the next, at frequency 0.

        Args:
            sigma: of one reading by itself.
            shared: share of its variance that it has in common with the others.
        """
        common = shared * sigma * sigma
        white = sigma * sigma - common
        row = single_sigma(white, common, self.count)
        if self.kept == 1.0:
            return row
        return min(row, math.sqrt(white + common * (1.0 + self.kept) / (1.0 - self.kept)))


Beginning = Literal["sure", "assumed", "unheard", "fix"]
"""What tells where somebody began: a gateway, or later readings that agree; nobody, so it was taken to be at
the base; nothing at all, so it may be; a single fix."""


class Absolute(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """What was told of a node's place, not of its distance or step from elsewhere.

    Attributes:
        beginning: what tells where it began.
        told_m: where its `node` reading told it to be (m).
        fixes: its fixes.
        heights: its altimeter's readings.
        zeroed: what its altimeter is off by.
        fits: seconds with a fix that fitted, while its beginning is not sure.
        against: such seconds in a row with fixes that agree with each other, not with where it seems to be.
        off_m: how far the newest of them is off, east and north (m).
        counted_t: epoch of the newest fix that was counted (s): copies of one are one.
        disbelieved_m: standard deviation with which its place was told, if it does not stand there (m).
        late: whether it was inside already when the log began, though it was taken to enter.
    """

    beginning: Beginning = "sure"
    told_m: Vector3 | None = None
    fixes: SharedError = SharedError()
    heights: SharedError = SharedError()
    zeroed: AltimeterZero = AltimeterZero()
    fits: int = 0
    against: int = 0
    off_m: tuple[float, float] = (0.0, 0.0)
    counted_t: float = -math.inf
    disbelieved_m: float | None = None
    late: LateStart = LateStart()

    @property
    def believed_m(self) -> Vector3 | None:
        """Where it was told to be, as long as that is believed (m)."""
        return self.told_m if self.disbelieved_m is None else None

    def with_fix(self, t: float, fits: bool, off_m: tuple[float, float], same_m: float) -> Self:
        """After a fix that fits or does not.

        Args:
            t: its epoch (s).
            fits: whether it does.
            off_m: how far it is off, east and north (m).
            same_m: so far from each other two that are off agree (m).
        """
        if t < self.counted_t + TICK_S:
            return self
        if fits:
            return replace(self, fits=self.fits + 1, against=0, counted_t=t)
        again = self.against > 0 and math.dist(off_m, self.off_m) < same_m
        return replace(self, against=self.against + 1 if again else 1, off_m=off_m, counted_t=t)
