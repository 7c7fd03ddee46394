"""Chains of any shape with random contents."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from estimator.graph.dense import Array
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.chain.groups import Group


class Shape(NamedTuple):
    """Of a chain: keyframes, numbers of a walk, of the border, and each group's walks and border columns."""

    length: int
    size: int
    border: int
    groups: tuple[tuple[Sequence[int], Sequence[int]], ...]

    @property
    def width(self) -> int:
        """Columns of a keyframe."""
        return self.size * sum(len(walks) for walks, _ in self.groups)


def alone(length: int, width: int, border: int) -> Shape:
    """One walk."""
    return Shape(length, width, border, (((0,), range(border)),))


APART = (((0, 3), (0, 1, 4)), ((1,), (1, 2, 4)), ((2,), ()))
SHAPES = [alone(2, 3, 2), alone(6, 4, 3), alone(60, 6, 5), alone(5, 3, 0), Shape(9, 3, 6, APART)]


def groups_of(shape: Shape) -> list[Group]:
    """Its groups; the last one has no walks."""
    found = []
    for walks, lasting in (*shape.groups, ((), range(shape.border))):
        own = np.array(walks, dtype=np.intp)
        columns = (shape.size * own[:, None] + np.arange(shape.size)).ravel()
        found.append(Group(own, columns, np.array(lasting, dtype=np.intp)))
    return found


def random_chain(shape: Shape) -> Chain:
    """A chain with well-conditioned random contents."""
    chance = np.random.default_rng(shape.length)

    def positive(count: int) -> Array:
        rows = chance.normal(0.0, 1.0, (3 * count, count)) / np.sqrt(count)
        return np.asarray(rows.T @ rows + 0.1 * np.eye(count))

    chain = Chain(shape.length, shape.width, groups_of(shape))
    for strand in chain.strands:
        width = len(strand.group.columns)
        for j in range(shape.length):
            each = positive(width + len(strand.group.lasting))
            strand.diagonal[j] += each[:width, :width]
            strand.border[j] += each[:width, width:]
            strand.corner += each[width:, width:]
            for block in range(len(strand.group.walks) if j + 1 < shape.length else 0):
                own, each = slice(block * shape.size, (block + 1) * shape.size), positive(2 * shape.size)
                strand.diagonal[j, own, own] += each[: shape.size, : shape.size]
                strand.diagonal[j + 1, own, own] += each[shape.size :, shape.size :]
                strand.link[j, block] = each[shape.size :, : shape.size]
        strand.gradient[:] = chance.normal(0.0, 1.0, strand.gradient.shape)
        strand.corner_gradient[:] = chance.normal(0.0, 1.0, strand.corner_gradient.shape)
    return chain
