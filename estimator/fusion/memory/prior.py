"""What is known from before the window."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from estimator.fusion.images import Image
from estimator.graph.dense import Array
from estimator.graph.variable import DIMENSION, TECHNOLOGIES

Key = tuple[str, int]
"""A block: ("walk", node number) with a PDR unit's errors, ("free", node number) with a velocity, ("stand",
node number), ("range", "rssi", "altimeter" or "receiver", number of the technology), ("loss", its number)."""

PLACED = ("walk", "free", "stand")
SIZES: Mapping[str, int] = {
    "walk": 6,
    "free": 6,
    "stand": 3,
    "loss": 1,
    **{kind: count for kind, count in DIMENSION.items() if kind in TECHNOLOGIES},
}
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

    def imaged(self, images: Mapping[int, Image]) -> "Prior":
        """The same, if nodes had been at images of where they were, by their number."""
        turn, reference, start = np.eye(len(self.vector)), self.reference.copy(), 0
        for kind, number in self.keys:
            image = images.get(number) if kind in PLACED else None
            if image is not None:
                for first in (start, start + 3) if kind == "free" else (start,):
                    turn[first : first + 2, first : first + 2] = image.matrix
                    reference[first : first + 2] = image.matrix @ reference[first : first + 2]
                reference[start : start + 2] += image.shift_m
                if kind == "walk":
                    reference[start + 3] += image.turned_rad
            start += SIZES[kind]
        return self._replace(
            matrix=turn @ self.matrix @ turn.T, vector=turn @ self.vector, reference=reference
        )

    def without(self, key: Key, mean: Array, information: Array) -> "Prior":
        """The same without some of what was told beforehand of the first numbers of a block, if it has that.

        Such a prior is linear: what is left of it, after all that has left the window, is what it was.

        Args:
            key: the block.
            mean: of the numbers that were told, n.
            information: that is to go, of each, n.
        """
        if key not in self.keys:
            return self
        start = sum(SIZES[kind] for kind, _ in self.keys[: self.keys.index(key)])
        at = np.arange(start, start + len(mean))
        matrix, vector = self.matrix.copy(), self.vector.copy()
        matrix[at, at] -= information
        vector[at] -= information * (mean - self.reference[at])
        return self._replace(matrix=matrix, vector=vector)

    def moved(self, key: Key, number: int, by: float) -> "Prior":
        """The same with one of a block's numbers counted from elsewhere, if it has that.

        Args:
            key: the block.
            number: which of its numbers.
            by: what it is more than it was.
        """
        if key not in self.keys:
            return self
        reference = self.reference.copy()
        reference[sum(SIZES[kind] for kind, _ in self.keys[: self.keys.index(key)]) + number] += by
        return self._replace(reference=reference)
