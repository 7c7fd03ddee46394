"""Whether somebody has begun to crawl, of which his unit may miss some (decision 0129).

Boots that are dragged do not stand between strides, and steps that are counted are none: what a unit makes of
a crawl is too short or too long by a share that hardly changes while it lasts, and has nothing to do with
that of a walk. So the scale of its steps is renewed where its bearer begins to go slowly, and where he walks
again.
"""

import math
from typing import Self

import msgspec

from estimator.fusion import physics

PACE_S = 8.0
"""Over so long a pace is meant: who sets out, turns round or looks through a door does not crawl. Of a crawl
that is shorter a unit misses less than half a metre."""
KNOWN = 1.0 - math.exp(-1.0)
"""So much of that mean is to be of paces that were told, before they say how somebody goes at first."""
SHUFFLES_MPS = 0.15
"""Who is slower stands, and shifts his feet."""
RENEWED = 1e-5
"""Variance that a displacement adds to a scale from which on it renews it: no random walk adds as much."""
KEPT = 0.1
"""What is left of the scale before. Nothing should be; but what a state contracts to nil has no Kirchhoff
matrix any more."""


class Gait(msgspec.Struct, frozen=True, array_like=True):
    """How somebody goes.

    Attributes:
        pace_mps: mean pace of the last seconds in which he went, by his unit (m/s).
        told: share of that mean which paces have told, 0 to 1: the rest is not known yet.
        slow: he may crawl; he does not before he has gone for some seconds.
    """

    pace_mps: float = 0.0
    told: float = 0.0
    slow: bool = False

    def after(self, gone_m: float, span_s: float) -> Self:
        """How he goes after a displacement by which he went: so far, in a time."""
        share = -math.expm1(-span_s / PACE_S)
        told = share + (1.0 - share) * self.told
        if told == 0.0:
            return self
        pace_mps = self.pace_mps + share / told * (gone_m / span_s - self.pace_mps)
        slow = pace_mps < (physics.WALKS_MPS if self.slow else physics.CRAWLS_MPS)
        return type(self)(pace_mps, told, slow and told >= KNOWN)

    def changes(self, before: Self) -> bool:
        """Whether he goes otherwise than he did."""
        return self.slow != before.slow

    def doubt(self) -> tuple[float, float, float, float, float, float]:
        """What is unsure where it begins: variances of east, north, up (m²), ψ, β and the unit's scale.

        That he has begun shows after some seconds: what he has gone in these is as unsure as the scale of who
        crawls.
        """
        sigma = physics.CRAWL_SCALE_SIGMA if self.slow else physics.SCALE_SIGMA
        across_m2 = (physics.CRAWL_SCALE_SIGMA * PACE_S * self.pace_mps) ** 2
        return across_m2, across_m2, 0.0, 0.0, 0.0, sigma**2
