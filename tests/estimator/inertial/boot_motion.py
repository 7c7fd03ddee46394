"""A boot that moves, as its wearer makes it: places and attitudes, twice as fine as samples."""

from typing import Self

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from estimator.graph.dense import Array
from estimator.inertial.boot import GRAVITY_MPS2
from tests.estimator.inertial.gait import HALF_S, LIFTED_M, STEEPEST_RAD, Gait, felt, smooth

KNEELS_RAD, KNEELS_S = 1.2, 1.0
TREMBLES_S = 0.08


class BootMotion:
    """What a boot does, one thing after the other: each adds to its way and gives itself.

    A pose is a place (m), heading, pitch and roll (rad).
    """

    def __init__(self, seed: int = 0) -> None:
        self._chance = np.random.default_rng(seed)
        self._here = np.zeros(6)
        self._parts: list[Array] = []

    def rests(self, duration_s: float) -> Self:
        """It does not move."""
        return self._add(np.tile(self._here, (round(duration_s / HALF_S), 1)))

    def works(self, duration_s: float, by_m: float = 0.005, by_rad: float = 0.05) -> Self:
        """Its wearer works on the spot: it never is quiet, and stays where it is."""
        count = round(duration_s / HALF_S)
        t = np.arange(count) * HALF_S
        shakes = smooth(np.clip(np.minimum(t, t[-1] - t) / 0.3, 0.0, 1.0))
        noise = gaussian_filter1d(self._chance.normal(size=(count + 2000, 6)), TREMBLES_S / HALF_S, axis=0)
        noise *= np.array([by_m] * 3 + [by_rad] * 3) / noise.std(axis=0)
        return self._add(self._here + shakes[:, None] * noise[:count])

    def kneels(self, angle_rad: float = KNEELS_RAD) -> Self:
        """It goes from its sole to its toes, or back with the angle's negative."""
        there = self._here + np.array([0.0, 0.0, 0.0, 0.0, angle_rad, 0.0])
        return self._go(KNEELS_S, there).rests(0.5)

    def turns(self, angle_rad: float, duration_s: float) -> Self:
        """It turns on the spot."""
        return self._go(duration_s, self._here + np.array([0.0, 0.0, 0.0, angle_rad, 0.0, 0.0]))

    def walks(self, strides: int) -> Self:
        """Strides on the level."""
        for _ in range(strides):
            share = np.arange(1, round(0.5 / HALF_S) + 1) / round(0.5 / HALF_S)
            lifted = 64.0 * share**3 * (1.0 - share) ** 3
            swing = self._here + smooth(share)[:, None] * (self._ahead(1.3) - self._here)
            swing[:, 2] += LIFTED_M * lifted
            swing[:, 4] += STEEPEST_RAD * lifted * np.cos(np.pi * share)
            self._add(swing).rests(0.6)
        return self

    def crawls(self, strokes: int, length_m: float, duration_s: float, rests_s: float, by_rad: float) -> Self:
        """It is dragged along the floor, stroke by stroke, and pitches a little while it is."""
        for _ in range(strokes):
            share = np.arange(1, round(duration_s / HALF_S) + 1) / round(duration_s / HALF_S)
            stroke = self._here + smooth(share)[:, None] * (self._ahead(length_m) - self._here)
            stroke[:, 4] += by_rad * 64.0 * share**3 * (1.0 - share) ** 3
            self._add(stroke).rests(rests_s)
        return self

    def fidgets(self, duration_s: float) -> Self:
        """Its wearer shifts now and then, and comes back."""
        home, until = self._here.copy(), 0.0
        while until < duration_s:
            off = self._chance.normal(0.0, 1.0, 6) * [0.04, 0.04, 0.01, 0.15, 0.15, 0.15]
            takes_s, rests_s = self._chance.uniform(0.3, 0.8), self._chance.uniform(0.1, 2.0)
            self._go(takes_s, home + off).rests(rests_s)
            until += takes_s + rests_s
        return self

    def rides(self, duration_s: float, way_m: float, starts_s: float = 1.5, upwards: bool = True) -> Self:
        """It stands in a lift, or on a trolley."""
        way = np.array([0.0, 0.0, way_m]) if upwards else self._ahead(way_m)[:3] - self._here[:3]
        return self._carried(duration_s, starts_s, way, 0.0, 0.0)

    def jumps(self, up_m: float, lands_s: float) -> Self:
        """It takes off, falls, and is stopped within so long."""
        speed = np.sqrt(2.0 * GRAVITY_MPS2 * up_m)
        takes_off = np.arange(1, round(0.25 / HALF_S) + 1) * HALF_S
        rises = 0.5 * speed / 0.25 * takes_off**2
        flies = np.arange(1, round(2.0 * speed / GRAVITY_MPS2 / HALF_S) + 1) * HALF_S
        falls = rises[-1] + speed * flies - 0.5 * GRAVITY_MPS2 * flies**2
        last = speed - GRAVITY_MPS2 * flies[-1]
        lands = np.arange(1, round(lands_s / HALF_S) + 1) * HALF_S
        stops = falls[-1] + last * lands - 0.5 * last / lands[-1] * lands**2
        up = np.concatenate([rises, falls, stops])
        poses = np.tile(self._here, (len(up), 1))
        poses[:, 2] += gaussian_filter1d(up, 0.003 / HALF_S, mode="nearest")
        return self._add(poses)

    def carried(self, duration_s: float, ahead_m: float) -> Self:
        """It lies on a stretcher, which two people carry at a walk."""
        return self._carried(duration_s, 1.0, self._ahead(ahead_m)[:3] - self._here[:3], 0.01, 0.05)

    def gait(self) -> Gait:
        """What it does and feels."""
        poses = np.concatenate(self._parts)
        return felt(poses[:, :3], Rotation.from_euler("ZYX", poses[:, 3:]), 0.0, float(poses[-1, 3]))

    def _carried(self, duration_s: float, starts_s: float, way: Array, by_m: float, by_rad: float) -> Self:
        t = np.arange(1, round(duration_s / HALF_S) + 1) * HALF_S
        speed = np.interp(t, [0.0, starts_s, duration_s - starts_s, duration_s], [0.0, 1.0, 1.0, 0.0])
        shares = np.cumsum(gaussian_filter1d(speed, 0.1 / HALF_S))
        poses = np.tile(self._here, (len(t), 1))
        poses[:, :3] += (shares / shares[-1])[:, None] * way
        poses[:, 2] += by_m * speed * np.sin(4.0 * np.pi * t)
        poses[:, 4] += by_rad * speed * np.sin(2.0 * np.pi * t)
        there = self._here + np.concatenate([way, np.zeros(3)])
        self._add(poses)
        self._here = there
        return self

    def _ahead(self, length_m: float) -> Array:
        there = self._here.copy()
        there[:2] += length_m * np.array([np.cos(there[3]), np.sin(there[3])])
        return there

    def _go(self, duration_s: float, there: Array) -> Self:
        share = np.arange(1, round(duration_s / HALF_S) + 1) / round(duration_s / HALF_S)
        return self._add(self._here + smooth(share)[:, None] * (there - self._here))

    def _add(self, poses: Array) -> Self:
        self._parts.append(poses)
        self._here = poses[-1].copy()
        return self


class Unit:
    """A small MEMS unit with errors of its own.

    Args:
        seed: of its errors and its noise.
        scale: how much each accelerometer's scale is off.
        bias_mps2: how much each of them is off.
        bias_radps: how much each gyro is off.
    """

    def __init__(
        self, seed: int, scale: float = 0.0, bias_mps2: float = 0.0, bias_radps: float = 0.0
    ) -> None:
        chance = np.random.default_rng(seed)
        self._seed = seed
        self._scale = 1.0 + scale * chance.choice([-1.0, 1.0], 3)
        self._force = bias_mps2 * chance.choice([-1.0, 1.0], 3)
        self._rate = bias_radps * chance.choice([-1.0, 1.0], 3)

    def feels(self, gait: Gait) -> Gait:
        """What it makes of a gait."""
        chance = np.random.default_rng((self._seed, 1))
        force = gait.force * self._scale + self._force + chance.normal(0.0, 0.03, gait.force.shape)
        rate = gait.rate + self._rate + chance.normal(0.0, 0.005, gait.rate.shape)
        return gait._replace(force=force, rate=rate)
