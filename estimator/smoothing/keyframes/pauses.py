"""When a unit told nothing for a while, or the same all along: it may have been switched off, or stood."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.memory.nodes import NodeState
from estimator.smoothing.keyframes.displacement_sums import Way

PAUSE_S = 3.0


def paused_until(node: NodeState, way: Way, since_t: float, now: float) -> float | None:
    """When a unit began to tell again (s), if it did since an epoch; None: it has told all along.

    Args:
        node: of the unit.
        way: what it has told.
        since_t: the epoch (s).
        now: newest epoch (s).
    """
    whole_t = node.whole_t
    if not max(since_t, way.begin_t + 2.0 * PAUSE_S) < whole_t < now:
        return None
    before, until = way.unseen_s(np.array([whole_t - 2.0 * PAUSE_S, whole_t])).tolist()
    return whole_t if until - before > PAUSE_S else None


def runs(chosen: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """First and last of each run of chosen ones, of m."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(np.int8)))
    yield from zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True)
