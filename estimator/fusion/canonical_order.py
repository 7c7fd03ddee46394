"""The canonical order of readings: the same set gives the same estimates, in whatever order it arrives."""

import math
from collections.abc import Iterable
from operator import attrgetter

import msgspec

from estimator.fusion.physics import TICK_S
from estimator.inertial.samples import AnyFolded
from estimator.measurements.node import LateNode, Node

_encode = msgspec.msgpack.Encoder().encode
INTRODUCTIONS = frozenset((Node, LateNode))
UNTIL_T = attrgetter("until_t")
"""Until when a reading tells, for a search among readings in their order."""


def in_order(readings: Iterable[AnyFolded]) -> list[AnyFolded]:
    """Readings in their order: by until when they tell, introductions first, then by their own bytes."""
    together: dict[float, list[AnyFolded]] = {}
    for reading in readings:
        together.setdefault(reading.until_t, []).append(reading)
    ordered: list[AnyFolded] = []
    for until_t in sorted(together):
        same = together[until_t]
        if len(same) > 1:
            same.sort(key=_encode)
            if not INTRODUCTIONS.isdisjoint(map(type, same)):
                same.sort(key=_rank)
        ordered += same
    return ordered


def _rank(reading: AnyFolded) -> tuple[int, float]:
    """Introductions first, and of those too late ones, which are all taken of one epoch, the oldest."""
    if isinstance(reading, LateNode):
        return 0, reading.told_t
    return (1 if isinstance(reading, Node) else 2), 0.0


def tick_of(t: float) -> int:
    """Number of the tick that an epoch belongs to; ticks end on multiples of `TICK_S`."""
    return math.ceil(t / TICK_S - 1e-6)


def end_of_tick(tick: int) -> float:
    """Epoch at which a tick ends, Unix seconds."""
    return tick * TICK_S
