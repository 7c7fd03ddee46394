"""Right sides carried through a chain that `chain_kernels.eliminate` has eliminated, and back, compiled."""

import numpy as np
from numba import njit

from estimator.graph.dense import Array


@njit(cache=True, nogil=True)
def carry(diagonal: Array, link: Array, wide: Array, y: Array, rest: Array) -> None:
    """Right sides to the end after `eliminate`: `y` of keyframes, k × n × c; `rest`, of the border, s × c."""
    length, width, count = y.shape
    size, back = link.shape[2], np.empty((width, count))
    for j in range(length):
        for r in range(width - 1, -1, -1):
            y[j, r] *= diagonal[j, r, r]
            for c in range(r):
                for i in range(count):
                    y[j, r, i] += diagonal[j, r, c] * y[j, c, i]
            for s in range(len(rest)):
                for i in range(count):
                    rest[s, i] -= wide[j, r, s] * y[j, r, i]
        if j == length - 1:
            break
        back[:] = 0.0
        for r in range(width):
            for c in range(r + 1):
                for i in range(count):
                    back[c, i] += diagonal[j, r, c] * y[j, r, i]
        for r in range(width):
            block = r // size
            for c in range(size):
                for i in range(count):
                    y[j + 1, r, i] -= link[j, block, r - block * size, c] * back[block * size + c, i]


@njit(cache=True, nogil=True)
def carry_back(diagonal: Array, link: Array, wide: Array, y: Array, fixed: Array) -> None:
    """Answers in the place of what `carry` left in `y`, k × n × c, for those of the border, s × c."""
    length, width, count = y.shape
    size, carried, ahead = link.shape[2], np.empty((width, count)), np.empty((width, count))
    for j in range(length - 1, -1, -1):
        for r in range(width):
            for i in range(count):
                ahead[r, i] = y[j, r, i]
            for s in range(len(fixed)):
                for i in range(count):
                    ahead[r, i] -= wide[j, r, s] * fixed[s, i]
        if j < length - 1:
            for c in range(width):
                block = c // size
                for i in range(count):
                    total = 0.0
                    for r in range(size):
                        total += link[j, block, r, c - block * size] * y[j + 1, block * size + r, i]
                    carried[c, i] = total
            for r in range(width):
                for c in range(r + 1):
                    for i in range(count):
                        ahead[r, i] -= diagonal[j, r, c] * carried[c, i]
        for c in range(width):
            for i in range(count):
                total = 0.0
                for r in range(c, width):
                    total += diagonal[j, r, c] * ahead[r, i]
                y[j, c, i] = total
