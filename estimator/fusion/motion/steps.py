"""What the displacements of one unit add up to within a tick."""

import math
from typing import NamedTuple

from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.learned.gait import STRIDE_S, Gait
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.motion.coasting import mark_after, missed_m2, onward_m
from estimator.fusion.motion.long_displacements import STRAIGHT_S, WALKED_MPS, turned_m2, walked_m
from estimator.fusion.motion.recent_places import Mark
from estimator.fusion.motion.silence import LONGEST_S, unheard_m2, went_on
from estimator.fusion.motion.told_biases import SET_OFF_RAD2PS2, ToldBias, ToldBiases
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.strapdown import RATE_WALK
from estimator.measurements.displacement import Displacement

TRAIL_S = 4.0
FIRST_DURATION_S = 1.0
AGAIN_S = 1.5
"""What a displacement tells again of an earlier one is no longer, or nobody knows how much of it is new."""
IMPOSSIBLE = 10.0
"""So many times as far as anybody gets is no way at all: a unit at fault, or told in millimetres."""
WHOLE_OFF_S = 0.02
"""Displacements whose epochs are apart by no more follow each other."""
WALK_M2_PER_M, STAND_M2_PER_S = physics.WALK_M_PER_ROOT_M**2, physics.STAND_M_PER_ROOT_S**2
FLOOR_M2, CLIMB_M2_PER_M = physics.DISPLACEMENT_FLOOR_M**2, physics.CLIMB_M_PER_ROOT_M**2
TURN_RAD2_PER_M = physics.HEADING_WALK_RAD_PER_ROOT_M**2
TURN_RAD2_PER_S = physics.GYRO_WALK_RAD_PER_ROOT_S**2
BIAS_PER_S, SCALE_PER_S = physics.BIAS_WALK_RADPS_PER_ROOT_S**2, physics.SCALE_WALK_PER_ROOT_S**2
WARMING_PER_S = RATE_WALK**2
Noise = tuple[float, float, float, float, float, float]
"""Variances of east, north, up (m²), ψ (rad²), β (rad²/s²) and s."""
NOTHING = (0.0,) * 6
SET_OFF: Noise = (0.0, 0.0, 0.0, 0.0, SET_OFF_RAD2PS2, 0.0)
"""What a bias is unsure by of which a standstill has told, once its bearer goes."""


class Increment(NamedTuple):
    """What one displacement adds to a unit's way.

    Attributes:
        since_t: epoch that the unit's position referred to before it (s).
        delta_m: displacement in the unit's frame (m).
        noise: variances that it adds.
        biases: what standstills and straight legs tell, those that have ended or lasted long.
        too_fast: nobody moves so far in its time.
        gait: how its bearer goes now, where that has changed.
    """

    since_t: float
    delta_m: Vector3
    noise: Noise
    biases: tuple[ToldBias, ...]
    too_fast: bool
    gait: Gait | None


