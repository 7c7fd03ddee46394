"""Walking straight tells the gyro bias, roughly: heuristic drift reduction (HDR; decision 0120).

People walk along walls, corridors and hoses: a way that seems straight, but for a slow turn, mostly is
straight, and the turn is the unit's (Borenstein, Ojeda and Kwanmuang 2009, "Heuristic Reduction of Gyro Drift
in IMU-based Personnel Tracking Systems"). Nobody walks quite straight: a leg of length L that leaves its
chord by s in the middle turns by 8 s / L from end to end, so that a short one tells nothing.

How straight somebody's legs are they show themselves: by what the biases that they tell differ.
"""

import math
from typing import Self

import msgspec

from estimator.fusion import physics
from estimator.fusion.learned.heading_line import Bias, HeadingLine


class Leg(msgspec.Struct, frozen=True, array_like=True):
    """A way without a corner that somebody is on, as chords of a second or more.

    Attributes:
        mark_t: epoch since when displacements are not yet part of a chord (s).
        chord_m: what they add up to, in the unit's frame: east, north (m).
        line: directions of the chords, in the unit's frame, each at its middle.
        newest: epoch (s) and direction (rad) of the one after them: it may be half in a corner.
        way_m: how long all of them are (m).
        walk_rad2: variance that the angle of the unit's frame has gained on them (rad²).
    """

    mark_t: float
    chord_m: tuple[float, float] = (0.0, 0.0)
    line: HeadingLine | None = None
    newest: tuple[float, float] | None = None
    way_m: float = 0.0
    walk_rad2: float = 0.0

    def bias(self) -> Bias | None:
        """The bias that it shows, on a way that is as straight as ways are; None where it shows none."""
        line = self.line
        if line is None or line.number < physics.STILL_READINGS:
            return None
        value, sigma = line.bias(physics.CHORD_JITTER_RAD, self.walk_rad2 / line.lasted_s)
        return Bias(value, math.hypot(sigma, 8.0 * physics.SAGITTA_M / (self.way_m * line.lasted_s)))


class StraightLegs(msgspec.Struct, frozen=True, array_like=True):
    """What the straight legs of a unit's bearer have told of its gyro's bias.

    Attributes:
        leg: the one that he is on.
        number: how many are over.
        sums: of the biases b that they showed with variances v: Σ 1/v, Σ b/v, Σ b²/v (s²/rad², s/rad, 1).
    """

    leg: Leg | None = None
    number: int = 0
    sums: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def bent(self) -> float:
        """Variance of the biases that they show, over what ways are bent by: at least 1."""
        if self.number < 2:
            return 1.0
        one, two, three = self.sums
        usual = physics.STRAIGHT_LEGS
        return max((usual + three - two**2 / one) / (usual + self.number - 1.0), 1.0)

    @property
    def shared_rad2ps2(self) -> float:
        """What each of them is unsure by for all may be bent alike, so that all together are no surer."""
        return self.number * physics.STRAIGHT_SHARED_RADPS**2

    def sigma_radps(self, sigma_radps: float) -> float:
        """Standard deviation of a bias that one of them shows, beside all others (rad/s).

        Args:
            sigma_radps: the same were they as straight as ways are, and no other one bent like it (rad/s).
        """
        return math.sqrt(self.bent * sigma_radps**2 + self.shared_rad2ps2)

    def walked(
        self, start_t: float, t: float, moved_m: tuple[float, float], walk_rad2: float
    ) -> tuple[Self, Bias | None]:
        """Their bearer walks on.

        Args:
            start_t: epoch at which a displacement begins (s).
            t: epoch at which it ends (s).
            moved_m: the displacement in the unit's frame: east, north (m).
            walk_rad2: variance that the angle of that frame gains meanwhile (rad²).

        Returns:
            What they have told then, and the bias that a leg tells which is over, or has gone on for long.
        """
        leg = self.leg
        if leg is None:
            return self._with_leg(Leg(t)), None
        if start_t > leg.mark_t + physics.CHORD_LONGEST_S or t - start_t > physics.CHORD_LONGEST_S:
            return self._over(leg, t)
        east, north = leg.chord_m[0] + moved_m[0], leg.chord_m[1] + moved_m[1]
        length, span_s = math.hypot(east, north), t - leg.mark_t
        leg = msgspec.structs.replace(leg, chord_m=(east, north), walk_rad2=leg.walk_rad2 + walk_rad2)
        if span_s < physics.CHORD_S or length < physics.CHORD_M:
            return self._over(leg, t) if span_s > physics.CHORD_LONGEST_S else (self._with_leg(leg), None)
        facing, middle_t = math.atan2(north, east), t - 0.5 * span_s
        line = _with_newest(leg)
        if line is not None and _turns(line, facing):
            return self._over(leg, t)
        leg = Leg(t, (0.0, 0.0), line, (middle_t, facing), leg.way_m + length, leg.walk_rad2)
        if line is None or line.lasted_s < physics.STILL_LONG_S:
            return self._with_leg(leg), None
        return self._over(leg, t)

    def _with_leg(self, leg: Leg) -> Self:
        return msgspec.structs.replace(self, leg=leg)

    def _over(self, leg: Leg, t: float) -> tuple[Self, Bias | None]:
        """A leg is over, and another one begins."""
        after, bias = self._with_leg(Leg(t)), leg.bias()
        if bias is None or bias.sigma > physics.BIAS_SIGMA_MOST_RADPS:
            return after, None
        (one, two, three), known = self.sums, bias.sigma**-2
        sums = one + known, two + known * bias.value, three + known * bias.value**2
        curved = abs(bias.value) > physics.BIAS_SIGMA_MOST_RADPS + 2.0 * bias.sigma
        return type(self)(after.leg, self.number + 1, sums), None if curved else bias


def _with_newest(leg: Leg) -> HeadingLine | None:
    """The directions of all chords of a leg; None: it has none."""
    if leg.newest is None:
        return leg.line
    t, facing = leg.newest
    return HeadingLine(t, t, facing) if leg.line is None else leg.line.extended(t, facing)


def _turns(line: HeadingLine, facing_rad: float) -> bool:
    """Whether who goes that way has turned a corner, at once or by and by."""
    return max(abs(line.step_rad(facing_rad)), abs(line.off_rad(facing_rad))) > physics.CORNER_RAD
