"""Readings of a link as if it had been read once a second."""

import numpy as np
from numba import njit

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array

EACH_S = 1.0 - 1e-3
"""Epochs jitter: a reading of the next second may come a little early."""


@njit(cache=True, error_model="numpy")
def once_a_second(t: Array, link: Integers, alike: Array) -> tuple[Integers, Array]:
    """One reading of each link a second, and which number in its row of alike readings each would be then.

    Args:
        t: epochs, those of one link in order, m (s).
        link: number of each one's link, m; −1: it is of none, and stays.
        alike: which number in its row of alike readings each is, m: see `fusion.learned.link_correlation`.

    Returns:
        Which readings these are; and what `alike` would be of them, m, as it is of the others.
    """
    links = link.max() + 1 if len(link) else 0
    taken, before, kept = np.full(links, -1), np.ones(links), np.ones(links)
    chosen, rarer = np.zeros(len(t), dtype=np.bool_), alike.copy()
    for i in range(len(t)):
        k = link[i]
        if k >= 0:
            # What the reading before it had in common with this one, and that with the last one taken.
            kept[k] *= min(max((alike[i] - 1.0) / before[k], 0.0), 1.0)
            before[k] = alike[i]
            if taken[k] >= 0:
                if t[i] - t[taken[k]] < EACH_S:
                    continue
                rarer[i] = 1.0 + kept[k] * rarer[taken[k]]
            taken[k], kept[k] = i, 1.0
        chosen[i] = True
    return np.flatnonzero(chosen), rarer
