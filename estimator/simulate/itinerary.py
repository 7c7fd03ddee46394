"""What a responder does inside the office: moves in the fire service's words, made into legs."""

import math
from collections.abc import Iterable

import numpy as np

from estimator.simulate.base import TrueTrack
from estimator.simulate.building import STOREYS, Point, Room, climb, corridor
from estimator.simulate.walking import Leg, walk


class Itinerary:
    """Moves of one responder, one after the other.

    `level` is the storey that he has come to.

    Args:
        start_m: where he stands at first (m).
        beside_m: he keeps this far north of the corridor's middle (m).
        rng: where his pace varies from.
    """

    def __init__(self, start_m: Point, beside_m: float, rng: np.random.Generator) -> None:
        self.start_m = start_m
        self.beside_m = beside_m
        self.t_s = 0.0
        self._at = start_m
        self.level = 0
        self._legs: list[Leg] = []
        self._stand_s = 0.0
        self._rng = rng

    def go(self, way: Iterable[Point], speed_mps: float) -> "Itinerary":
        """Walk from point to point at about `speed_mps`, with short halts to feel ahead."""
        for point in way:
            pace = speed_mps * float(self._rng.uniform(0.85, 1.15))
            halt = float(self._rng.uniform(0.0, 1.5)) if self._rng.random() < 0.3 else 0.0
            self._legs.append(Leg(point, pace, halt))
            self.t_s += math.dist(self._at, point) / pace + halt
            self._at = point
        return self

    def wait(self, stop_s: float) -> "Itinerary":
        """Stand for `stop_s` seconds."""
        if self._legs:
            last = self._legs[-1]
            self._legs[-1] = Leg(last.to_m, last.speed_mps, last.stop_s + stop_s)
        else:
            self._stand_s += stop_s
        self.t_s += stop_s
        return self

    def wait_until(self, t_s: float) -> "Itinerary":
        """Stand until `t_s`, if that is still to come."""
        return self.wait(max(t_s - self.t_s, 0.0))

    def advance(self, x_m: float, speed_mps: float) -> "Itinerary":
        """Along the corridor to `x_m`."""
        return self.go([corridor(x_m, self.level, self.beside_m)], speed_mps)

    def take_stairs(self, stairwell: str, to_level: int, speed_mps: float) -> "Itinerary":
        """To the stairwell along the corridor, and up or down to `to_level`."""
        self.go(climb(stairwell, self.level, to_level, self.beside_m), speed_mps)
        self.level = to_level
        return self

    def search(self, room: Room, speed_mps: float) -> "Itinerary":
        """Into a room, along its walls, and back to the corridor."""
        self.advance(room.door_x_m, speed_mps)
        return self.go(room.search(), speed_mps).advance(room.door_x_m, speed_mps)

    def enter(self, room: Room, along: float, deep: float, speed_mps: float) -> "Itinerary":
        """Into a room as far as `along`, `deep`."""
        self.advance(room.door_x_m, speed_mps)
        return self.go([room.inside(0.0, 0.0), room.inside(along, deep)], speed_mps)

    def leave(self, room: Room, speed_mps: float) -> "Itinerary":
        """Out of a room into the corridor."""
        return self.go([room.inside(0.0, 0.0), corridor(room.door_x_m, room.level, self.beside_m)], speed_mps)

    def track(self, end_s: float) -> TrueTrack:
        """The true track until `end_s`."""
        return walk(self.start_m, self._legs, STOREYS, end_s, stand_s=self._stand_s)
