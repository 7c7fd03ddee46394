"""Responders on laps over a grid of breadcrumbs, any number of each and for as long as one likes."""

import math
from typing import NamedTuple

import numpy as np

from estimator.measurements import AnyReading, Displacement, Node, Rssi
from estimator.simulate import TrueTrack
from estimator.simulate.base import FloatArray

GRID_M = 10.0
LAP_M = (30.0, 20.0)
SPEED_MPS = 1.0
BESIDE_M = 1.0
"""A lap runs so far beside the breadcrumbs."""

STEP_SIGMA_M = 0.03
BIAS_RADPS = math.radians(0.1)
P0_DBM = -42.0
EXPONENT = 2.2
ANTENNA_M = 0.3
RSSI_SIGMA_DB = 5.0
CRUMB_SIGMA_M = 0.5
START_SIGMA_M = 0.3
UNTOLD_RAD = 3.0
"""Standard deviation of what a unit faces of which nobody has told."""
FACES_RAD = 2.4
"""By so much more than the one before each unit's frame is turned then: all round, and no two alike."""


class Laps(NamedTuple):
    """A crew of any size: each second's readings are a function of the second, and of nothing else.

    Attributes:
        responders: so many walk.
        breadcrumbs: so many lie in a square grid.
        heard: each responder hears so many, the nearest.
        sweeps: so many times a second.
        seed: of the noise.
        told: it is told what their units face; else each of these is turned by an angle of its own.
    """

    responders: int
    breadcrumbs: int
    heard: int = 6
    sweeps: int = 1
    seed: int = 0
    told: bool = True

    def introductions(self) -> list[AnyReading]:
        """The readings at epoch 0 that place everybody: the base, the breadcrumbs, the responders."""
        rng = np.random.default_rng((self.seed, 0))
        found: list[AnyReading] = [Node(t=0.0, node="base", role="base", position_m=(-GRID_M, 0.0, 0.0))]
        lain = self._crumbs() + rng.normal(0.0, CRUMB_SIGMA_M / 2.0, (self.breadcrumbs, 2))
        for i, (east, north) in enumerate(lain.tolist()):
            place = (east, north, 0.0)
            found.append(
                Node(t=0.0, node=f"b{i}", role="breadcrumb", position_m=place, sigma_m=CRUMB_SIGMA_M)
            )
        for i, (east, north) in enumerate(self.places(np.zeros(1))[0].tolist()):
            entered = Node(
                t=0.0,
                node=f"ff{i}",
                role="responder",
                position_m=(east, north, 0.0),
                sigma_m=START_SIGMA_M,
                heading_sigma_rad=None if self.told else UNTOLD_RAD,
            )
            found.append(entered)
        return found

    def second(self, until_t: int) -> list[AnyReading]:
        """What is measured in the second that ends at `until_t` (s), in order of epoch."""
        rng = np.random.default_rng((self.seed, until_t))
        readings: list[AnyReading] = []
        for sweep in range(self.sweeps):
            t = until_t - 1.0 + (sweep + 1.0) / self.sweeps
            places, crumbs = self.places(np.array([t]))[0], self._crumbs()
            for i, place in enumerate(places):
                squared = ((crumbs - place) ** 2).sum(axis=1)
                nearest = np.argsort(squared, kind="stable")[: self.heard]
                decades = 0.5 * np.log10(squared[nearest] + ANTENNA_M**2)
                dbm = P0_DBM - 10.0 * EXPONENT * decades + rng.normal(0.0, RSSI_SIGMA_DB, len(nearest))
                heard = zip(nearest.tolist(), dbm.tolist(), strict=True)
                readings += [Rssi(t=t, a=f"ff{i}", b=f"b{crumb}", dbm=power) for crumb, power in heard]
        before, after = self.places(np.array([until_t - 1.0, float(until_t)]))
        moved = after - before + rng.normal(0.0, STEP_SIGMA_M, before.shape)
        turn = BIAS_RADPS * until_t - self._faces()  # the gyro's bias turns the unit's frame
        cosine, sine = np.cos(turn), np.sin(turn)
        reported = [cosine * moved[:, 0] + sine * moved[:, 1], cosine * moved[:, 1] - sine * moved[:, 0]]
        for i, (east, north) in enumerate(np.stack(reported, axis=1).tolist()):
            readings.append(Displacement(t=float(until_t), node=f"ff{i}", delta_m=(east, north, 0.0)))
        return readings

    def places(self, t_s: FloatArray) -> FloatArray:
        """East and north of all responders at epochs `t_s`, epochs × responders × 2 (m)."""
        side = self._side()
        number = np.arange(self.responders)
        room: FloatArray = np.maximum((side - 1) * GRID_M - np.array(LAP_M), 0.0)
        share = np.column_stack([(number * 0.618034) % 1.0, (number * 0.754878) % 1.0])
        corner = share * room + BESIDE_M
        way_m = SPEED_MPS * t_s[:, None] + 7.0 * number
        corners = np.cumsum([0.0, LAP_M[0], LAP_M[1], LAP_M[0], LAP_M[1]])
        along = way_m % corners[-1]
        east = np.interp(along, corners, [0.0, LAP_M[0], LAP_M[0], 0.0, 0.0])
        north = np.interp(along, corners, [0.0, 0.0, LAP_M[1], LAP_M[1], 0.0])
        placed: FloatArray = np.asarray(corner + np.stack([east, north], axis=-1), dtype=np.float64)
        return placed

    def truth(self, until_s: int) -> dict[str, TrueTrack]:
        """The true tracks of the responders from epoch 0 to `until_s` (s)."""
        t_s = np.arange(until_s + 1.0)
        places = self.places(t_s)
        flat, ground = np.zeros((len(t_s), 1)), np.zeros(len(t_s), dtype=np.int64)
        return {
            f"ff{i}": TrueTrack(t_s, np.hstack([places[:, i], flat]), ground, np.zeros(len(t_s)))
            for i in range(self.responders)
        }

    def _faces(self) -> FloatArray:
        """Where their units' frames are turned to at first (rad)."""
        return np.zeros(self.responders) if self.told else FACES_RAD * np.arange(1.0, self.responders + 1.0)

    def _side(self) -> int:
        return math.ceil(math.sqrt(self.breadcrumbs))

    def _crumbs(self) -> FloatArray:
        """East and north of the breadcrumbs, n × 2 (m)."""
        number = np.arange(self.breadcrumbs)
        return np.column_stack([number % self._side(), number // self._side()]).astype(np.float64) * GRID_M
