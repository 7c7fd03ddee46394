"""How many powers of a link share an error with each of them, before it and after it."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion.memory.ledger import RSSI
from estimator.graph.dense import Array

KIND, LINK = 1, 9
"""Columns of the ledger's pairs."""


@njit(cache=True, error_model="numpy")
def powers_sharing(pairs: Array, alike: Array, drifts: NDArray[np.bool_]) -> Array:
    """How many powers of its link share the error of each power of who has no unit, itself included, m.

    0: it is none of these.

    Each is to count for as much as the others that share its error: n at one place have n of them, and on a
    long way each has (1 + ρ) / (1 - ρ), where ρ is what one keeps of the error of the one before. Then they
    are worth together what their mean is (Bayley, Hammersley 1946).

    Args:
        pairs: rows of the ledger, m × 11, those of one link in order of epoch.
        alike: which number in its row of alike readings each is, m: see `fusion.learned.link_correlation`.
        drifts: whether an end moves and has no unit, m.
    """
    links = 0
    for i in range(len(pairs)):
        links = max(links, int(pairs[i, LINK]) + 1)
    found, from_now, next_alike = np.zeros(len(pairs)), np.zeros(links), np.ones(links)
    for i in range(len(pairs) - 1, -1, -1):
        k = int(pairs[i, LINK])
        if k < 0 or int(pairs[i, KIND]) != RSSI or not drifts[i]:
            continue
        kept = min(max((next_alike[k] - 1.0) / alike[i], 0.0), 1.0)
        from_now[k], next_alike[k] = 1.0 + kept * from_now[k], alike[i]
        found[i] = alike[i] + from_now[k] - 1.0
    return found


@njit(cache=True)
def sharing_counts(kept: Array) -> Array:
    """How many of n in a row share the error of each, itself included, by what each keeps of the one before.

    Each is to count for as much as these: see `powers_sharing`.

    Args:
        kept: what each keeps of the error of the one before, but for the first, n − 1.
    """
    n = len(kept) + 1
    before, after = np.ones(n), np.ones(n)
    for k in range(1, n):
        before[k] = 1.0 + kept[k - 1] * before[k - 1]
        after[n - 1 - k] = 1.0 + kept[n - 1 - k] * after[n - k]
    found: Array = before + after - 1.0
    return found
