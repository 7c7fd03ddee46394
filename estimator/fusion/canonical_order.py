"""The canonical order of readings: the same set gives the same estimates, in whatever order it arrives."""

import math
from operator import attrgetter

import msgspec

from estimator.fusion.physics import TICK_S
from estimator.inertial.samples import AnyFolded
from estimator.measurements.node import Node

_encode = msgspec.msgpack.Encoder().encode
UNTIL_T = attrgetter("until_t")
"""Until when a reading tells, for a search among readings in their order."""


def place_of(reading: AnyFolded) -> tuple[float, int, bytes]:
    """A reading's place in the order: until when it tells, introductions first, then its own bytes."""
    return reading.until_t, 0 if isinstance(reading, Node) else 1, _encode(reading)


def tick_of(t: float) -> int:
    """Number of the tick that an epoch belongs to; ticks end on multiples of `TICK_S`."""
    return math.ceil(t / TICK_S - 1e-6)


def end_of_tick(tick: int) -> float:
    """Epoch at which a tick ends, Unix seconds."""
    return tick * TICK_S
