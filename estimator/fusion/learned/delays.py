"""Radios whose antenna delay is not calibrated: their ranges have another bias than those of all others.

Such a radio's ranges are a technology by themselves, with a scale, a bias and a noise of their own.
"""

from collections.abc import Collection

import msgspec

OF = " of "
"""No technology's name has a space."""
Radio = tuple[str, str]
"""A technology, and the node that carries the radio."""


class Suspicion(msgspec.Struct, frozen=True, array_like=True):
    """That the radio of somebody who moves may have an antenna delay, though it is trusted.

    Attributes:
        off: by what scale and bias (m) of the technologies that its ranges count as are then off for it, one
            standard deviation, by technology.
        alone: no other radio's ranges count as these.
    """

    off: dict[str, tuple[float, float]]
    alone: bool


def source_of(technology: str, a: str, b: str, delayed: Collection[Radio]) -> str:
    """The technology that ranges between two nodes count as.

    Args:
        technology: what they were reported as.
        a: one node.
        b: the other one.
        delayed: the radios whose antenna delay is not calibrated.
    """
    own = sorted(name for name in (a, b) if (technology, name) in delayed)
    return f"{technology}{OF}{' '.join(own)}" if own else technology


def reported_as(source: str) -> str:
    """What ranges were reported as that count as a technology."""
    return source.partition(OF)[0]


def delays(source: str) -> int:
    """How many radios whose antenna delay is not calibrated take part in each range of a technology."""
    names = source.partition(OF)[2]
    return len(names.split(" ")) if names else 0


def delayed_radio(source: str) -> Radio | None:
    """The radio for whose delay ranges count as a technology of their own; None: none, or several."""
    return (reported_as(source), source.partition(OF)[2]) if delays(source) == 1 else None
