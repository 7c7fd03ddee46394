"""What is known of a responder whose radio and unit are not in one place."""

from typing import Self

import msgspec
import numpy as np

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.measurements.displacement import Displacement

SHARE = 0.5
"""How likely it is that the bearer is where his unit is: nothing tells which of both he still carries."""
TOGETHER_M = 0.5
"""Where both were together is known so well."""
SIGMAS = 3.0
SPAN_S = 20.0
"""Ways of the last seconds that are held against each other: long enough for some corners, or a room."""


class SeparatedUnit(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """A unit that goes elsewhere than the radio of its name: the node is where its radio is.

    Attributes:
        since_t: when both were together for the last time (s).
        place_m: where that was: east, north (m).
        turn_rad: ψ of the unit's frame then (rad).
        marks: epochs, and displacements summed up to them in the unit's frame, east and north: the newest
            seconds only.
    """

    since_t: float
    place_m: tuple[float, float]
    turn_rad: float
    marks: tuple[tuple[float, float, float], ...]

    def going(self, reading: Displacement) -> Self:
        """After another displacement of the unit, in the frame that ψ counts from; late ones are left out."""
        last_t, east, north = self.marks[-1]
        if reading.t <= last_t:
            return self
        mark = (reading.t, east + reading.delta_m[0], north + reading.delta_m[1])
        kept = [one for one in self.marks if one[0] > reading.t - 2.0 * SPAN_S]
        return msgspec.structs.replace(self, marks=(*kept, mark))

    def led(self, t: Array) -> Array:
        """Displacement of the unit up to epochs (s), in its frame: east, north, m × 2 (m)."""
        marks = np.array(self.marks)
        return np.column_stack([np.interp(t, marks[:, 0], marks[:, c]) for c in (1, 2)])

    def doubt_m2(self, place_m: Array) -> Array:
        """What it adds to the covariance of a place that the bearer may be where his unit is, 3 × 3 (m²).

        Args:
            place_m: where the radio is: east, north (m).
        """
        off_m, unsure_m2 = self._off(place_m)
        found = np.zeros((3, 3))
        found[:2, :2] = SHARE * (np.outer(off_m, off_m) + unsure_m2 * np.eye(2))
        return found

    def reaches(self, place_m: Array) -> bool:
        """Whether the unit may be where the radio is: east, north (m)."""
        off_m, unsure_m2 = self._off(place_m)
        return float(off_m @ off_m) < SIGMAS**2 * unsure_m2

    def _off(self, place_m: Array) -> tuple[Array, float]:
        """From a place to where the unit is, 2 (m), and the variance of that along each axis (m²)."""
        _, east, north = self.marks[-1]
        cosine, sine = np.cos(self.turn_rad), np.sin(self.turn_rad)
        gone_m = np.array([cosine * east - sine * north, sine * east + cosine * north])
        unsure_m2 = TOGETHER_M**2 + (physics.TURNED_SIGMA_RAD * float(np.hypot(*gone_m))) ** 2
        return np.array(self.place_m) + gone_m - place_m, unsure_m2
