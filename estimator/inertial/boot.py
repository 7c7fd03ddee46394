"""A boot between two samples: where its navigation has got to, and how well that is known."""

from typing import NamedTuple, Self

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.stance import BEFORE

GRAVITY_MPS2 = 9.80665
TOLD = 9
"""Numbers gathered while a boot is levelled: samples, forces 3, rates 3, their squares, seconds."""
ERRORS = 9
"""Place, velocity, attitude (3 each)."""
GRAVITY, HEADING, AXIS, AZIMUTH = range(4)
"""What `known` holds."""
HELD_S, STOOD, RISE_M, FLAT_M, FLAT_M2 = range(5)
"""What `footing` holds."""


class Strapdown(NamedTuple):
    """A boot's navigation between two samples. The frame has z up, and x where `heading_rad` says.

    Attributes:
        attitude: from the sensor's axes to the frame's, 3 × 3.
        velocity: 3 (m/s).
        place: 3 (m).
        covariance: of the errors of place, velocity and attitude, 9 × 9.
        bias: of the gyros, 3 (rad/s).
        felt: what the last samples were like, see `stance.felt_by`.
        told: what is gathered while it is levelled, see `TOLD`; its first number is −1 afterwards.
        known: gravity as the unit feels it (m/s²); what its x axis faced when it last stood (rad); which of
            its axes tells that, the most level one; and that one's direction less the x axis' (rad): 4.
        footing: how long ago a standstill last held it (s); how many standstills in a row have held it; how
            far it is above its last foothold (m); how far it would have risen were floors not flat (m); and
            what that adds to the variance of its height (m²): 5.
        unheld: velocity (m/s) and way (m) that it seems to have while it stands, 6: that may move, too.
    """

    attitude: Array
    velocity: Array
    place: Array
    covariance: Array
    bias: Array
    felt: Array
    told: Array
    known: Array
    footing: Array
    unheld: Array

    @classmethod
    def new(cls, heading_rad: float) -> Self:
        """One that nothing is known of yet, but what its x axis faces."""
        nothing = np.zeros(3)
        return cls(
            np.eye(3),
            nothing,
            nothing.copy(),
            np.zeros((ERRORS, ERRORS)),
            nothing.copy(),
            BEFORE.copy(),
            np.zeros(TOLD),
            np.array([GRAVITY_MPS2, heading_rad, 0.0, 0.0]),
            np.zeros(5),
            np.zeros(6),
        )

    def anew(self) -> Self:
        """One that is to be levelled again, and faces what this one faced when it last stood."""
        again = self.new(self.heading_rad)
        again.known[AXIS], again.known[AZIMUTH] = self.known[AXIS], self.known[AZIMUTH]
        again.footing[FLAT_M] = self.footing[FLAT_M]
        return again

    def copy(self) -> Self:
        """Another one that may be changed."""
        return type(self)(*(array.copy() for array in self))

    @property
    def levelled(self) -> bool:
        """Whether it is known what is up: before that it navigates nothing."""
        return bool(self.told[0] < 0.0)

    @property
    def heading_rad(self) -> float:
        """What its x axis faced when it last stood, seen from above (rad)."""
        return float(self.known[HEADING])
