"""The chain of one group of walks, with what it touches of the border.

Elimination along it is operation 3 of paper A (eq. 17), keyframe after keyframe; what stays at its end is a
Kirchhoff matrix of its part of the border. Cost grows with the length of the chain, not with its cube.
"""

from collections.abc import Sequence
from itertools import accumulate
from math import prod
from typing import NamedTuple

import numpy as np

from estimator.graph.assembly import add_motion
from estimator.graph.chain_kernels import Integers, eliminate, selected_inverse, substitute, take_off
from estimator.graph.dense import Array, mended
from estimator.graph.right_sides import carry, carry_back
from estimator.graph.scatter import scatter_rows
from estimator.graph.shared_errors import SharedErrors, eliminate_shared
from estimator.smoothing.chain.groups import Group, GroupedReadings
from estimator.smoothing.keyframes.walks import Motion


class WalkMotion(NamedTuple):
    """The linearised motion of one of a group's walks.

    Attributes:
        block: which of the group's walks it is.
        first: its first keyframe.
        last: its last one.
        motion: between its keyframes.
    """

    block: int
    first: int
    last: int
    motion: Motion


class Strand:
    """Normal matrix and gradient of a group, to be filled and then eliminated once.

    Attributes:
        group: its walks and its part of the border.
        diagonal: D, k × n × n.
        link: E, keyframe j + 1 by keyframe j, (k − 1) × blocks × b × b: a node's next step depends on no
            other's, so there are only blocks along its diagonal.
        wide: B and the gradient of the keyframes beside it, k × n × (s + 1).
        corner: C, s × s.
        corner_gradient: of the border, s.
        newton_decrement: gᵀ D⁻¹ g of the keyframes eliminated so far, each one's as it was by then.
    """

    def __init__(self, group: Group, blocks: Sequence[Array]) -> None:
        """Take what `strands_of` has laid out for it: nil so far."""
        self.group = group
        self.diagonal, self.link, self.wide, self.corner, self.corner_gradient = blocks
        self.newton_decrement = 0.0
        self._done = 0

    @property
    def border(self) -> Array:
        """B, k × n × s."""
        return self.wide[:, :, :-1]

    @property
    def gradient(self) -> Array:
        """Of the keyframes, k × n."""
        return self.wide[:, :, -1]

    def add(
        self, placed: GroupedReadings, chosen: Integers, jacobian: Array, information: Array, residual: Array
    ) -> None:
        """Add some of m rows.

        Args:
            placed: the rows.
            chosen: which of them; they are the group's.
            jacobian: derivatives, m × c.
            information: P⁻¹, m.
            residual: z − h(x), m.
        """
        if len(chosen):
            blocks = self.diagonal, self.wide, self.corner, self.corner_gradient
            scatter_rows(chosen, placed.slab, placed.columns, jacobian, information, residual, *blocks)

    def share(
        self,
        shared: SharedErrors,
        placed: GroupedReadings,
        jacobian: Array,
        information: Array,
        residual: Array,
    ) -> None:
        """Take off what its rows do not tell, for they share errors: see `eliminate_shared`."""
        if len(shared.own):
            blocks = self.diagonal, self.wide, self.corner, self.corner_gradient
            rows = placed.slab, placed.columns, jacobian, information, residual
            eliminate_shared(shared, *rows, *blocks)

    def add_motions(self, ways: Sequence[WalkMotion]) -> None:
        """Add the motion of its walks between keyframes.

        A keyframe at which a walk is not has its numbers for themselves: nothing depends on them.

        Args:
            ways: the motions; the last keyframe of one may lie behind the chain's.
        """
        length, size = len(self.diagonal), self.link.shape[2]
        for block, first, last, motion in ways:
            own = slice(size * block, size * (block + 1))
            if first > 0 or last + 1 < length:
                self.diagonal[:first, own, own] = np.eye(size)
                self.diagonal[last + 1 :, own, own] = np.eye(size)
            count = max(min(last, length - 1) - first, 0)
            steps = motion.transition[:count], motion.information[:count], motion.residual[:count]
            add_motion(block, first, *steps, self.diagonal, self.link, self.wide)

    def damp(self, damping: float) -> None:
        """Raise the diagonal by a share of itself (Marquardt)."""
        numbers, rest = range(self.diagonal.shape[1]), range(len(self.corner))
        self.diagonal[:, numbers, numbers] *= 1.0 + damping
        self.corner[rest, rest] *= 1.0 + damping

    def eliminate(self, until: int, mend: bool = True) -> None:
        """Eliminate the keyframes before one: the corner keeps what they say of the border.

        Args:
            until: not before one asked for earlier.
            mend: whether what is not positive definite is for rounding to answer for.

        Raises:
            ValueError: the matrix is not finite, or far from positive definite; or more keyframes have been
                eliminated already.
        """
        if until < self._done:
            raise ValueError(f"keyframes up to {self._done} are eliminated already: assemble the chain anew")
        if until == self._done or not len(self.group.walks):
            return
        at, mended_at = self._done, -1
        while at < until:
            at = eliminate(at, until, self.diagonal, self.link, self.wide)
            if at < until:
                if not np.isfinite(self.diagonal[at]).all():
                    raise ValueError("the normal equations of the incident are not finite")
                if not mend or at == mended_at:
                    raise ValueError("the normal equations of the incident are not positive definite")
                self.diagonal[at] = mended(self.diagonal[at])
                mended_at = at
        self.newton_decrement += take_off(self._done, until, self.wide, self.corner, self.corner_gradient)
        self._done = until

    def log_determinants(self) -> Array:
        """After its elimination: what each of its walks adds to log |L|, blocks.

        Of those that readings couple each is told after the ones before it.
        """
        roots = np.log(np.diagonal(self.diagonal, axis1=1, axis2=2)).sum(axis=0)
        return np.asarray(-2.0 * roots.reshape(self.link.shape[1:3]).sum(axis=1))

    def substitute(self, fixed: Array) -> Array:
        """Steps of the keyframes, k × n, for a step of its part of the border, s."""
        steps = np.zeros(self.gradient.shape)
        if steps.size:
            substitute(self.diagonal, self.link, self.wide, fixed, steps)
        return steps

    def carry(self, y: Array, rest: Array) -> None:
        """Carry right sides to its end: `y` of the keyframes, k × n × c, and `rest` of the border, s × c."""
        if y.shape[1]:
            carry(self.diagonal, self.link, self.wide, y, rest)

    def carry_back(self, y: Array, fixed: Array) -> None:
        """Answers in the place of what `carry` left in `y`, for those of the border, s × c."""
        if y.shape[1]:
            carry_back(self.diagonal, self.link, self.wide, y, fixed)

    def covariances(self, border: Array) -> tuple[Array, Array]:
        """Of each walk at each keyframe, k × walks × b × b, and with itself at the next one.

        The selected inverse, from the end back to the start: only what the keyframe before and the border
        need is ever formed.

        Args:
            border: covariance of its part of the border, s × s.
        """
        length, blocks, size, _ = len(self.diagonal), *self.link.shape[1:]
        found = np.zeros((length, blocks, size, size))
        ahead = np.zeros((max(length - 1, 0), blocks, size, size))
        if blocks:
            selected_inverse(self.diagonal, self.link, self.wide, border, found, ahead)
        return found, ahead


def strands_of(length: int, groups: Sequence[Group]) -> list[Strand]:
    """The strands of a chain, nil so far, in one block of memory.

    A block of megabytes is given in pages of megabytes. Each array by itself would get them four kilobytes at
    a time, and having pages made takes longer than what a step of a whole incident does with them.

    Args:
        length: how many keyframes.
        groups: one for each strand.
    """
    shapes = [_shapes(length, group) for group in groups]
    ends = list(accumulate(prod(shape) for own in shapes for shape in own))
    memory, strands, at, each = np.zeros(ends[-1]), list[Strand](), 0, iter(ends)
    for group, own in zip(groups, shapes, strict=True):
        blocks = []
        for shape in own:
            end = next(each)
            blocks.append(memory[at:end].reshape(shape))
            at = end
        strands.append(Strand(group, blocks))
    return strands


def _shapes(length: int, group: Group) -> tuple[tuple[int, ...], ...]:
    """Of D, E, B with its gradient, C and its gradient."""
    width, border, blocks = len(group.columns), len(group.lasting), len(group.walks)
    size = width // max(blocks, 1)
    link = max(length - 1, 0), blocks, size, size
    return (length, width, width), link, (length, width, border + 1), (border, border), (border,)