class Step:
    """What one unit has moved in one tick: it takes one displacement after the other.

    Attributes:
        node: the unit, before the step.
        delta_m: displacement in the unit's frame (m).
        duration_s: time that it took (s).
        noise: variances that it adds.
        changed_m: way of the gait that has changed, in the unit's frame: east, north (m).
        taken: it has taken any.
    """

    def __init__(self, node: NodeState) -> None:
        self.node = node
        self.delta_m: Vector3 = (0.0, 0.0, 0.0)
        self.duration_s = 0.0
        self.noise: Noise = NOTHING
        self.changed_m = (0.0, 0.0)
        self._pose_t, self._unit_t, self._report_s = node.pose_t, node.unit_t, node.report_s
        self._heading_rad, self._speed_mps = node.unit_heading_rad, node.speed_mps
        self._way_m, self._faced, self._biases = node.way_m, node.faced, ToldBiases(node)
        self._level, self._unseen_up_m2 = node.level, node.unseen_up_m2
        self._marks: list[Mark] = list(node.trail or ((node.pose_t, 0.0, 0.0, 0.0),))
        self._whole_t, self._missed_s, self._gait = node.whole_t, node.missed_s, node.gait
        self.taken = False

    @property
    def straight(self) -> StraightLegs:
        """What straight legs have told of its gyro so far."""
        return self._biases.straight

    def take(self, reading: Displacement) -> Increment | None:
        """Hold a displacement against what its unit reported before; None where that covers it."""
        t, pose_t, unit_t = reading.t, self._pose_t, self._unit_t
        raw = type(reading) is InertialDisplacement
        if t < pose_t or (unit_t is not None and t <= unit_t) or self.tells_again(reading):
            return None
        start = start_of(reading, pose_t if unit_t is None else unit_t)
        e, n, u = reading.delta_m
        duration = min(t - pose_t, LONGEST_S)
        own = self._report_s = max(t - start, 0.0)
        length = math.sqrt(e * e + n * n + u * u)
        across = up = 0.0
        onward: Vector3 = (0.0, 0.0, 0.0)
        if start < pose_t:
            share = duration / own
            across = up = (0.5 * share * (1.0 - share) * length) ** 2
            e, n, u, length, own = e * share, n * share, u * share, length * share, duration
        elif start > pose_t:
            gap_s = min(start - pose_t, LONGEST_S)
            untold_m2 = missed_m2(gap_s, self._missed_s, raw)
            across = max((physics.GAP_MPS * gap_s) ** 2, untold_m2)
            up = 0.1 * across
            onward = onward_m(self._marks, gap_s, 0.0)
            self._missed_s += gap_s
        if unit_t is None or start > unit_t + WHOLE_OFF_S or self._whole_t > start:
            self._whole_t = start
        if t - self._whole_t > STRIDE_S - WHOLE_OFF_S:
            self._missed_s = 0.0
        farthest_m = physics.FASTEST_MPS * max(own, physics.TICK_S)
        too_fast = length > farthest_m
        if length > IMPOSSIBLE * farthest_m:
            # It tells nothing: he may have gone anywhere meanwhile.
            e = n = u = length = 0.0
            anywhere_m2 = (physics.FASTEST_MPS * min(max(own, physics.TICK_S), LONGEST_S)) ** 2
            across, up = across + anywhere_m2, up + anywhere_m2
        elif too_fast:
            across, up = across + length**2, up + length**2
        still = own > 0.0 and not too_fast and length < physics.STILL_MPS * own and start <= pose_t
        sets_off = self._biases.stand(reading, still)
        if type(reading) is InertialDisplacement:
            up += reading.up_m2 + (physics.STRAPDOWN_SCALE_SIGMA * u) ** 2
        else:
            up += (physics.SCALE_SIGMA * u) ** 2
        up += self._climb_m2(reading, length)
        walked = length if raw else walked_m(length, own)
        noise = walk_noise((across, across, up), reading, walked, duration)
        if own > STRAIGHT_S and not raw:
            unseen = turned_m2(own, noise[3], self.node.bias_told)
            noise = sum_of(noise, (unseen, unseen, 0.0, 0.0, 0.0, 0.0))
        if sets_off:
            noise = sum_of(noise, SET_OFF)
        gait_before = self._gait
        if not (raw or too_fast) and own > 0.0 and self.node.role == "responder":
            self._gait = self._gait.after(length, own)
        self._biases.walk(start, t, (e, n), noise[3] * max(self.node.walk_factors[1], 1.0))
        if own > 0.0:
            gone_m = math.hypot(e, n)
            self._speed_mps = gone_m / own
            if self._speed_mps > physics.GOES_MPS:
                self._faced = e / gone_m, n / gone_m
        rise = 0.0 if raw else self.node.rises
        u -= rise * math.hypot(e, n)
        e, n, u = e + onward[0], n + onward[1], u + onward[2]
        self._pose_t = self._unit_t = t
        self._heading_rad, self.taken = reading.heading_rad, True
        self._way_m += length
        self._marks.append(mark_after(self._marks[-1], t, (e, n, u)))
        before_e, before_n, before_u = self.delta_m
        self.delta_m = before_e + e, before_n + n, before_u + u
        self.duration_s += duration
        self.noise = sum_of(self.noise, self._as_learned(noise, reading))
        # The window takes off anew what heights rise by themselves.
        told_m = e, n, u + rise * math.hypot(e, n)
        gait = self._gait if self._gait.changes(gait_before) else None
        return Increment(pose_t, told_m, noise, self._biases.take(), too_fast, gait)

    def tells_again(self, reading: Displacement) -> bool:
        """Whether a displacement sums up so much that its unit has told that the rest is anybody's guess."""
        from_t = reading.from_t
        return from_t is not None and self._unit_t is not None and from_t < self._unit_t - AGAIN_S

    def pace_mps(self) -> Vector3:
        """How fast the bearer has gone in the last stride, in the unit's frame: east, north, up (m/s)."""
        return self._went_m(1.0)

    def go_on(self, t: float) -> None:
        """Let the bearer go on as he went, up to an epoch `t` (s) that no displacement has covered yet."""
        along_s, across_m2 = went_on(t - self._pose_t)
        self.delta_m, self.duration_s = self._went_m(along_s), t - self._pose_t
        self.noise = across_m2, across_m2, 0.1 * across_m2, 0.0, 0.0, 0.0
        self._marks.append(mark_after(self._marks[-1], t, self.delta_m))
        self._pose_t, self.taken = t, True

    def _went_m(self, span_s: float) -> Vector3:
        """How far he goes in a time at the velocity of the last stride (m)."""
        last_t, *last = self._marks[-1]
        before_t, *before = next(
            (m for m in self._marks[-2::-1] if m[0] <= last_t - STRIDE_S), self._marks[0]
        )
        share = span_s / (last_t - before_t) if last_t > before_t else 0.0
        e, n, u = (share * (two - one) for one, two in zip(before, last, strict=True))
        return e, n, u

    def _as_learned(self, noise: Noise, reading: Displacement) -> Noise:
        """Variances between two solutions of the window: of a worse unit than assumed, as it has shown.

        Of a better one the assumed ones are kept: little is to be gained until the next solution.
        """
        by_place, by_turn = self.node.walk_factors
        if by_place <= 1.0 and by_turn <= 1.0:
            return noise
        e, n, u, psi, beta, scale = noise
        across = max(by_place, 1.0) if reading.sigma_m is None else 1.0
        return e * across, n * across, u, psi * max(by_turn, 1.0), beta, scale

    def _climb_m2(self, reading: Displacement, length: float) -> float:
        """What a displacement's height is unsure by because its unit measures none (m²).

        Where nothing else tells heights, the Kirchhoff matrix keeps to the plane until distances contradict
        it, for the unit may yet show that it measures them; what it may have missed is told beside
        (decision 0012).
        """
        if reading.delta_m[2] != 0.0 or type(reading) is InertialDisplacement:
            self._level, self._unseen_up_m2 = False, 0.0
        climbed_m2 = CLIMB_M2_PER_M * length if self._level else 0.0
        self._unseen_up_m2 += climbed_m2
        if not self.node.heights:
            return climbed_m2 if self.node.climbs else 0.0
        climb_m2, self._unseen_up_m2 = self._unseen_up_m2, 0.0
        return climb_m2

    def after(self, trail_s: float = TRAIL_S) -> NodeState:
        """The unit after the step, with its way for so long at least (s)."""
        node, marks, t = self.node, self._marks, self._pose_t
        if not self.taken:
            return node
        oldest, last = 0, len(marks) - 1
        while oldest < last and marks[oldest][0] < t - trail_s:
            oldest += 1
        return replace(
            node,
            t=max(node.t, t),
            pose_t=t,
            unit_t=self._unit_t,
            report_s=self._report_s,
            unit_heading_rad=self._heading_rad,
            speed_mps=self._speed_mps,
            faced=self._faced,
            trail=tuple(marks[max(oldest - 1, 0) :]),
            still=self._biases.still,
            straight=self._biases.straight,
            way_m=self._way_m,
            level=self._level,
            unseen_up_m2=self._unseen_up_m2,
            whole_t=self._whole_t,
            missed_s=self._missed_s,
            gait=self._gait,
        )


