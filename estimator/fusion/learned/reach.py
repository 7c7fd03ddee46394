"""How far radios reach, as silence tells: where somebody leaves a radio's reach, or comes back into it.

That a radio is heard at all tells where one is (Bulusu, Heidemann and Estrin 2000, "GPS-less low-cost outdoor
localization for very small devices"). A single power, which scatters by 5 dB, places nobody at 25 m; the
second in which a radio falls silent may be sharp to half a metre, or mean nothing, for reaches differ as
walls and batteries do. Which of both is learned: by how much they differ is anything beforehand, uniform in
its logarithm, and what crossings miss by tells (Gelman 2006, "Prior distributions for variance parameters in
hierarchical models").
"""

import math
from bisect import bisect_left
from collections.abc import Sequence
from functools import lru_cache
from typing import Self

import msgspec
import numpy as np
from msgspec.structs import replace
from numba import njit

from estimator.graph.dense import Array
from estimator.measurements.rssi import DB_PER_NEPER

EXPONENT = 2.5
"""A reach is held in decibels of a law with this exponent, by which they are the logarithm of a length."""
REACH_DB, REACH_SIGMA_DB = 10.0 * EXPONENT * math.log10(22.0), 10.0
"""Beforehand a reach is 22 m, or from 9 to 55 m."""
EXPONENT_SIGMA = 1e-3
SPREADS_DB2 = (np.geomspace(0.02, 0.6, 9) * EXPONENT * DB_PER_NEPER) ** 2
LOGARITHMS = np.log(SPREADS_DB2)
"""Variances that stand for all, and their logarithms: reaches that differ by 2 % to 60 %. Sharper than half
of a step's length at 25 m none can be told."""
UNTOLD = (0.0,) * len(SPREADS_DB2)
"""Their log likelihoods where no crossing has told."""
NOMINAL_DB = 3.0
"""The unit in which the noise of a crossing is written down before it is learned."""
SHARED = 0.9
"""Share of that variance that crossings of one reach at one place have in common."""
OUTLIERS, OUTLIER_DB2 = 0.05, 400.0
"""A radio that was switched off or carried away fell silent anywhere."""
HEARD_LEAST = 30
"""Packets from which it is first told how many are lost."""
LOST = (0.02, 0.065)
"""Up to which share of lost packets a radio that is missed once, or twice in a row, is out of reach."""
MOST_SILENT = len(LOST)


class Reach(msgspec.Struct, frozen=True, array_like=True):
    """What has been learned of how far radios reach.

    Attributes:
        heard: packets from radios in reach.
        lost: packets from such radios that were not heard.
        logs: log likelihood of each of `SPREADS_DB2` less the largest; empty: no crossing has told.
    """

    heard: int = 0
    lost: int = 0
    logs: tuple[float, ...] = ()

    @property
    def silent(self) -> int | None:
        """Occasions in a row at which a radio in reach is hardly missed by chance.

        None: so many packets are lost that silence tells nothing, or too few are known.
        """
        rate = (self.lost + 1.0) / (self.heard + 2.0)
        if self.heard < HEARD_LEAST or rate > LOST[-1]:
            return None
        return 1 + bisect_left(LOST, rate)

    @property
    def sigma_db(self) -> float:
        """By how much reaches differ (dB), in the mean of its logarithm."""
        return mean_sigma_db(self.logs or UNTOLD)

    @property
    def _logs(self) -> Array:
        return np.array(self.logs or UNTOLD)

    def with_packets(self, heard: int, lost: int) -> Self:
        """What is known after more packets."""
        return replace(self, heard=self.heard + heard, lost=max(self.lost + lost, 0))

    def with_crossings(self, off_db: Sequence[float], variance_db2: Sequence[float]) -> Self:
        """What is known after crossings.

        Args:
            off_db: what each is off by (dB).
            variance_db2: of what was predicted of each (dB²).
        """
        spread, squared = np.array(variance_db2)[:, None] + SPREADS_DB2, [off**2 for off in off_db]
        logs = self._logs
        follow(logs, np.array(squared), np.array(variance_db2), spread, np.log(spread))
        return replace(self, logs=tuple(logs.tolist()))


@njit(cache=True)
def follow(logs: Array, squared: Array, variance: Array, spread: Array, log_spread: Array) -> None:
    """Hold crossings against each spread of reaches, one after the other.

    Args:
        logs: log likelihood of each spread less the largest, changed.
        squared: the square of what each crossing is off by, k (dB²).
        variance: of what was predicted of it, k (dB²).
        spread: the same with each spread's own, k × spreads (dB²).
        log_spread: logarithms of these.
    """
    for r in range(len(squared)):
        wide = variance[r] + OUTLIER_DB2
        odd = math.log(OUTLIERS) - 0.5 * (squared[r] / wide + math.log(wide))
        likeliest = -np.inf
        for i in range(len(logs)):
            good = math.log(1.0 - OUTLIERS) - 0.5 * (squared[r] / spread[r, i] + log_spread[r, i])
            logs[i] += np.logaddexp(good, odd)
            likeliest = max(likeliest, logs[i])
        for i in range(len(logs)):
            logs[i] -= likeliest


@lru_cache(maxsize=64)
def mean_sigma_db(logs: tuple[float, ...]) -> float:
    """The standard deviation of reaches, in the mean of its logarithm (dB): each tick asks for it twice.

    Args:
        logs: log likelihood of each of `SPREADS_DB2` less the largest.
    """
    weight = np.exp(np.array(logs) - max(logs))
    return math.exp(0.5 * float(np.add.reduce(weight * LOGARITHMS) / np.add.reduce(weight)))


def in_metres(level_db: float, off_db: float, sigma_db: float) -> tuple[float, float, float]:
    """How far radios reach, by how much more that is than where a crossing was, and its sigma (m).

    Args:
        level_db: the reach, as P0 of its law (dB).
        off_db: by how much weaker the law is where the crossing was (dB).
        sigma_db: of the crossing (dB).
    """
    reach_m = 10.0 ** (level_db / (10.0 * EXPONENT))
    off_m = reach_m * (1.0 - 10.0 ** (off_db / (10.0 * EXPONENT)))
    return reach_m, off_m, reach_m * sigma_db / (EXPONENT * DB_PER_NEPER)
