"""The canonical order is the same in whatever order readings come: introductions first, then by bytes."""

import random

import msgspec

from estimator.fusion.canonical_order import in_order
from estimator.inertial.samples import AnyFolded
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi


def readings() -> list[AnyFolded]:
    found: list[AnyFolded] = []
    for t in (0.0, 1.0, 1.5):
        found.append(Node(t=t, node="z", role="responder"))
        found.append(Displacement(t=t, node="z", delta_m=(1.0, t, 0.0)))
        found += [Rssi(t=t, a="z", b=f"b{i}", dbm=-60.0 - i) for i in range(3)]
        found += [Range(t=t, a="z", b="b1", range_m=4.0), Range(t=t, a="z", b="b1", range_m=4.0)]
    return found


def test_it_is_by_epoch_then_introductions_first_then_by_bytes() -> None:
    def place(reading: AnyFolded) -> tuple[float, bool, bytes]:
        return reading.until_t, not isinstance(reading, Node), msgspec.msgpack.encode(reading)

    some = readings()
    for seed in range(5):
        random.Random(seed).shuffle(some)
        assert in_order(some) == sorted(some, key=place)


def test_nothing_is_in_order() -> None:
    assert in_order([]) == []