def walk_noise(known: Vector3, reading: Displacement, length: float, duration: float) -> Noise:
    """Variances of a displacement.

    Args:
        known: what else its place is unsure by: of east, north, up (m²).
        reading: the displacement; one that samples have made knows its own noise.
        length: of what counts of it (m).
        duration: the same (s).
    """
    e, n, u = known
    step = WALK_M2_PER_M * length if reading.sigma_m is None else reading.sigma_m**2
    position = step + STAND_M2_PER_S * duration + FLOOR_M2
    if type(reading) is InertialDisplacement:
        heading, bias = reading.turned_rad2, WARMING_PER_S * duration + reading.bias_rad2ps2
    else:
        heading, bias = TURN_RAD2_PER_M * length + TURN_RAD2_PER_S * duration, BIAS_PER_S * duration
    return e + position, n + position, u + position, heading, bias, SCALE_PER_S * duration


def unseen_noise(span_s: float, since_s: float) -> Noise:
    """Variances of a time of which a unit has told nothing: its bearer walks about (`silence.unheard_m2`).

    Args:
        span_s: how long it lasts (s).
        since_s: how long the unit has reported nothing before that (s); infinite: nobody knows.
    """
    across = unheard_m2(span_s, since_s)
    span = min(max(span_s, 0.0), LONGEST_S)
    turn = (TURN_RAD2_PER_M * WALKED_MPS + TURN_RAD2_PER_S) * span
    return across, across, 0.1 * across, turn, BIAS_PER_S * span, SCALE_PER_S * span


def start_of(reading: Displacement, pose_t: float | None) -> float:
    """Epoch at which a displacement begins; `pose_t`: where it does not tell; None: nothing was before."""
    if reading.from_t is not None:
        return reading.from_t
    return reading.t - FIRST_DURATION_S if pose_t is None else pose_t


def sum_of(one: Noise, other: Noise) -> Noise:
    """The variances of two displacements, one after the other."""
    e, n, u, psi, beta, scale = one
    more_e, more_n, more_u, more_psi, more_beta, more_scale = other
    return e + more_e, n + more_n, u + more_u, psi + more_psi, beta + more_beta, scale + more_scale
