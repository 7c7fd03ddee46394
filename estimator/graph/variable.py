"""What a block of the Kirchhoff matrix stands for."""

from typing import Literal, NamedTuple

VariableKind = Literal["position", "velocity", "unit", "range", "rssi", "altimeter", "receiver"]
"""position: east, north, up (m); velocity: the same (m/s); unit: heading error ψ (rad), gyro bias β (rad/s)
and step scale error s − 1 of a PDR unit; range: scale error and bias (m) of a ranging technology, and what
bearers' bodies make it longer by (m); rssi: power at 1 m (dBm), path-loss exponent, and what bodies take
(dB); altimeter: what one is off by now (m); receiver: what fixes of one who
flies are off by, east, north, up (m), and how late they are (s)."""

TECHNOLOGIES = frozenset({"range", "rssi", "altimeter", "receiver"})
"""Kinds of blocks that are no node's place or way, but last."""
DIMENSION: dict[VariableKind, int] = {
    "position": 3,
    "velocity": 3,
    "unit": 3,
    "range": 3,
    "rssi": 3,
    "altimeter": 1,
    "receiver": 4,
}

BIAS, BODY = 1, 2
"""Which number of a ranging technology is its bias, and of a radio technology what bearers' bodies do; those
before the latter tell how its readings go with the distance."""


class Variable(NamedTuple):
    """The key of a block.

    Attributes:
        kind: what its numbers mean.
        owner: the node, technology or incident that it belongs to.
        epoch: the moment that it is frozen at, Unix seconds; None: static, or moves along with its owner.
    """

    kind: VariableKind
    owner: str
    epoch: float | None = None
