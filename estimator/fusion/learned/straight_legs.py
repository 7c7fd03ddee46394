"""Walking straight tells the gyro bias, roughly: heuristic drift reduction (HDR; decision 0120).

People walk along walls, corridors and hoses: a way that seems straight, but for a slow turn, mostly is
straight, and the turn is the unit's (Borenstein, Ojeda and Kwanmuang 2009, "Heuristic Reduction of Gyro Drift
in IMU-based Personnel Tracking Systems"). Nobody walks quite straight: a leg of length L that leaves its
chord by s in the middle turns by 8 s / L from end to end, so that a short one tells nothing.

How straight somebody's legs are they show themselves: by what the biases that they tell differ. A leg tells
while it is under way, each time what it has not told yet.
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
        told: what has been told of the bias b that it shows, with variance v: 1/v, b/v (s²/rad², s/rad).
    """

    mark_t: float
    chord_m: tuple[float, float] = (0.0, 0.0)
    line: HeadingLine | None = None
    newest: tuple[float, float] | None = None
    way_m: float = 0.0
    walk_rad2: float = 0.0
    told: tuple[float, float] = (0.0, 0.0)

    def bias(self) -> Bias | None:
        """The bias that it shows, on a way that is as straight as ways are; None where it shows none."""
        line = self.line
        if line is None or line.number < physics.STILL_READINGS:
            return None
        value, sigma = line.bias(physics.CHORD_JITTER_RAD, self.walk_rad2 / line.lasted_s)
        sigma = math.hypot(sigma, 8.0 * physics.SAGITTA_M / (self.way_m * line.lasted_s))
        return None if sigma > physics.BIAS_SIGMA_MOST_RADPS else Bias(value, sigma)

    def beyond(self, bias: Bias) -> Bias | None:
        """What the bias that it shows tells beyond what it has told; None: less than is known of any gyro."""
        known, before = bias.sigma**-2, self.told[0]
        if known - before < physics.BIAS_SIGMA_MOST_RADPS**-2:
            return None
        return Bias((known * bias.value - self.told[1]) / (known - before), (known - before) ** -0.5)


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
    def unsurer(self) -> float:
        """By what the variance v of each of them is multiplied beside all others.

        All may be bent alike, by c² of variance: then they tell 1 / (1 / Σ 1/v + c²) together, as those with
        v (1 + c² Σ 1/v) do that are bent each by itself.
        """
        told = self.sums[0] + self._under_way[0]
        return self.bent + told * physics.STRAIGHT_SHARED_RADPS**2

    @property
    def _under_way(self) -> tuple[float, float]:
        """What the leg has told that its bearer is on: see `Leg.told`."""
        return (0.0, 0.0) if self.leg is None else self.leg.told

    def has_told_more(self, before: Self) -> bool:
        """Whether they have told anything since then: else `unsurer` is what it was."""
        return self.sums != before.sums or self._under_way != before._under_way

    def sigma_radps(self, sigma_radps: float) -> float:
        """Standard deviation of a bias that one of them shows, beside all others (rad/s).

        Args:
            sigma_radps: the same were they as straight as ways are, and no other one bent like it (rad/s).
        """
        return math.sqrt(self.unsurer) * sigma_radps

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
            What they have told then, and the bias that a leg tells beyond what it has told before.
        """
        leg = self.leg or Leg(start_t)
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
        leg = Leg(t, (0.0, 0.0), line, (middle_t, facing), leg.way_m + length, leg.walk_rad2, leg.told)
        if line is None or line.lasted_s < physics.STILL_LONG_S:
            return self._onward(leg)
        return self._over(leg, t)

    def _with_leg(self, leg: Leg) -> Self:
        return msgspec.structs.replace(self, leg=leg)

    def _onward(self, leg: Leg) -> tuple[Self, Bias | None]:
        """A leg goes on: it tells once it has shown twice as much; what turns faster than gyros do waits."""
        bias = leg.bias()
        if bias is None or abs(bias.value) > physics.BIAS_SIGMA_MOST_RADPS:
            return self._with_leg(leg), None
        known = bias.sigma**-2
        more = leg.beyond(bias) if known > physics.STRAIGHT_MORE * leg.told[0] else None
        told = leg.told if more is None else (known, known * bias.value)
        return self._with_leg(msgspec.structs.replace(leg, told=told)), more

    def _over(self, leg: Leg, t: float) -> tuple[Self, Bias | None]:
        """A leg is over, and another one begins."""
        bias, more = leg.bias(), None
        known, product = leg.told
        if bias is not None:
            curved = abs(bias.value) > physics.BIAS_SIGMA_MOST_RADPS + 2.0 * bias.sigma
            more = None if curved else leg.beyond(bias)
            if curved or more is not None:
                known = bias.sigma**-2
                product = known * bias.value
        if known == 0.0:
            return self._with_leg(Leg(t)), None
        one, two, three = self.sums
        sums = one + known, two + product, three + product**2 / known
        return type(self)(Leg(t), self.number + 1, sums), more


def _with_newest(leg: Leg) -> HeadingLine | None:
    """The directions of all chords of a leg; None: it has none."""
    if leg.newest is None:
        return leg.line
    t, facing = leg.newest
    return HeadingLine(t, t, facing) if leg.line is None else leg.line.extended(t, facing)


def _turns(line: HeadingLine, facing_rad: float) -> bool:
    """Whether who goes that way has turned a corner, at once or by and by."""
    return max(abs(line.step_rad(facing_rad)), abs(line.off_rad(facing_rad))) > physics.CORNER_RAD
