"""By what an altimeter is off beforehand, told where its bearer's height is known otherwise: at the door.

Air pressure changes by weather, and one sensor differs from the next. From then on what it is off by is a
state, which drifts.
"""

import math
from statistics import median
from typing import Self

import msgspec
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.calibration import TRUSTED
from estimator.fusion.learned.unseen_rise import Rise

READINGS, LONGEST_S = 5, 10.0
"""So many readings are held against the height that is known, and for so long at most."""
MEDIAN = 0.5 * math.pi
"""How much noisier a median is than a mean, in variance."""

ODD_M, ODD_SIGMAS, ODD_S, ODD_MAX = 1.0, 1.5, 6.0, 30
"""Readings that are farther off are odd; a draught's are so for some seconds, a jump's stay."""
JUMP_SIGMAS = 3.0
RECENT, FLAT, STEEPEST, STAIR_M = 8, 3, 1.5, 0.7
"""So many readings before a jump and after it differ by more than the steepest stair does, and its noise."""


class AltimeterZero(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """What is known of an altimeter.

    Attributes:
        off_m: by how much its first readings are above the height that is known (m).
        since_t: epoch of the first one (s).
        name: which of the incident's altimeters it is; None: it has not told enough yet.
        t: epoch of its newest reading (s).
        odd: epochs of its newest readings (s), and by how much they are above what was expected (m), as long
            as all of them are, or all below.
        recent: its newest readings, each with its epoch (s), what it reads (m), and how far its bearer had
            gone by then (m).
        rise: what it, or its bearer, was last found to have jumped by.
    """

    off_m: tuple[float, ...] = ()
    since_t: float = 0.0
    name: str | None = None
    t: float = -math.inf
    odd: tuple[tuple[float, float], ...] = ()
    recent: tuple[tuple[float, float, float], ...] = ()
    rise: Rise = Rise()

    def with_one(self, t: float, off_m: float) -> Self:
        """After one more reading.

        Args:
            t: its epoch (s).
            off_m: by how much it is above the height that is known (m).
        """
        return type(self)((*self.off_m, off_m), self.since_t if self.off_m else t)

    def after(self, t: float, up_m: float, way_m: float, off_m: float, sigma_m: float) -> Self:
        """After a reading of one that has told enough.

        Args:
            t: its epoch (s).
            up_m: what it reads (m).
            way_m: how far its bearer has gone (m).
            off_m: by how much it is above what was expected (m).
            sigma_m: its standard deviation (m).
        """
        odd = self.odd if not self.odd or self.odd[-1][1] * off_m > 0.0 else ()
        odd = (*odd, (t, off_m))[-ODD_MAX:] if abs(off_m) > max(ODD_M, ODD_SIGMAS * sigma_m) else ()
        recent = (*self.recent, (t, up_m, way_m))[-RECENT:]
        return replace(self, t=max(t, self.t), odd=odd, recent=recent)

    def before(self, since_t: float) -> float:
        """Epoch of the newest reading before another one's (s)."""
        return max((t for t, _, _ in self.recent if t < since_t), default=since_t)

    def level_since(self) -> float:
        """Epoch of the reading from which on it has read what it reads now (s)."""
        now_m, since_t = median(up_m for _, up_m, _ in self.recent[-FLAT:]), self.t
        for t, up_m, _ in reversed(self.recent):
            if abs(up_m - now_m) > ODD_M:
                break
            since_t = t
        return since_t

    def steep(self, jump_m: float) -> bool:
        """Whether no stair leads up or down so far (m) on the way of all its newest readings."""
        return abs(jump_m) > STEEPEST * (self.recent[-1][2] - self.recent[0][2]) + STAIR_M

    def steeper(self) -> tuple[float, float] | None:
        """When (s) and by how much (m) it has just jumped farther than a stair leads on so short a way."""
        for between in range(len(self.recent) - 2 * FLAT + 1):
            after, before = self.recent[-FLAT:], self.recent[-2 * FLAT - between : -FLAT - between]
            way_m = after[0][2] - before[-1][2]
            most_m = STEEPEST * way_m + STAIR_M
            ups, downs = [up_m for _, up_m, _ in after], [up_m for _, up_m, _ in before]
            if min(ups) - max(downs) > most_m or min(downs) - max(ups) > most_m:
                return self.recent[-FLAT - between][0], median(ups) - median(downs)
        return None

    def has_jumped(self, sigma_m: float, unsure_m2: float) -> tuple[float, float] | None:
        """When (s) and by how much (m) its newest readings have jumped; None where that is not clear.

        Args:
            sigma_m: standard deviation of one reading (m).
            unsure_m2: variance of what was expected (m²).
        """
        if not self.lasts:
            return None
        jump_m = median(off_m for _, off_m in self.odd)
        shared = physics.ABSOLUTE_SHARED
        unsure_m2 += sigma_m**2 * (shared + (1.0 - shared) * MEDIAN / len(self.odd))
        return (self.odd[0][0], jump_m) if jump_m**2 > JUMP_SIGMAS**2 * unsure_m2 else None

    @property
    def contradicts_m2(self) -> float:
        """Second moment of what a height is off by as long as it is not clear whether it has jumped (m²)."""
        return median(off_m for _, off_m in self.odd) ** 2 if len(self.odd) > 1 else 0.0

    @property
    def lasts(self) -> bool:
        """Whether it has been odd for long enough to ask whether it has jumped."""
        return len(self.odd) >= READINGS and self.odd[-1][0] > self.odd[0][0] + ODD_S

    def enough(self, t: float) -> bool:
        """Whether it has told enough by an epoch `t` (s)."""
        return len(self.off_m) >= READINGS or t > self.since_t + LONGEST_S

    def judged(self, sigma_m: float, unsure_m2: float) -> tuple[float, float]:
        """What its readings say of what it is off by: of two kinds, nearly nil or anything, the likelier one.

        Of the likelier kind the second moment of the other one is to be expected as well.

        Args:
            sigma_m: standard deviation of one reading (m).
            unsure_m2: variance of the height that is known (m²).

        Returns:
            By what it is likely to be off, nil of the first kind (m), and the standard deviation of what it
            is off by about nil, before the readings after these tell (m).
        """
        wide, narrow, shared = physics.HEIGHT_OFF_M**2, physics.HEIGHT_ZERO_M**2, physics.ABSOLUTE_SHARED
        known = unsure_m2 + sigma_m**2 * (shared + (1.0 - shared) * MEDIAN / len(self.off_m))
        told, share = median(self.off_m), wide / (wide + known)
        odds = math.log(physics.HEIGHTS_OFF / (1.0 - physics.HEIGHTS_OFF))
        odds += 0.5 * math.log(1.0 - share) + 0.5 * share * told**2 / known
        off = 1.0 / (1.0 + math.exp(-min(odds, 700.0)))
        if off < TRUSTED:
            return 0.0, math.sqrt(narrow + off * ((share * told) ** 2 + share * known))
        return share * told, math.sqrt(off * wide + (1.0 - off) * narrow)
