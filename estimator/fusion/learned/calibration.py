"""What readings alone say of a calibration, and whether a ranging technology is calibrated.

Its scale is nearly nil, or else wide; so is what bearers' bodies do to its readings, and to powers. What the
readings alone say of it, d with variance v, is held against both kinds: p ∝ share · N(d; 0, v + σ²). The next
solution has the prior of one of them.
"""

import math

import msgspec

from estimator.fusion import physics
from estimator.fusion.learned.delays import delays, reported_as

NOTHING = 1e-6
"""Share of the information on a number below which readings have told nothing of it."""
UNTOLD = (0.0, 0.0)
Told = tuple[float, float]
"""What readings say of a number without its prior: information, and that times the number."""
TRUSTED = 0.25
"""Probability of not being calibrated below which a technology is taken for calibrated. One that is wrongly
trusted bends everything; one that is wrongly distrusted costs some sharpness."""
LOST = 0.5
"""The same where trust was lost, and what followed without it has given it back: what trust has bent says a
little more against it. By one limit for both, each solution would be followed by another one with the other
prior."""
SEEN = 0.9
"""Probability from which on bodies are taken to be seen; until then covariances hold that they may be."""


class Calibration(msgspec.Struct, frozen=True, array_like=True):
    """What is thought of a number of a technology: its scale, or what bodies do.

    Attributes:
        uncalibrated: probability that it is of the wide kind.
        narrow: standard deviation of its prior if it is calibrated, when that was judged last.
        assumed: that of the prior that it was estimated with; nil: none was yet.
        wide: that of the wide kind.
        regained: trust was lost, and given back by the solution without it.
    """

    uncalibrated: float = physics.UNCALIBRATED
    narrow: float = physics.RANGE_SCALE_SIGMA
    assumed: float = 0.0
    wide: float = physics.RANGE_SCALE_WIDE
    regained: bool = False

    @property
    def limit(self) -> float:
        """Probability below which it is taken to be calibrated."""
        return LOST if self.regained and self.assumed < self.wide else TRUSTED

    def judged(self, uncalibrated: float, narrow: float, assumed: float) -> "Calibration":
        """What is thought of a scale now; see the attributes."""
        without = 0.0 < self.assumed < self.wide <= assumed
        regained = self.regained or (without and uncalibrated < TRUSTED)
        return Calibration(uncalibrated, narrow, assumed, self.wide, regained)

    def scale_sigma(self, narrow: float) -> float:
        """Standard deviation of the prior of a scale, of the kind it is taken for.

        Args:
            narrow: that of a calibrated one.
        """
        return narrow if self.uncalibrated < self.limit else self.wide


def told_of(sigma: float, estimate: float, variance: float) -> Told:
    """Likelihood of a number: an estimate less its prior; `UNTOLD` where it adds no information.

    Args:
        sigma: standard deviation of the prior, of mean 0, that the estimate was made with.
        estimate: of the number.
        variance: of the estimate, the prior included.
    """
    if not variance > 0.0:
        return UNTOLD
    information = 1.0 / variance - 1.0 / sigma**2
    return UNTOLD if information * variance < NOTHING else (information, estimate / variance)


def narrow_sigma(outliers: float, scatter: float = math.inf) -> float:
    """Standard deviation of a calibrated technology's scale among walls.

    The farther a range, the more walls it crosses, and each makes it longer: where many are clearly too
    long, the others are so too, about in proportion to their length. What walls make a range longer by
    scatters as much (`smoothing.readings.obstructed`): where the others hardly scatter, they are in sight,
    and the many are echoes that say nothing of them.

    Args:
        outliers: share of its ranges that are clearly too long, 0 to 1.
        scatter: what the others scatter by, over their length; infinite where nobody knows.
    """
    return math.hypot(physics.RANGE_SCALE_SIGMA, min(physics.OBSTRUCTED_SCALE * outliers, scatter))


def body_sigmas(technology: str, powers: bool) -> tuple[float, float]:
    """Standard deviations of what bodies do to readings (m or dB), where they are not seen, else.

    Args:
        technology: of the readings.
        powers: they are powers, else ranges.
    """
    if powers:
        return physics.NO_BODY_DB, physics.BODY_DB
    return physics.NO_BODY_M, physics.BODY_M.get(reported_as(technology), physics.BODY_OTHER_M)


def bias_sigma_m(technology: str) -> float:
    """Standard deviation of the prior of a technology's bias (m)."""
    usual = physics.RANGE_BIAS_SIGMA_M.get(reported_as(technology), physics.RANGE_BIAS_OTHER_SIGMA_M)
    return math.hypot(usual, math.sqrt(delays(technology)) * physics.DELAY_SIGMA_M)


def uncalibrated(
    sigma: float,
    estimate: float,
    variance: float,
    narrow: float,
    wide: float = physics.RANGE_SCALE_WIDE,
    share: float = physics.UNCALIBRATED,
) -> float:
    """Probability that a technology is not calibrated.

    Args:
        sigma: standard deviation of the prior, of mean 0, that the estimate was made with.
        estimate: of its scale error.
        variance: of the estimate, the prior included.
        narrow: standard deviation of the scale of a calibrated technology.
        wide: that of one that is not.
        share: how many are not.
    """
    information, product = told_of(sigma, estimate, variance)
    if not information > 0.0:
        return share
    alone = 1.0 / information
    said = product * alone
    odds = _logarithm(said, alone + wide**2)
    odds -= _logarithm(said, alone + narrow**2)
    odds += math.log(share / (1.0 - share))
    return 1.0 / (1.0 + math.exp(min(max(-odds, -700.0), 700.0)))


def doubt(known: Calibration, estimate: float, variance: float) -> float:
    """What it adds to covariances that a technology may be of the other kind than is assumed.

    All places move with the scale, by Σ_xs / v. With the prior of the other kind it would be elsewhere, and
    less well known or better: the second moment about where it is shown holds both, as likely as they are.

    Args:
        known: what is thought of the scale.
        estimate: of the scale error.
        variance: v of it, the prior included.

    Returns:
        f of f Σ_xs Σ_sx, which is to be added to Σ.
    """
    if not known.assumed > 0.0:
        return 0.0
    wide = known.assumed >= known.wide
    share, sigma = (1.0 - known.uncalibrated, known.narrow) if wide else (known.uncalibrated, known.wide)
    information, product = told_of(known.assumed, estimate, variance)
    other = 1.0 / (information + sigma**-2)
    return share * ((other * product - estimate) ** 2 + max(other - variance, 0.0)) / variance**2


def _logarithm(value: float, variance: float) -> float:
    """Of the density of N(0, variance), up to a constant."""
    return -0.5 * (math.log(variance) + value**2 / variance)
