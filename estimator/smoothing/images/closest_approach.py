"""When somebody was nearest to a radio, or to the line through two: there he may have gone either way."""

import numpy as np
from numpy.typing import NDArray

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Walk


def closest_approaches(
    off_m: Array, walk: Walk, loose: NDArray[np.bool_], most: int, newest: int
) -> list[int]:
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
    if walk.way is not None:
        at = np.union1d(at, _ends(own, loose[walk.first : walk.last + 1]))
    found = at[np.argsort(own[at], kind="stable")[:most]]
    return sorted({*(walk.first + found).tolist(), *(walk.first + at[-newest:]).tolist()})


def _ends(own_m: Array, loose: NDArray[np.bool_]) -> Integers:
    """Where somebody was nearest of a stretch that nothing led, if that is where it begins or ends.

    Args:
        own_m: how far off he was at each keyframe of his life, k (m).
        loose: see `loose_steps`, k.
    """
    turns = np.flatnonzero(np.diff(loose, prepend=False, append=False))
    firsts, ends = turns[::2], turns[1::2]
    # Where it begins he was known: from the next keyframe on he may have been elsewhere.
    away = firsts[(own_m[firsts] <= own_m[firsts + 1]) & (ends > firsts + 1)] + 1
    led = ends[ends < len(own_m) - 1]
    towards = led[own_m[led] <= own_m[led - 1]] - 1
    return np.concatenate([away, towards])
