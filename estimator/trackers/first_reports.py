"""What is heard of who wears a unit that sums up seconds waits for its first report.

Nobody knows of a unit before it has told something. Its first report tells since when it has been worn. Had
nothing waited for it, its bearer would have been taken meanwhile to have none, and only the end of the report
would count. So he is looked at anew from where it begins, as if it had been known then that it was to come.
"""

import math
from collections.abc import Sequence

import msgspec

from estimator.fusion import physics
from estimator.fusion.motion.dead_reckoning import SELDOM_S
from estimator.inertial.samples import AnyFolded
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Awaited, Displacement


class FirstReports(msgspec.Struct, array_like=True):
    """Since when each unit has told how it moved.

    Attributes:
        since_t: where the earliest of its reports begins, by node (s).
    """

    since_t: dict[str, float] = msgspec.field(default_factory=dict)

    def awaited(self, readings: Sequence[AnyReading | AnyFolded]) -> list[Awaited]:
        """What should have been known when reports began that are their units' first ones, and not short.

        In whatever order reports come, the same is told of them in the end.
        """
        found: list[Awaited] = []
        for reading in readings:
            if type(reading) is not Displacement:
                continue
            start_t = reading.t if reading.from_t is None else reading.from_t
            if start_t >= self.since_t.get(reading.node, math.inf):
                continue
            self.since_t[reading.node] = start_t
            if SELDOM_S < reading.t - start_t <= physics.REPORT_LONGEST_S:
                found.append(Awaited(t=start_t, node=reading.node, told_t=reading.t))
        return found
