"""Encounters: a responder passes a radio, and its signal is at its strongest (paper A, section V-A).

Within 1.5 m signal strength is accurate even in fire, so such a reading is nearly a fix. It is told by
itself, a local maximum above the near threshold, and by the estimate, which must put both ends close to each
other.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array

SPAN_S, LEAST = physics.ENCOUNTER_S, physics.ENCOUNTER_READINGS


@njit(cache=True)
def candidates(t: Array, link: Array, value: Array) -> NDArray[np.bool_]:
    """Which readings are the strongest of their link within `physics.ENCOUNTER_S` before and after, m (bool).

    Args:
        t: epochs, m (s).
        link: number of the link of each, m.
        value: powers, m (dBm).
    """
    if (t[:-1] <= t[1:]).all():
        return strongest(t, link, value)
    order, found = np.argsort(t, kind="mergesort"), np.zeros(len(t), dtype=np.bool_)
    found[order] = strongest(t[order], link[order], value[order])
    return found


@njit(cache=True)
def strongest(t: Array, link: Array, value: Array) -> NDArray[np.bool_]:
    """Which values are the largest of their link within `SPAN_S` before and after, m, if there are `LEAST`.

    Args:
        t: ascending, m (s).
        link: number of the link of each, m.
        value: m.
    """
    order, found = link_by_link(link), np.zeros(len(t), dtype=np.bool_)
    for place in range(len(t)):
        i, best, near = order[place], True, 1
        for step in (-1, 1):
            beside = place + step
            while best and 0 <= beside < len(t):
                j = order[beside]
                if link[j] != link[i] or abs(t[j] - t[i]) > SPAN_S:
                    break
                near, best = near + 1, not value[j] > value[i]
                beside += step
        found[i] = best and near >= LEAST
    return found


@njit(cache=True)
def link_by_link(link: Array) -> Integers:
    """The order that puts readings of one link behind each other, each link's as they were, m.

    Links have small numbers: they are counted, not compared.

    Args:
        link: number of the link of each, m.
    """
    order = np.empty(len(link), dtype=np.int64)
    if len(link) == 0:
        return order
    least = int(link.min())
    following = np.zeros(int(link.max()) - least + 2, dtype=np.int64)
    for i in range(len(link)):
        following[int(link[i]) - least + 1] += 1
    following = following.cumsum()
    for i in range(len(link)):
        own = int(link[i]) - least
        order[following[own]] = i
        following[own] += 1
    return order
