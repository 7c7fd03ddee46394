"""What the fixes of somebody who flies have in common: what they are off by, and how late they are told.

Much of what a fix of satellites is off by stays for half an hour: orbits, clocks, the ionosphere, the base
that corrections come from, the origin that places count from. And a place is told some time after it was.
"""

from typing import NamedTuple, Self

import msgspec
import numpy as np
from msgspec.structs import replace

from estimator.graph.dense import Array

OFFSET_NUMBERS, LATE_NUMBER = 3, 3
"""A receiver has four numbers: what it is off by, east, north and up, and how late it is."""
OFFSET, LATE = slice(0, 2), slice(LATE_NUMBER, LATE_NUMBER + 1)
"""Which of them are asked about: what it is off by in the plane, and how late it is."""


class Doubt(NamedTuple):
    """Numbers of a receiver that may be of another kind than they are taken for.

    Attributes:
        own: which of the four.
        moment: second moment about what they are thought to be, beyond their covariance, k × k.
    """

    own: slice
    moment: Array


class Receiver(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """What is known beforehand of the fixes of one receiver.

    Attributes:
        node: who carries it.
        sigma: standard deviations of what they are off by, east, north, up (m), and of how late they are (s).
        late_s: by so much they have been put back, of what they were told late.
        told_m: standard deviation with which they are told, in the plane (m).
        elsewhere_m2: second moment of what they may be off by, if they are of the other kind, beyond its
            covariance: of east, of both, of north (m²).
        later_s2: the same of how late they may be (s²).
    """

    node: str
    sigma: tuple[float, float, float, float]
    told_m: float
    late_s: float = 0.0
    elsewhere_m2: tuple[float, float, float] = (0.0, 0.0, 0.0)
    later_s2: float = 0.0

    @property
    def mean(self) -> Array:
        """What its four numbers are beforehand: it is late by nothing but what it was put back by."""
        return np.array([0.0, 0.0, 0.0, -self.late_s])

    @property
    def doubts(self) -> list[Doubt]:
        """What is doubted of it."""
        ee, en, nn = self.elsewhere_m2
        moments = Doubt(OFFSET, np.array([[ee, en], [en, nn]])), Doubt(LATE, np.array([[self.later_s2]]))
        return [one for one in moments if one.moment.any()]

    def believed(self) -> Self:
        """The same with nothing in doubt."""
        return replace(self, elsewhere_m2=(0.0, 0.0, 0.0), later_s2=0.0)
