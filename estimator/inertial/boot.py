"""A boot between two samples: where its navigation has got to, and how well that is known."""

from typing import NamedTuple, Self

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.footholds import new_footholds
from estimator.inertial.zero_velocity import BEFORE

GRAVITY_MPS2 = 9.80665
TOLD = 12
"""Numbers gathered while a boot is levelled: samples, forces 3, rates 3, their squares, seconds, and those of
the rates' second half less those of its first, 3."""
CLIPPED = 48
"""Numbers that are remembered of the ends of its sensors' ranges, see `saturation.hidden_peak`."""
ERRORS = 18
"""Place, velocity, attitude, biases and scales of accelerometers, biases of gyros (3 each)."""
VELOCITY, ATTITUDE, FORCE, SCALE, RATE = 3, 6, 9, 12, 15
"""Where each begins among the errors."""
GRAVITY, HEADING, AXIS, AZIMUTH, TURNED_RAD, FARTHEST_RAD, TURNED_RAD2 = range(7)
"""What `known` holds."""
HELD_S, STOOD, FOOTHOLD_M, FLAT_M, FLAT_M2 = range(5)
"""What `footing` holds."""
BRANCHED_M, APART_M, GLIDES_MPS, GLID_M, MOVED_M2, SINCE_S, RESTLESS_S, STRIDES = 0, 3, 5, 7, 9, 11, 12, 13
REJECTED_MPS, BLOWN_M2PS4 = 14, 15
"""Where each begins in `comparison`."""
RATES, SQUARES, SECONDS, BIAS_RADPS, CHANGED, RESTED_S = 0, 3, 4, 5, 6, 7
"""Where each begins in `gyros`."""


class Strapdown(NamedTuple):
    """Inertial navigation between two samples. Its frame has z up, and x where its heading says.

    Attributes:
        attitude: from the sensor's axes to the frame's, 3 × 3.
        velocity: 3 (m/s).
        place: 3 (m).
        sensors: biases (m/s²) and scales of its accelerometers, biases of its gyros (rad/s), in its axes, 9.
        covariance: of the errors, what is true less what is told, see `ERRORS`, 18 × 18.
    """

    attitude: Array
    velocity: Array
    place: Array
    sensors: Array
    covariance: Array

    @classmethod
    def new(cls) -> Self:
        """One that nothing is known of yet."""
        return cls(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(9), np.zeros((ERRORS, ERRORS)))


class Boot(NamedTuple):
    """A boot's navigation between two samples.

    Attributes:
        held: its navigation, held by whatever looks like a standstill. Its sensors are what they were told
            to be, and no states.
        free: navigation from where it last rested, held by nothing but rests: its place counts from there.
            What its sensors are off by are states of it.
        stance: what the last samples were like, see `zero_velocity.add_sample`.
        levelling: what is gathered while it is levelled, see `TOLD`; its first number is −1 afterwards.
        known: gravity as the unit feels it (m/s²); what its x axis faced when it last stood (rad); which of
            its axes tells that, the most level one; and that one's direction less the x axis' (rad). By how
            much it has turned since it began, to the left, whole turns included (rad); the most that this has
            been to either side (rad); and what that adds to the variance of its heading (rad²): 7.
        footing: how long ago a standstill last held it (s); how many standstills in a row have held it; how
            high its last foothold was (m); how far it would have risen were floors not flat (m); and what
            that adds to the variance of its height (m²): 5.
        comparison: of `held` and `free`. Where it was when `free` began, 3 (m); then, across and up each: how
            far apart the two have been told to be (m); how fast it glides though it seems to stand, and
            nobody knows how far (m/s); how far that may have led (m); and what all this adds to the variance
            of its place (m²). How long ago `free` began (s); for how long it has seemed to stand, but not to
            rest (s); and since `free` began: strides, how fast it was when a rest was not believed (m/s), and
            by how much its force has changed from one sample to the next, squared (m²/s⁴): 16.
        unheld: velocity (m/s) and way (m) that it seems to have while it stands, 6: that may move, too.
        gyros: what they have reported in this rest, summed up: rates 3, their squares, seconds; how well
            their biases are known (rad/s); what the bias of its heading is less sure by than of one that has
            rested at first ((rad/s)²); and how long ago a rest has told it, if that is still to be said
            (s): 8.
        clipped: what is known of the ends of its sensors' ranges, see `saturation.hidden_peak`.
        footholds: when and where it stood, see `footholds.NOW_S`.
    """

    held: Strapdown
    free: Strapdown
    stance: Array
    levelling: Array
    known: Array
    footing: Array
    comparison: Array
    unheld: Array
    gyros: Array
    clipped: Array
    footholds: Array

    @classmethod
    def new(cls, heading_rad: float) -> Self:
        """One that nothing is known of yet, but what its x axis faces."""
        return cls(
            Strapdown.new(),
            Strapdown.new(),
            BEFORE.copy(),
            np.zeros(TOLD),
            np.array([GRAVITY_MPS2, heading_rad, 0.0, 0.0, 0.0, 0.0, 0.0]),
            np.zeros(5),
            np.zeros(16),
            np.zeros(6),
            np.zeros(8),
            np.zeros(CLIPPED),
            new_footholds(),
        )

    def to_level_again(self) -> Self:
        """The same unit to be levelled again, with its biases and the heading at which it last stood."""
        again = self.new(self.heading_rad)
        again.known[AXIS:] = self.known[AXIS:]
        again.footing[FLAT_M] = self.footing[FLAT_M]
        again.held.sensors[:] = self.held.sensors
        again.known[GRAVITY] = self.known[GRAVITY]
        again.comparison[GLIDES_MPS : GLID_M + 2] = self.comparison[GLIDES_MPS : GLID_M + 2]
        again.gyros[BIAS_RADPS] = self.gyros[BIAS_RADPS]
        again.clipped[:] = self.clipped
        return again

    def copy(self) -> Self:
        """An independent copy."""
        held, free, *rest = self
        one, other = (Strapdown(*(array.copy() for array in each)) for each in (held, free))
        return type(self)(one, other, *(array.copy() for array in rest))

    @property
    def levelled(self) -> bool:
        """Whether its attitude is known: before that nothing is navigated."""
        return bool(self.levelling[0] < 0.0)

    @property
    def to_be_levelled(self) -> bool:
        """Whether it waits to be levelled again after a gap, with no sample gathered yet."""
        return bool(self.levelling[0] == 0.0 and self.gyros[BIAS_RADPS] > 0.0)

    @property
    def heading_rad(self) -> float:
        """What its x axis faced when it last stood, seen from above (rad)."""
        return float(self.known[HEADING])
