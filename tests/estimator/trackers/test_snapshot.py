"""A tracker goes on from a snapshot as if nothing had been; one that it cannot go on from is refused."""

import pytest

from estimator import trackers
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.trackers.base import TrackerSettings


@pytest.mark.parametrize("name", trackers.TRACKERS)
def test_a_snapshot_of_another_version_is_refused(name: str) -> None:
    state = bytearray(trackers.create(name, TrackerSettings()).snapshot())
    state[1] = 99
    with pytest.raises(ValueError, match="version 99"):
        trackers.restore(name, bytes(state))


@pytest.mark.parametrize("name", trackers.TRACKERS)
@pytest.mark.parametrize("state", [b"", b"nonsense", b"\xc1"])
def test_what_is_no_snapshot_is_refused(name: str, state: bytes) -> None:
    with pytest.raises(ValueError, match="no snapshot"):
        trackers.restore(name, state)


@pytest.mark.parametrize("name", trackers.TRACKERS)
def test_a_snapshot_that_was_cut_off_is_refused(name: str) -> None:
    state = trackers.create(name, TrackerSettings()).snapshot()
    with pytest.raises(ValueError, match="no snapshot"):
        trackers.restore(name, state[:-1])


def stood_and_walked(second: int) -> list[AnyReading]:
    """Of two units that stand still for half a minute, walk on, and are ranged to from the base."""
    readings: list[AnyReading] = []
    for i, name in enumerate(("ff1", "ff2")):
        step = (0.0, 0.0, 0.0) if second % 40 < 33 else (0.5, 0.1, 0.0)
        heading = 0.001 * (i + 1) * second
        t = float(second)
        readings.append(Displacement(t=t, from_t=t - 1.0, node=name, delta_m=step, heading_rad=heading))
        readings.append(Range(t=t, a="base", b=name, range_m=3.0 + i, technology="uwb"))
    return readings


@pytest.mark.parametrize("cut", [21, 45])
def test_a_tracker_that_was_stopped_in_a_standstill_goes_on_bit_for_bit(cut: int) -> None:
    whole = trackers.create("kirchhoff", TrackerSettings())
    whole.fold([Node(t=0.0, node="base", role="base")])
    place = (3.0, 0.0, 0.0)
    whole.fold([Node(t=0.0, node=name, role="responder", position_m=place) for name in ("ff1", "ff2")])
    for second in range(1, cut + 1):
        whole.fold(stood_and_walked(second))
        whole.estimates()
    again = trackers.restore("kirchhoff", whole.snapshot())
    for second in range(cut + 1, 100):
        for tracker in (whole, again):
            tracker.fold(stood_and_walked(second))
        assert again.estimates() == whole.estimates()
