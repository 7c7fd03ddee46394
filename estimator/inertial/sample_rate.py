"""How fast a unit's clock runs: its samples may come faster or slower than its readings say.

A small unit takes samples by an oscillator of its own, and a gateway tells a rated frequency or a rounded
one. What the epochs of readings say against the counts of their samples tells the true one. Epochs jitter,
though, and samples get lost, which looks the same once: a reading that comes 40 ms late has waited, or
follows 40 ms that are missing, or the clock is slow by so much. So several paces are followed side by side,
each by a Kalman filter of epoch and pace of its own, and weighed by what they have foretold (a Gaussian sum
filter; Sorenson and Alspach 1971).
"""

from typing import NamedTuple, Self

import numpy as np
from numba import njit

from estimator.graph.dense import Array

WEIGHT, EPOCH, PACE, VARIANCE, SHARED, PACE_VARIANCE, JITTER, FREEDOM = range(8)
"""What is known by each of the paces, the told one first: its log weight; when the next sample begins (s);
the pace, less one; the variance of the epoch (s²), the covariance of both (s), the variance of the pace; the
variance of the jitter of epochs (s²), and how many epochs have told it."""
WRONG = 0.2
"""How many units are told with another frequency than theirs."""
SPREAD, WIDEST, APART = 0.04, 0.12, 0.01
"""By so much it is wrong: oscillators of small units are off by 1 to 5 %, and by 10 at most (data sheets of
MPU-6050, BMI160; the LSM6DSO corrects for up to 19 % in its `INTERNAL_FREQ_FINE`). Paces are followed so far
apart."""
REFUTED = 0.01
"""What is told is used until it is less likely: a late epoch alone is a gap as well."""
RIGHT = 1e-3
"""A frequency that has been measured, or is rounded to three digits, is off by so much."""
WARMS = 5e-5
"""What a pace wanders by, per root second: 0.02 % a kelvin, where a unit warms by 2 K a minute."""
JITTER_S, TOLD_BY, TOLD_MOST = 0.002, 3.0, 30.0
"""What epochs jitter by before they have told, so many of them that is worth, and how many count at most."""
ANEW, ANEW_S = 0.05, 1.0
"""How often samples are missing before a reading, or a gateway sets its clock, and by about how much."""
FORGOTTEN = -30.0
"""No pace is ruled out for good: a unit may change its own (log weight)."""
EARLY_S = 0.05
"""What comes earlier than any pace would have it, by so much more, overlaps what came before."""
SAID, SAID_SIGMA, SAID_AFTER_S = 0.01, 0.003, 10.0
"""A clock is said to be wrong by more than this, known so well and for so long."""
OTHER = 0.01
"""A frequency that is told otherwise by more is another one."""


class Clock(NamedTuple):
    """What is known of a unit's clock.

    Attributes:
        rate_hz: samples a second, as its readings say.
        counted: how many samples have come since an epoch last told something.
        learned_s: for how long epochs have told (s).
        pace: the time from one sample to the next that is to be used, over the one told.
        sigma: standard deviation of what that is off by.
        paces: what is known by each pace that is followed, k × 8.
    """

    rate_hz: float
    counted: int
    learned_s: float
    pace: float
    sigma: float
    paces: Array

    @classmethod
    def new(cls, rate_hz: float) -> Self:
        """One of which nothing is known but what is told."""
        wide = APART * np.arange(-round(WIDEST / APART), round(WIDEST / APART) + 1)
        likely = np.exp(-0.5 * (wide / SPREAD) ** 2)
        paces = np.zeros((1 + len(wide), FREEDOM + 1))
        paces[:, WEIGHT] = np.log([1.0 - WRONG, *(WRONG * likely / likely.sum())])
        paces[1:, PACE] = wide
        paces[:, PACE_VARIANCE] = [RIGHT**2, *(0.5 * APART) ** 2 * np.ones(len(wide))]
        paces[:, EPOCH], paces[:, JITTER], paces[:, FREEDOM] = np.nan, JITTER_S**2, TOLD_BY
        return cls(rate_hz, 0, 0.0, *_mix(paces), paces)

    @property
    def remark(self) -> str | None:
        """What is to be said of it, where it is certainly wrong."""
        if abs(self.pace - 1.0) < SAID or self.sigma > SAID_SIGMA or self.learned_s < SAID_AFTER_S:
            return None
        return (
            f"its unit takes {self.rate_hz / self.pace:.4g} samples a second, not {self.rate_hz:.4g} as its"
            " readings say (`rate_hz`): their epochs tell. That is allowed for; put it right at the gateway"
        )


