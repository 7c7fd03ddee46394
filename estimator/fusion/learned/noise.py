"""How far off a technology's readings are, as learned, and what is common to those of one link.

Walls, bodies and furniture between two radios stay while nobody moves: the errors of readings on one link are
alike until an end has moved on. Taken for independent, they would make any estimate far too sure of itself.
"""

import math

import msgspec
import numpy as np
from numba import njit

from estimator.fusion import physics


class LearnedNoise(msgspec.Struct, frozen=True, array_like=True):
    """Errors of one technology, in units of its claimed or assumed sigma.

    Attributes:
        count: readings that it is learned from; older ones are forgotten.
        squares: sum of their squared errors.
        pairs: successive readings on links that it is learned from.
        products: sum of the products of their errors.
        seen: readings that the share of outliers is learned from.
        odd: how many of them were outliers.
        t: until when it has been learned (s); None: it is assumed.
        least: of `factor`.
    """

    count: float = physics.NOISE_PRIOR
    squares: float = physics.NOISE_PRIOR
    pairs: float = physics.NOISE_PRIOR
    products: float = physics.NOISE_PRIOR * physics.SHARED_NOISE
    seen: float = 0.0
    odd: float = 0.0
    t: float | None = None
    least: float = 0.3

    @property
    def factor(self) -> float:
        """Learned standard deviation over the claimed or assumed one.

        Of most a scatter below a third tells nothing of what is alike in many readings: antennas, multipath.
        """
        return min(max(math.sqrt(max(self.squares, 0.0) / self.count), self.least), 2.0)

    @property
    def shared(self) -> float:
        """Share of the variance that successive readings on one link have in common, 0 to 0.95."""
        return self.terms(0.0)[1]

    def outliers(self, usual: float) -> float:
        """Share of outliers, from the usual one on."""
        return float((self.odd + physics.OUTLIER_PRIOR * usual) / (self.seen + physics.OUTLIER_PRIOR))

    def terms(self, usual: float) -> tuple[float, float, float]:
        """`factor`, `shared` and `outliers` from the usual share on, worked out together."""
        factor = self.factor
        shared = min(max(self.products / self.pairs / factor**2, 0.0), 0.95)
        return factor, shared, self.outliers(usual)

    def with_errors(
        self,
        count: float,
        squares: float,
        pairs: float,
        products: float,
        seen: float,
        powers: float,
        *,
        t: float,
    ) -> "LearnedNoise":
        """What is known after more readings.

        Args:
            count: how many good ones there are.
            squares: sum of their squared errors.
            pairs: how many of them follow another one on their link.
            products: sum of the products of their errors.
            seen: how many readings there are.
            powers: how many of them are powers, not ranges.
            t: until when (s).
        """
        gone_s = 0.0 if self.t is None else max(t - self.t, 0.0)
        recent = math.exp(-gone_s / physics.POWER_NOISE_MEMORY_S) if powers else 0.0
        memory = physics.NOISE_MEMORY
        kept = max(recent, memory / (memory + count))
        kept_pairs, kept_seen = max(recent, memory / (memory + pairs)), max(recent, memory / (memory + seen))
        return LearnedNoise(
            kept * self.count + count,
            kept * self.squares + squares,
            kept_pairs * self.pairs + pairs,
            kept_pairs * self.products + products,
            kept_seen * self.seen + seen,
            kept_seen * self.odd + seen - count,
            t,
        )


@njit(cache=True)
def near_dbm(power_dbm: float, exponent: float) -> float:
    """The power expected at the edge of the near zone (dBm)."""
    return float(power_dbm - 10.0 * exponent * np.log10(physics.NEAR_M))


@njit(cache=True, error_model="numpy")
def single_sigma(white: float, common: float, alike: float) -> float:
    """Standard deviation to give to one reading of those that share an error.

    k readings of white variance w and common variance c are worth k / (w + k c) together: each gets what it
    adds to that.

    Args:
        white: w.
        common: c.
        alike: k, which number in its row of alike readings this one is.
    """
    before, now = white + (alike - 1.0) * common, white + alike * common
    return max(math.sqrt(before * now / white), physics.SIGMA_FLOOR_M)


@njit(cache=True, error_model="numpy")
def link_sigma(
    factor: float, shared: float, nominal: float, alike: float, scatter: float, doubt: float
) -> float:
    """The same by what has been learned of a technology.

    Args:
        factor: learned standard deviation of the technology over the claimed or assumed one.
        shared: share of the variance that is common.
        nominal: claimed or assumed standard deviation.
        alike: k, which number in its row of alike readings this one is.
        scatter: variance that walls add to each reading.
        doubt: variance that they add to all of the link.
    """
    total = (nominal * factor) ** 2
    common = shared * total
    return single_sigma(total - common + scatter, common + doubt, alike)


@njit(cache=True, error_model="numpy")
def through_sigma(sigma: float, power: bool, alike: float) -> float:
    """Standard deviation to give to a reading through a floor.

    What it takes of a signal's power the readings of a link share: the same 10 to 20 dB, however often one
    listens. A range is longer by half a metre, far less than what is allowed for.

    Args:
        sigma: that of the reading were there none (m or dB).
        power: a signal's power, not a range.
        alike: k, which number in its row of alike readings this one is.
    """
    if not power:
        return math.hypot(sigma, physics.FLOOR_SIGMA[0])
    return single_sigma(sigma * sigma, physics.FLOOR_SIGMA[1] ** 2, alike)
