"""True ways of people: legs walked at a pace, stops, and the levels they cross."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.simulate.base import FloatArray, IntArray, Storey, TrueTrack

TICK_S = 0.1
TURN_S = 0.6
"""A person turns a corner within about two steps, not on the spot."""


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight piece of a way, then a stop.

    Attributes:
        to_m: where it ends, east, north, up (m).
        speed_mps: pace (m/s).
        stop_s: how long the walker then stands (s).
    """

    to_m: tuple[float, float, float]
    speed_mps: float
    stop_s: float = 0.0


def levels_of(up_m: FloatArray, storeys: Sequence[Storey]) -> IntArray:
    """The storey whose floor is nearest below or above each height, n (m); 0 where there are none."""
    if not storeys:
        return np.zeros(len(up_m), dtype=np.int64)
    floors = np.array([storey.up_m for storey in storeys])
    nearest = np.abs(up_m[:, None] - floors[None, :]).argmin(axis=1)
    levels: IntArray = np.array([storey.level for storey in storeys], dtype=np.int64)[nearest]
    return levels


def walk(
    start_m: tuple[float, float, float],
    legs: Sequence[Leg],
    storeys: Sequence[Storey],
    end_s: float,
    start_s: float = 0.0,
    stand_s: float = 0.0,
) -> TrueTrack:
    """The way of a walker, sampled each 0.1 s.

    Args:
        start_m: where the walker stands at first (m).
        legs: the pieces of the way, in order.
        storeys: the building's storeys.
        end_s: when the track ends (s); the walker then stands, and legs beyond it are not walked.
        start_s: when the track begins (s).
        stand_s: how long the walker stands before the first leg (s).
    """
    corners_t, corners = [start_s, start_s + stand_s], [np.array(start_m), np.array(start_m)]
    for leg in legs:
        to = np.array(leg.to_m, dtype=np.float64)
        arrival = corners_t[-1] + float(np.linalg.norm(to - corners[-1])) / leg.speed_mps
        corners_t += [arrival, arrival + leg.stop_s]
        corners += [to, to]
    t_s = np.arange(start_s, end_s + TICK_S / 2, TICK_S)
    way = np.array(corners, dtype=np.float64)
    position_m = np.stack([np.interp(t_s, corners_t, way[:, axis]) for axis in range(3)], axis=1)
    return TrueTrack(t_s, position_m, levels_of(position_m[:, 2], storeys), _headings(t_s, position_m))


def _headings(t_s: FloatArray, position_m: FloatArray) -> FloatArray:
    """Facing along the way; kept while standing; turned within `TURN_S`; unwrapped (rad)."""
    step = np.diff(position_m[:, :2], axis=0, append=position_m[-1:, :2])
    moving = np.hypot(step[:, 0], step[:, 1]) > 1e-6
    if not moving.any():
        return np.zeros(len(t_s))
    newest = np.maximum.accumulate(np.where(moving, np.arange(len(t_s)), 0))
    newest = np.where(newest == 0, int(moving.argmax()), newest)
    facing = np.unwrap(np.arctan2(step[newest, 1], step[newest, 0]))
    width = round(TURN_S / TICK_S) | 1
    padded = np.pad(facing, width // 2, mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
