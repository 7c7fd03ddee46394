"""Whether somebody has begun to crawl, of which his unit may miss some (decision 0129).

Boots that are dragged do not stand between strides, and steps that are counted are none: what a unit makes of
a crawl is too short or too long by a share that hardly changes while it lasts, and has nothing to do with
that of a walk. So the scale of its steps is renewed where its bearer begins to go slowly, and where he walks
again.
"""

import math
from typing import Self

import msgspec
from msgspec.structs import replace
from numba import njit

from estimator.fusion import physics

PACE_S = 8.0
"""Over so long a pace is meant: who sets out, turns round or looks through a door does not crawl. Of a crawl
that is shorter a unit misses less than half a metre."""
STRIDE_S, SHORT_S = 1.0, 0.02
"""Over so long at least a pace is meant, for a boot stands for half of each stride; but for what
displacements of a second fall short of it."""
PARTS, EVEN = 4, 0.3
"""Who tells the parts of a stride, so many at least, and goes in all of them as fast, but for so much, takes
no strides: what rolls, or is watched by a camera, and tells of a slow way what it tells of any. The boot of
who walks stands for half of a stride, that of who crawls while the other one is drawn up: their paces differ
by about as much as they are, which is assumed."""
NO_STRIDE = 0.0, 0.0, 0.0, 0
KNOWN = 1.0 - math.exp(-1.0)
"""So much of that mean is to be of paces that were told, before they say how somebody goes at first."""
SHUFFLES_MPS = 0.15
"""Who is slower stands, and shifts his feet."""
RENEWED = 1e-5
"""Variance that a displacement adds to a scale from which on it renews it: no random walk adds as much."""
KEPT = 0.1
"""What is left of the scale before. Nothing should be; but what a state contracts to nil has no Kirchhoff
matrix any more."""


@njit(cache=True)
def kept(variance: float) -> float:
    """What is left of a scale before, where a variance is added to it: all, unless that renews it."""
    return KEPT if variance > RENEWED else 1.0


class Gait(msgspec.Struct, frozen=True, array_like=True):
    """How somebody goes.

    Attributes:
        pace_mps: mean pace of the last strides in which he went, by his unit (m/s).
        told: share of that mean which paces have told, 0 to 1: the rest is not known yet.
        uneven: mean of how much the paces inside these strides differ, by their standard deviation over their
            mean.
        slow: he may crawl; he does not before he has gone for some seconds.
        stride: what has been told of the stride that lasts: how far, for how long, the integral of squared
            pace, and of how many displacements (m, s, m²/s).
    """

    pace_mps: float = 0.0
    told: float = 0.0
    uneven: float = 0.0
    slow: bool = False
    stride: tuple[float, float, float, int] = NO_STRIDE

    def after(self, gone_m: float, span_s: float) -> Self:
        """How he goes after a displacement: so far, in a time (m, s)."""
        before_m, before_s, squares, count = self.stride
        way_m, lasted_s, count = before_m + gone_m, before_s + span_s, count + 1
        squares += gone_m * (gone_m / span_s)
        if lasted_s < STRIDE_S - SHORT_S:
            return replace(self, stride=(way_m, lasted_s, squares, count))
        pace_mps = way_m / lasted_s
        if pace_mps < SHUFFLES_MPS:
            return replace(self, stride=NO_STRIDE)
        share = -math.expm1(-lasted_s / PACE_S)
        told = share + (1.0 - share) * self.told
        spread = math.sqrt(max(squares / lasted_s / pace_mps**2 - 1.0, 0.0)) if count >= PARTS else 1.0
        pace_mps = self.pace_mps + share / told * (pace_mps - self.pace_mps)
        uneven = self.uneven + share / told * (spread - self.uneven)
        # Nobody walks who has not been seen to.
        walked = self.told >= KNOWN and not self.slow
        slow = pace_mps < (physics.CRAWLS_MPS if walked else physics.WALKS_MPS)
        slow = slow and told >= KNOWN and uneven > EVEN
        return type(self)(pace_mps, told, uneven, slow)

    def changes(self, before: Self) -> bool:
        """Whether he goes otherwise than he did."""
        return self.slow != before.slow

    @property
    def scale2(self) -> float:
        """Variance of the scale of a unit whose bearer begins to go like that."""
        sigma = physics.CRAWL_SCALE_SIGMA if self.slow else physics.SCALE_SIGMA
        return sigma**2
