"""Whether somebody crawls: of who goes slowly his unit may miss some of the way (decision 0129).

Boots that are dragged do not stand between strides, and steps that are counted are none: what a unit makes of
a crawl is too short or too long by a share that hardly changes while it lasts, and has nothing to do with
that of a walk. So the scale of its steps is renewed where its bearer begins to go slowly, and where he walks
again.
"""

import math
from typing import Self

import msgspec

from estimator.fusion import physics

PACE_S = 4.0
"""Over so long a pace is meant: who sets out, or turns round, does not crawl."""
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
        slow: he may crawl.
    """

    pace_mps: float = physics.WALKS_MPS
    slow: bool = False

    def after(self, gone_m: float, span_s: float) -> Self:
        """How he goes after a displacement by which he went: so far, in a time."""
        kept = math.exp(-span_s / PACE_S)
        pace_mps = kept * self.pace_mps + (1.0 - kept) * gone_m / span_s
        slow = pace_mps < (physics.WALKS_MPS if self.slow else physics.CRAWLS_MPS)
        return type(self)(pace_mps, slow)

    def doubt(self) -> tuple[float, float, float, float, float, float]:
        """What is unsure where it begins: variances of east, north, up (m²), ψ, β and the unit's scale.

        That he has begun shows after some seconds: what he has gone in these is as unsure as the scale of who
        crawls.
        """
        sigma = physics.CRAWL_SCALE_SIGMA if self.slow else physics.SCALE_SIGMA
        across_m2 = (physics.CRAWL_SCALE_SIGMA * PACE_S * self.pace_mps) ** 2
        return across_m2, across_m2, 0.0, 0.0, 0.0, sigma**2
