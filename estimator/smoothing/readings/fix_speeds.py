"""How fast somebody flies at each of his fixes, by where he was around it: what a fix that is late is off by.

It is told by where he was thought to be, as a number that is known. Velocities of keyframes are free to be
anything: they would take up what fixes are off by at random, the more the later these are taken to be. And
fixes alone do not tell speeds well enough: what these are off by makes late fixes fit worse than they do.
"""

import numpy as np

from estimator.fusion.memory.ledger import own_rows
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array

AROUND_S = 4.0
"""By so many seconds before and after."""
FEWEST = 3
PLACES = slice(3, 6)
"""Where the ledger's `poses` tell places."""


def fix_speeds(singles: Array, late: Integers, poses: Array) -> Array:
    """Slope of the line through the places around each fix, along its axis, n (m/s); 0 of what is not late.

    Args:
        singles: rows of the ledger, n × 7.
        late: where how late each is stands; −1: nowhere, n.
        poses: rows of the ledger, where everybody was thought to be.
    """
    found, asked = np.zeros(len(singles)), late >= 0
    if not asked.any():
        return found
    for number in np.unique(singles[asked, 1]).astype(np.int64).tolist():
        mine = np.flatnonzero(asked & (singles[:, 1] == number))
        known = own_rows(poses, number)
        if len(known) < FEWEST:
            continue
        t, places_m = known[:, 0] - known[0, 0], known[:, PLACES] - known[0, PLACES]
        read_t, axis = singles[mine, 0] - known[0, 0], singles[mine, 2].astype(np.int64)
        first, after = np.searchsorted(t, read_t - AROUND_S), np.searchsorted(t, read_t + AROUND_S)

        def over(each: Array, first: Integers = first, after: Integers = after) -> Array:
            up_to = np.concatenate([[0.0], np.cumsum(each)])
            return np.asarray(up_to[after] - up_to[first])

        by_m, products = np.zeros(len(mine)), np.zeros(len(mine))
        for c in range(places_m.shape[1]):
            own = axis == c
            by_m[own], products[own] = over(places_m[:, c])[own], over(t * places_m[:, c])[own]
        count, by_t = (after - first).astype(np.float64), over(t)
        spread = count * over(t * t) - by_t**2
        told = (count >= FEWEST) & (spread > 1e-6)
        found[mine[told]] = (count * products - by_t * by_m)[told] / spread[told]
    return found
