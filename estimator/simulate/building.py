"""The office of the demo: three storeys of rooms along a corridor, with a stairwell at each end.

north   |     |stair|room |room |room |room |room |stair|
|     |  W  | n2  | n3  | n4  | n5  | n6  |  E  |
entry ->|            corridor, y = 0                    |
south   |room |room |room |room |room |room |room |room |
| s0  | s1  | s2  | s3  | s4  | s5  | s6  | s7  |
"""

from dataclasses import dataclass

import numpy as np

from estimator.simulate.base import FloatArray, Storey

WEST_M, EAST_M, ROOM_M = 2.0, 50.0, 6.0
CORRIDOR_M, DEPTH_M, DOOR_M = 1.2, 9.0, 0.6
STOREY_M = 3.4
STOREYS = (
    Storey(0, "Ground floor", 0.0),
    Storey(1, "First floor", STOREY_M),
    Storey(2, "Second floor", 2 * STOREY_M),
)
STAIRS_X_M = {"W": WEST_M + 1.5 * ROOM_M, "E": WEST_M + 7.5 * ROOM_M}

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Room:
    """A room: its side of the corridor (`n`, `s`), its number from the west, and its level."""

    side: str
    number: int
    level: int

    @property
    def door_x_m(self) -> float:
        """Where its door is along the corridor (m)."""
        return WEST_M + (self.number + 0.5) * ROOM_M

    def inside(self, along: float, deep: float) -> Point:
        """A point: `along` from -1 (west) to 1 (east), `deep` from 0 (door) to 1 (window)."""
        y = CORRIDOR_M + 0.8 + deep * (DEPTH_M - CORRIDOR_M - 1.6)
        sign = 1.0 if self.side == "n" else -1.0
        return (self.door_x_m + along * (ROOM_M / 2 - 0.8), sign * y, self.level * STOREY_M)

    def search(self) -> list[Point]:
        """Along the walls by the right hand, from the door round to the door."""
        corners = [(0.0, 0.0), (-1.0, 0.0), (-1.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]
        return [self.inside(*corner) for corner in corners]


def corridor(x_m: float, level: int, beside_m: float) -> Point:
    """A point in the corridor, `beside_m` north of its middle (m)."""
    return (x_m, beside_m, level * STOREY_M)


def climb(stairwell: str, level: int, to_level: int, beside_m: float) -> list[Point]:
    """The way by a stairwell from the corridor of `level` to that of `to_level`: two flights a storey."""
    x = STAIRS_X_M[stairwell]
    way = [corridor(x - 0.5, level, beside_m), (x - 0.5, CORRIDOR_M + 1.0, level * STOREY_M)]
    step = 1 if to_level > level else -1
    for floor in range(level, to_level, step):
        up, half = floor * STOREY_M, (floor + step / 2) * STOREY_M
        way += [(x - 0.5, DEPTH_M - 1.2, half), (x + 0.5, DEPTH_M - 1.2, half)]
        way += [(x + 0.5, CORRIDOR_M + 1.0, up + step * STOREY_M)]
        if floor + step != to_level:
            way += [(x - 0.5, CORRIDOR_M + 1.0, up + step * STOREY_M)]
    return [*way, corridor(x + 0.5, to_level, beside_m)]


def _walls() -> FloatArray:
    """The walls of any storey as segments, m × 4: x1, y1, x2, y2 (m); doors are gaps."""
    segments = [(WEST_M, CORRIDOR_M, WEST_M, DEPTH_M), (WEST_M, -DEPTH_M, WEST_M, -CORRIDOR_M)]
    segments += [(EAST_M, -DEPTH_M, EAST_M, DEPTH_M)]
    for number in range(8):
        west = WEST_M + number * ROOM_M
        door = west + ROOM_M / 2
        for sign in (-1.0, 1.0):
            y, outer = sign * CORRIDOR_M, sign * DEPTH_M
            segments += [(west, y, door - DOOR_M, y), (door + DOOR_M, y, west + ROOM_M, y)]
            segments += [(west, outer, west + ROOM_M, outer)]
            if number:
                segments += [(west, y, west, outer)]
    return np.array(segments)


WALLS = _walls()


def walls_between(a_m: FloatArray, b_m: FloatArray) -> FloatArray:
    """How many walls the straight lines from `a_m` to `b_m` cross in plan, n × 3 each (m) → n."""
    p, d = a_m[:, None, :2], (b_m - a_m)[:, None, :2]
    q, e = WALLS[None, :, :2], (WALLS[:, 2:] - WALLS[:, :2])[None]
    cross = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
    safe = np.where(np.abs(cross) < 1e-12, np.inf, cross)
    gap = q - p
    along = (gap[..., 0] * e[..., 1] - gap[..., 1] * e[..., 0]) / safe
    across = (gap[..., 0] * d[..., 1] - gap[..., 1] * d[..., 0]) / safe
    crossed = (along > 0) & (along < 1) & (across > 0) & (across < 1) & np.isfinite(safe)
    count: FloatArray = crossed.sum(axis=1).astype(np.float64)
    return count


def floors_between(a_m: FloatArray, b_m: FloatArray) -> FloatArray:
    """How many floors lie between points `a_m` and `b_m`, n × 3 each (m) → n; outside counts by height."""
    a_storey, b_storey = (np.clip(np.floor((m[:, 2] + 0.3) / STOREY_M), 0, 2) for m in (a_m, b_m))
    count: FloatArray = np.abs(a_storey - b_storey)
    return count
