"""The canonical order of readings: the same set gives the same estimates, in whatever order it arrives."""

import math
from typing import NamedTuple

import msgspec

from estimator.fusion.physics import TICK_S
from estimator.measurements import AnyReading
from estimator.measurements.node import Node

_encode = msgspec.msgpack.Encoder().encode


class Entry(NamedTuple):
    """A reading with its place in the order: epoch, introductions first, then its own bytes."""

    t: float
    rank: int
    content: bytes
    reading: AnyReading


def entry(reading: AnyReading) -> Entry:
    """The reading with its sort key; two entries with equal keys are the same reading."""
    return Entry(reading.t, 0 if isinstance(reading, Node) else 1, _encode(reading), reading)


def key(item: Entry) -> tuple[float, int, bytes]:
    """What entries are sorted by."""
    return item[:3]


def tick_of(t: float) -> int:
    """Number of the tick that an epoch belongs to; ticks end on multiples of `TICK_S`."""
    return math.ceil(t / TICK_S - 1e-6)


def end_of(tick: int) -> float:
    """Epoch at which a tick ends, Unix seconds."""
    return tick * TICK_S