def add_epoch(clock: Clock, t: float, rate_hz: float, overlaps: bool) -> Clock:
    """Update what is known of a clock by the epoch of a reading.

    Args:
        clock: what is known before it.
        t: epoch of its first sample, Unix seconds.
        rate_hz: samples a second, as it says.
        overlaps: samples of before come again in it: its first one does not follow them.
    """
    if abs(rate_hz / clock.rate_hz - 1.0) > OTHER:
        clock = Clock.new(rate_hz)
    span_s = clock.counted / clock.rate_hz
    first = bool(np.isnan(clock.paces[0, EPOCH]))
    early_s = 0.0 if first else _expected_t(clock) + span_s * clock.pace - t
    if early_s > WIDEST * span_s + EARLY_S or (overlaps and early_s > 0.0):
        return clock
    paces = clock.paces.copy()
    if first:
        paces[:, EPOCH], paces[:, VARIANCE] = t, JITTER_S**2
    else:
        _update_paces(paces, t, span_s)
    return Clock(clock.rate_hz, 0, clock.learned_s + span_s, *_mix(paces), paces)


def _expected_t(clock: Clock) -> float:
    """Epoch at which the first of the counted samples began, the weighted mean of all paces (s)."""
    shares = np.exp(clock.paces[:, WEIGHT])
    since_t = clock.paces[0, EPOCH]
    return float(since_t + shares @ (clock.paces[:, EPOCH] - since_t))


@njit(cache=True, error_model="numpy")
def _mix(paces: Array) -> tuple[float, float]:
    """Normalise the weights, in place. Returns the pace to be used and its standard deviation."""
    most, total = paces[:, WEIGHT].max(), 0.0
    for k in range(len(paces)):
        total += np.exp(paces[k, WEIGHT] - most)
    mean = square = 0.0
    for k in range(len(paces)):
        paces[k, WEIGHT] = max(paces[k, WEIGHT] - most - np.log(total), FORGOTTEN)
        share = np.exp(paces[k, WEIGHT])
        mean += share * paces[k, PACE]
        square += share * (paces[k, PACE] ** 2 + paces[k, PACE_VARIANCE])
    if np.exp(paces[0, WEIGHT]) > REFUTED:
        mean = 0.0
    # E (p − m)² = E p² − 2 m E p + m², where m is nil or E p.
    return 1.0 + mean, np.sqrt(max(square - mean * mean, 0.0))


@njit(cache=True, error_model="numpy")
def _update_paces(paces: Array, t: float, span_s: float) -> None:
    """Kalman update of each hypothesis of the pace by an epoch `t`, `span_s` of samples after the last."""
    for k in range(len(paces)):
        one = paces[k]
        one[EPOCH] += span_s * (1.0 + one[PACE])
        one[VARIANCE] += span_s * (2.0 * one[SHARED] + span_s * one[PACE_VARIANCE])
        one[SHARED] += span_s * one[PACE_VARIANCE]
        one[PACE_VARIANCE] += WARMS**2 * span_s
        late_s, variance, freedom = t - one[EPOCH], one[VARIANCE] + one[JITTER], one[FREEDOM]
        squared = late_s * late_s / variance
        # The jitter is known by few epochs: Student's t, but for its constant, which is much the same.
        follows = (1.0 + squared / freedom) ** (-0.5 * (freedom + 1.0)) / np.sqrt(2.0 * np.pi * variance)
        anew = ANEW * np.exp(-abs(late_s) / ANEW_S) / ANEW_S
        one[WEIGHT] += np.log(follows + anew + 1e-300)
        if anew > follows:
            one[EPOCH], one[VARIANCE], one[SHARED] = t, one[JITTER], 0.0
            continue
        gain, turn = one[VARIANCE] / variance, one[SHARED] / variance
        one[EPOCH] += gain * late_s
        one[PACE] += turn * late_s
        one[PACE_VARIANCE] -= turn * one[SHARED]
        one[SHARED] *= 1.0 - gain
        one[VARIANCE] *= 1.0 - gain
        one[JITTER] *= (freedom + squared) / (freedom + 1.0)
        one[FREEDOM] = min(freedom + 1.0, TOLD_MOST)
