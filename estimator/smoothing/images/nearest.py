"""When somebody was nearest to a radio, or to the line through two: there he may have gone either way."""

import numpy as np
from numpy.typing import NDArray

from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Walk


def nearest(off_m: Array, walk: Walk, loose: NDArray[np.bool_], most: int, newest: int) -> list[int]:
    """Loose keyframes at which somebody was nearest; the first is one, if nobody knew him before.

    Args:
        off_m: how far off he was at each keyframe, k (m).
        walk: his.
        loose: see `loose_steps`.
        most: so many of them.
        newest: and so many of the last.
    """
    own = off_m[walk.first : walk.last + 1]
    at = np.flatnonzero((own[1:-1] <= own[:-2]) & (own[1:-1] < own[2:])) + 1
    if walk.begins:
        at = np.concatenate([[0], at])
    at = at[loose[walk.first + at]]
    found = at[np.argsort(own[at], kind="stable")[:most]]
    return sorted({*(walk.first + found).tolist(), *(walk.first + at[-newest:]).tolist()})
