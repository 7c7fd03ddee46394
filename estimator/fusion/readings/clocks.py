"""Radios whose ranges are stamped by another clock than their bearers' steps.

Gateways stamp what they hear. Where ranges come by one whose clock is off, and steps by another one, each
range is held against a place that its bearer had left, or has not reached yet.
"""

from collections.abc import Mapping

from msgspec.structs import replace

from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import AnyHeld
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi


def stamped_by(a: str, b: str, nodes: Mapping[str, NodeState]) -> str:
    """Whose radio's clock a reading between two nodes goes by: that of who reports it, if he moves."""
    end = nodes.get(a)
    return a if end is None or end.moving else b


def retimed(reading: AnyHeld, clocks: Mapping[str, float], nodes: Mapping[str, NodeState]) -> AnyHeld:
    """A reading with the epoch at which it was made, by the clock of its bearer's steps.

    Args:
        reading: as it came; what is no range and no power stays as it is.
        clocks: how late those of radios are stamped, by node (s).
        nodes: all of them.
    """
    if not isinstance(reading, (Range, Rssi)):
        return reading
    late_s = clocks.get(stamped_by(reading.a, reading.b, nodes))
    return reading if late_s is None else replace(reading, t=max(reading.t - late_s, 0.0))
