"""Which readings between nodes have their places in a window."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion.memory.ledger import RSSI
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.ends import FREE, UNIT
from estimator.smoothing.keyframes.ground import Supports
from estimator.smoothing.keyframes.losses import Losses, loss_column


class Selection(NamedTuple):
    """Which of m pairs have their places in a window.

    Attributes:
        chosen: m.
        extra: columns of its technology, three, and of what it loses, m × 4; −1: it has none.
        slab: keyframe, m.
        inside: it is a range or a power, and no end is outside the building, m.
    """

    chosen: NDArray[np.bool_]
    extra: Integers
    slab: Integers
    inside: NDArray[np.bool_]


@njit(cache=True)
def choose(
    pairs: Array,
    a: Supports,
    b: Supports,
    technology: Integers,
    losses: Losses,
    width: int,
    outside: NDArray[np.bool_],
) -> Selection:
    """Choose the pairs whose ends and technology have places in a window.

    Args:
        pairs: rows of the ledger, m × 10.
        a: their first ends.
        b: their second ends.
        technology: first column of each, kinds × sources; −1: there is none.
        losses: what ranges and powers lose.
        width: columns of a keyframe.
        outside: whether each node of the ledger is outside the building.
    """
    m = len(pairs)
    chosen, inside = np.empty(m, dtype=np.bool_), np.empty(m, dtype=np.bool_)
    extra, slab = np.full((m, 4), -1), np.empty(m, dtype=np.int64)
    for i in range(m):
        kind, source, first, second = int(pairs[i, 1]), int(pairs[i, 6]), int(pairs[i, 2]), int(pairs[i, 3])
        if kind <= RSSI and source >= 0 and technology[kind, source] >= 0:
            for c in range(3):
                extra[i, c] = technology[kind, source] + c
        if losses.columns.size:
            lost = loss_column(losses, pairs[i])
            extra[i, 3] = width + lost if lost >= 0 else -1
        a_moves, b_moves = a.kind[i] in (UNIT, FREE), b.kind[i] in (UNIT, FREE)
        chosen[i] = a.usable[i] and b.usable[i] and (extra[i, 0] >= 0 or kind > RSSI)
        if (a_moves and b_moves and a.slab[i] != b.slab[i]) or (a.columns[i, 0] < 0 and b.columns[i, 0] < 0):
            chosen[i] = False
        slab[i] = a.slab[i] if a_moves else b.slab[i]
        inside[i] = kind <= RSSI and not outside[first] and not outside[second]
    return Selection(chosen, extra, slab, inside)
