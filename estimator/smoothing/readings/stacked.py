"""The readings of a window one below the other, and what is known of their noise, compiled."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.learned.noise import single_sigma
from estimator.fusion.memory.ledger import BEARING, RANGE
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.ends import FREE
from estimator.smoothing.keyframes.ground import Supports
from estimator.smoothing.readings.sharing import powers_sharing

DROP = len(physics.NOISES) - 1
NOISES = np.array(physics.NOISES)


class StackedReadings(NamedTuple):
    """m pairs, n singles and d drops as m + n + 3 d rows; see `rows.Rows`."""

    t: Array
    slab: Integers
    columns: Integers
    noise: Array
    nominal: Array
    source: Integers
    alike: Array
    sharing: Array


class Scatter(NamedTuple):
    """What is known of the noise of m rows.

    Attributes:
        white: variance of each that is its own, m.
        common: variance that it shares with those of its link, m.
        outliers: how often each is one, m.
    """

    white: Array
    common: Array
    outliers: Array


@njit(cache=True)
def arrange(
    pairs: Array,
    singles: Array,
    drops: Array,
    slab: Integers,
    extra: Integers,
    off: Integers,
    a: Supports,
    b: Supports,
    on: Supports,
    by: Supports,
    crumb: Supports,
) -> StackedReadings:
    """Put readings one below the other: pairs, then singles, then drops (three rows each).

    Args:
        pairs: rows of the ledger, m × 11.
        singles: the same, n × 7.
        drops: the same, d × 3.
        slab: keyframe of each pair, m.
        extra: columns of its technology and of what it loses, m × 4; −1: it has none.
        off: columns of what each single's altimeter or receiver is off by, and how late, n × 2; −1: none.
        a: first ends of the pairs.
        b: second ends.
        on: ends of the singles.
        by: who dropped.
        crumb: what was dropped.
    """
    m, n, size = len(pairs), len(singles), a.columns.shape[1]
    count = m + n + 3 * len(drops)
    t, nominal, alike, noise = np.empty(count), np.empty(count), np.ones(count), np.empty((count, 3))
    sharing = np.zeros(count)
    found, source = np.empty(count, dtype=np.int64), np.full(count, -1)
    shared = 4 if (extra[:, 3] >= 0).any() else 3
    columns = np.full((count, 2 * size + shared), -1)
    for i in range(m):
        kind = int(pairs[i, 1])
        t[i], found[i], nominal[i], alike[i] = pairs[i, 0], slab[i], pairs[i, 5], pairs[i, 8]
        if kind < BEARING:
            source[i] = int(pairs[i, 6])
        for c in range(shared):
            columns[i, 2 * size + c] = extra[i, c]
        for c in range(size):
            columns[i, c], columns[i, size + c] = a.columns[i, c], b.columns[i, c]
        for c in range(3):
            noise[i, c] = NOISES[kind, c]
    for k in range(n):
        i, kind = m + k, int(singles[k, 5])
        t[i], found[i], nominal[i] = singles[k, 0], on.slab[k], singles[k, 4]
        columns[i, 2 * size], columns[i, 2 * size + 1] = off[k, 0], off[k, 1]
        for c in range(size):
            columns[i, c] = on.columns[k, c]
        for c in range(3):
            noise[i, c] = NOISES[kind, c]
    for k in range(3 * len(drops)):
        i, drop = m + n + k, k // 3
        t[i], found[i], nominal[i] = drops[drop, 0], by.slab[drop], physics.DROP_SIGMA_M[k % 3]
        for c in range(size):
            columns[i, c], columns[i, size + c] = by.columns[drop, c], crumb.columns[drop, c]
        for c in range(3):
            noise[i, c] = NOISES[DROP, c]
    sharing[:m] = powers_sharing(pairs, alike, (a.kind == FREE) | (b.kind == FREE))
    return StackedReadings(t, found, columns, noise, nominal, source, alike, sharing)


@njit(cache=True)
def scattered(learned: Array, rows: StackedReadings, kinds: Integers, inside: NDArray[np.bool_]) -> Scatter:
    """What has been learned of the technologies and of walls, for each row.

    Args:
        learned: of each technology factor, shared variance and share of outliers, × 3.
        rows: the readings.
        kinds: of the pairs in front, m.
        inside: which pairs are ranges or powers inside the building, m.
    """
    count = len(rows.nominal)
    white, common, outliers = np.empty(count), np.zeros(count), np.empty(count)
    for i in range(count):
        source = rows.source[i]
        factor, shared, outliers[i] = 1.0, 0.0, rows.noise[i, 0]
        if source >= 0:
            factor, shared, outliers[i] = learned[source, 0], learned[source, 1], learned[source, 2]
        total = (rows.nominal[i] * factor) ** 2
        white[i] = (1.0 - shared) * total
        common[i] = total - white[i]
        if i < len(kinds) and inside[i] and kinds[i] == RANGE:
            common[i] += physics.WALL_M**2
    return Scatter(white, common, outliers)


@njit(cache=True, error_model="numpy")
def sigmas(white: Array, common: Array, rows: StackedReadings) -> Array:
    """Standard deviations of rows, m: those of technologies by their variances, others as they were told."""
    found = rows.nominal.copy()
    for i in range(len(found)):
        if rows.sharing[i] > 0.0:
            found[i] = max(math.sqrt(white[i] + rows.sharing[i] * common[i]), physics.SIGMA_FLOOR_M)
        elif rows.source[i] >= 0:
            found[i] = single_sigma(white[i], common[i], rows.alike[i])
    return found
