"""A boot that walks: its true places, and what an inertial unit on it feels."""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.graph.dense import Array
from estimator.inertial.boot import GRAVITY_MPS2
from estimator.measurements.imu import Imu

STEP_S = 0.005
HALF_S = 0.5 * STEP_S
"""Truth is told twice as finely: samples lie between the epochs at which it is."""
STANCE_S, SWING_S = 0.6, 0.5
STILL_M = 1e-9
"""A boot that moves no farther from one sample to the next stands."""
STEEPEST_RAD = 0.7
LIFTED_M = 0.12
HEEL_RAD, BALL_RAD = -0.15, 0.25
"""Pitch of a boot that comes down, and of one that leaves the ground."""


class Stride(NamedTuple):
    """From one foothold to the next: so far, so much to the left, so much up."""

    length_m: float = 1.3
    turn_rad: float = 0.0
    up_m: float = 0.0


class Gait(NamedTuple):
    """A walk.

    Attributes:
        t: epochs of its samples, n (s).
        force: specific force, n × 3 (m/s²).
        rate: angular rate, n × 3 (rad/s).
        place_m: where the boot is when each sample ends, n × 3 (m).
        heading_rad: what it faces in the end.
    """

    t: Array
    force: Array
    rate: Array
    place_m: Array
    heading_rad: float

    def imu(self, first: int = 0, last: int | None = None, node: str = "ff1") -> Imu:
        """Its samples as one reading."""
        some = slice(first, last)
        return Imu(
            t=float(self.t[first]),
            node=node,
            rate_hz=1.0 / STEP_S,
            accel_mps2=[tuple(row) for row in self.force[some].tolist()],
            gyro_radps=[tuple(row) for row in self.rate[some].tolist()],
        )

    def readings(self, each: int = 200, node: str = "ff1") -> list[Imu]:
        """Its samples, so many a reading."""
        return [self.imu(first, first + each, node) for first in range(0, len(self.t), each)]

    def bearer_m(self, t: float) -> Array:
        """Where its bearer is, 3 (m): he passes over it in the middle of a stance, and goes on evenly.

        Who stands is over it from half a stance after it has come down, until half a stance before it leaves.
        """
        moves = np.linalg.norm(np.diff(self.place_m, axis=0), axis=1) > STILL_M
        edges = np.flatnonzero(np.diff(np.concatenate([[True], moves, [True]]).astype(int)))
        passed = []
        for first, last in edges.reshape(-1, 2).tolist():
            half = min(round(0.5 * STANCE_S / STEP_S), (last - first) // 2)
            passed += [first, last] if len(edges) == 2 else sorted({first + half, last - half})
        places = self.place_m[passed]
        return np.array([np.interp(t, self.t[passed] + STEP_S, places[:, axis]) for axis in range(3)])

    def sampled(self, pace: float) -> "Gait":
        """The same, by a unit whose samples follow each other `pace` times as slowly as it says."""
        t = np.arange(self.t[0], self.t[-1], pace * STEP_S)
        force, rate, place_m = (
            np.array([np.interp(t, self.t, column) for column in each.T]).T
            for each in (self.force, self.rate, self.place_m)
        )
        return Gait(t, force, rate, place_m, self.heading_rad)

    def noisy(self, rng: np.random.Generator, bias_radps: float = 0.005) -> "Gait":
        """The same, felt by a small MEMS unit whose gyros have biases."""
        bias = rng.normal(0.0, bias_radps, 3)
        force = self.force + rng.normal(0.0, 0.03, self.force.shape)
        return self._replace(force=force, rate=self.rate + bias + rng.normal(0.0, 0.005, self.rate.shape))


def walked(
    strides: list[Stride],
    start_t: float = 0.0,
    heading_rad: float = 0.0,
    mounted: Rotation | None = None,
    rests_s: float = 2.0,
) -> Gait:
    """A walk that begins and ends with a rest.

    Args:
        strides: its strides.
        start_t: epoch of the first sample (s).
        heading_rad: what the boot faces at first.
        mounted: the unit's attitude on a boot that stands.
        rests_s: how long it rests.
    """
    fine = _way(strides, heading_rad, rests_s)
    attitudes = Rotation.from_euler("ZY", fine[:, 3:5]) * (mounted or Rotation.identity())
    return felt(fine[:, :3], attitudes, start_t, float(fine[-1, 3]))


def rolled(strides: int, above_m: float) -> Gait:
    """A walk straight ahead of a boot that rolls where it stands, from heel to ball; its unit is above that.

    Args:
        strides: how many.
        above_m: height of the unit above where the boot touches the ground.
    """
    fine = _way([Stride()] * strides, 0.0, 2.0)
    swings, stands = (np.arange(1, round(s / HALF_S) + 1) / round(s / HALF_S) for s in (SWING_S, STANCE_S))
    swung = BALL_RAD + (HEEL_RAD - BALL_RAD) * smooth(swings)
    rolls = HEEL_RAD + (BALL_RAD - HEEL_RAD) * smooth(stands)
    rest = round(2.0 / HALF_S)
    pitch = np.tile(np.concatenate([swung, rolls]), strides)
    # It begins and ends flat on the ground.
    pitch[: len(swings)] = HEEL_RAD * smooth(swings)
    pitch[-len(stands) :] = HEEL_RAD * (1.0 - smooth(stands))
    fine[rest:-rest, 4] += pitch
    attitudes = Rotation.from_euler("ZY", fine[:, 3:5])
    return felt(fine[:, :3] + attitudes.apply([0.0, 0.0, above_m]), attitudes, 0.0, 0.0)


def felt(places: Array, attitudes: Rotation, start_t: float, heading_rad: float) -> Gait:
    """What an inertial unit feels that goes through places and attitudes, half a step after each other.

    Its samples lie in memory as read ones do: for others all of the navigation would be compiled once more.
    """
    second = (places[2:] - 2.0 * places[1:-1] + places[:-2]) / HALF_S**2
    force = attitudes[1:-1].inv().apply(second + np.array([0.0, 0.0, GRAVITY_MPS2]))[::2]
    turned = (attitudes[:-2].inv() * attitudes[2:]).as_rotvec() / STEP_S
    t: Array = start_t + STEP_S * np.arange(len(force), dtype=np.float64)
    samples = np.ascontiguousarray(force), np.ascontiguousarray(turned[::2])
    return Gait(t, *samples, places[2::2][: len(force)] - places[0], heading_rad)


def smooth(share: Array) -> Array:
    """From 0 to 1: its first two derivatives are nil at both ends, as are those of what is made of it."""
    found: Array = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    return found


def _way(strides: list[Stride], heading_rad: float, rests_s: float) -> Array:
    """Place, heading and pitch at each half step, k × 5."""
    here = np.array([0.0, 0.0, 0.0, heading_rad, 0.0])
    parts = [np.tile(here, (round(rests_s / HALF_S), 1))]
    share = np.arange(1, round(SWING_S / HALF_S) + 1) / round(SWING_S / HALF_S)
    eased = smooth(share)
    lifted = 64.0 * share**3 * (1.0 - share) ** 3
    for stride in strides:
        facing = here[3] + stride.turn_rad
        ahead = np.array([np.cos(facing), np.sin(facing)]) * stride.length_m
        there = here + np.array([*ahead, stride.up_m, stride.turn_rad, 0.0])
        swing = here + eased[:, None] * (there - here)
        swing[:, 2] += LIFTED_M * lifted
        swing[:, 4] = STEEPEST_RAD * lifted * np.cos(np.pi * share)
        parts += [swing, np.tile(there, (round(STANCE_S / HALF_S), 1))]
        here = there
    parts.append(np.tile(here, (round(rests_s / HALF_S), 1)))
    return np.concatenate(parts)


AROUND = [
    *[Stride()] * 8,
    Stride(0.9, 0.8),
    Stride(0.9, 0.8),
    *[Stride()] * 6,
    *[Stride(0.4, -0.1, 0.17)] * 6,
]
"""Along a corridor, around its corner, and up a stair."""
