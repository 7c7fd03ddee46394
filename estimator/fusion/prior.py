"""What is known from before the window."""

from collections.abc import Mapping
from typing import NamedTuple

from estimator.graph.dense import Array

Key = tuple[str, int]
"""A block: ("walk", node number) with a PDR unit's errors, ("free", node number) with a velocity, ("stand",
node number), ("range" or "rssi", number of the technology)."""

SIZES: Mapping[str, int] = {"walk": 6, "free": 6, "stand": 3, "range": 2, "rssi": 2}
"""How many numbers each kind of block has."""


class Prior(NamedTuple):
    """What everything before the window says of its first keyframe and of the border.

    Attributes:
        keys: its blocks, in order.
        matrix: Kirchhoff matrix, n × n.
        vector: in deviations from `reference`, n.
        reference: where it was linearised, n.
        epochs: what each walk's numbers refer to, by node number (s): a node that was silent when the window
            was cut is known where it was last heard, not at the cut.
    """

    keys: tuple[Key, ...]
    matrix: Array
    vector: Array
    reference: Array
    epochs: Mapping[int, float]
