"""What readings that follow each other on one link have in common."""

import math
from typing import Self

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.graph.dense import Array, Indices

T, WAY, ALIKE, KEPT, ERROR, VALUE, ECHO_M, LOWER_S, ECHO_ODDS = range(9)
TOLD, REPEATS, SINCE_T, SINCE_WAY, UNKNOWN, TAKEN, DRIFTS = range(9, 16)
WALLS_M, SCATTER_M2, DOUBT_M2 = range(16, 19)
"""Columns of a link's newest reading: its epoch; how far both ends had walked by then (m); how many readings,
itself included, share its error; how much of the error before it still held, 0 to 1; its error in units of
the assumed sigma, NaN before it is fused. Of ranges, see `echoes`: what was read (m); what it is too long by,
or below 0 how much shorter it is than was believed before (m); for how long (s); log odds that it is. See
`repeated_ranges`: what was told (m), believed or not; how often in a row; since when it is another value than
before (s), and how far both ends had walked by then (m). See `power_sigma`: of what the link's powers share,
the share of its variance that those before leave unknown; and how much of a number that all of them are off
by is taken up by it, 0 to 1; whether an end moves and has no unit. Of ranges, what walls add (m), and what
that scatters by of each and is unsure by of all (m²), as the newest window tells."""
NEW = (-math.inf, 0.0, 0.0, 0.0, math.nan, *(0.0,) * 4, math.nan, 0.0, -math.inf, 0.0, 1.0, *(0.0,) * 5)
"""Nothing is left of a reading that was made an eternity ago."""
NONE: Array = np.zeros((0, len(NEW)))
SPARE = 16
SAME_PLACE = 0.5
"""A reading that keeps more of the error of the one before was made where that was made."""


class Links:
    """The newest reading on each link, as a table that grows by doubling.

    Args:
        numbers: the row of each link.
        table: their newest readings, links × 19 or more; both are taken over.

    Attributes:
        numbers: the row of each link, which is its number in the ledger as well, by the technology that its
            noise is learned for and the names of both ends, in order; copies share it, so it is never changed
            but replaced.
    """

    def __init__(self, numbers: dict[tuple[str, str, str], int] | None = None, table: Array = NONE) -> None:
        self.numbers = {} if numbers is None else numbers
        self._table = table

    def copy(self) -> Self:
        """An independent copy."""
        return type(self)(self.numbers, self._table.copy())

    @property
    def table(self) -> Array:
        """The newest readings, links × 19: a view, changed in place."""
        return self._table[: len(self.numbers)]

    def number(self, source: str, a: str, b: str) -> int:
        """The number of the link of a technology between two nodes, in either direction."""
        link = (source, a, b) if a < b else (source, b, a)
        found = self.numbers.get(link)
        if found is None:
            found = len(self.numbers)
            self.numbers = {**self.numbers, link: found}
            if found == len(self._table):
                self._table = np.concatenate([self._table, np.tile(NEW, (found + SPARE, 1))])
        return found

    def tell_walls(self, numbers: Indices, walls_m: Array, scatter_m2: Array, doubt_m2: Array) -> None:
        """Keep what walls add to ranges.

        Args:
            numbers: the link of each of m readings, the newest of each link last; −1: it has none.
            walls_m: what each is too long by, m (m).
            scatter_m2: variance that each has by it for itself, m (m²).
            doubt_m2: variance that those of one link share, m (m²).
        """
        known = numbers >= 0
        told = np.stack([walls_m, scatter_m2, doubt_m2], axis=1)
        self.table[numbers[known], WALLS_M:] = told[known]

    def renew(self, node: str) -> None:
        """Forget the errors of a node's links: it lies elsewhere."""
        for (_, a, b), number in self.numbers.items():
            if node in (a, b):
                self.table[number] = NEW


@njit(cache=True, error_model="numpy")
def follow(link: Array, t: float, way_m: float) -> None:
    """Go on to the next reading on a link.

    Args:
        link: its row, 19, changed.
        t: epoch of the reading (s).
        way_m: how far both ends have walked by then (m).
    """
    moved, waited = abs(way_m - link[WAY]), abs(t - link[T])
    kept = math.exp(-moved / physics.SHARED_M - waited / physics.SHARED_S)
    link[T], link[WAY], link[ALIKE], link[KEPT] = t, way_m, 1.0 + kept * link[ALIKE], kept
    for known in range(WALLS_M, DOUBT_M2 + 1):
        link[known] *= kept
    link[UNKNOWN], link[TAKEN] = kept**2 * link[UNKNOWN] + 1.0 - kept**2, kept * link[TAKEN]


@njit(cache=True, error_model="numpy")
def power_sigma(link: Array, factor: float, shared: float, nominal: float) -> float:
    """Standard deviation to give to the next power on a link: by what it adds to those before it (dB).

    What the powers of a link share is forgotten as an end walks on, a first-order Gauss-Markov process seen
    through noise of each. Each counts for what it tells of a number that all of them are off by, once the
    process is known as far as those before it tell (Bryson, Henrikson 1968): k readings at one place count
    for k / (w + k c) together, with w the variance of each alone and c the common one, and n on a long way
    for n / (w + c (1 + ρ) / (1 - ρ)), where ρ is what one keeps of the one before.

    Args:
        link: its row, 19, gone on to the reading (`follow`); changed.
        factor: learned standard deviation of the technology over the assumed one.
        shared: share of the variance that is common.
        nominal: assumed standard deviation (dB).
    """
    total = (nominal * factor) ** 2
    common = shared * total
    unknown, taken = link[UNKNOWN] * common, link[TAKEN]
    variance = unknown + total - common
    gain = unknown / variance
    link[UNKNOWN], link[TAKEN] = (1.0 - gain) * link[UNKNOWN], taken + gain * (1.0 - taken)
    return float(max(math.sqrt(variance) / (1.0 - taken), physics.SIGMA_FLOOR_M))
