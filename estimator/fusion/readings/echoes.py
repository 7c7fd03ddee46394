"""Ranges that an echo makes too long, told by a jump that nobody can have walked.

What stands between two radios hides the straight path: the next reading comes by a longer one, metres too
long at once, and so do those after it until the straight path is free again. Each by itself is an outlier
among others; a minute of them bends the way of who has no odometry until they fit. But nobody runs so far
between two readings. What follows a jump up is an echo until a jump down; a range far too short is a glitch,
or the echo came first: a lower level is believed when it stays.
"""

import math

import numpy as np
from numba import njit

from estimator.fusion import physics
from estimator.fusion.learned.link_correlation import ECHO_M, ECHO_ODDS, KEPT, LOWER_S, VALUE
from estimator.fusion.motion.recent_places import DECIDED, OUTSIDE, STATES
from estimator.graph.dense import Array

SIGMAS = 5.0 * math.sqrt(2.0)
"""Two readings that differ by more, in sigmas of one, do so by no noise."""
SURE, TOLD = 4.0, 0.5
"""In log odds: what a jump tells, and what each reading after it does, at most: their errors are alike."""
LEAST = 1e-9


@njit(cache=True, error_model="numpy")
def farthest_m(a: Array, b: Array, waited_s: float, sigma_m: float) -> float:
    """The farthest that a range may differ from the one before it on its link by motion and noise (m).

    Args:
        a: one end, see `recent_places.TrailEnd`.
        b: the other one.
        waited_s: time between the two.
        sigma_m: standard deviation of each.
    """
    speed = 0.0
    for end in (a, b):
        if end[STATES] >= 0.0 or end[DECIDED] == 0.0:
            speed += physics.FLIES_MPS if end[OUTSIDE] != 0.0 else physics.RUNS_MPS
    return SIGMAS * sigma_m + speed * abs(waited_s)


@njit(cache=True, error_model="numpy")
def hear(link: Array, waited_s: float, value_m: float, most_m: float) -> float:
    """Tell of the next range on a link what it is too long by.

    Args:
        link: the link's row, see `links`, that has followed it; changed.
        waited_s: time since the one before it.
        value_m: the range.
        most_m: see `farthest_m`.

    Returns:
        How much longer it is than it was before an echo began (m); 0: it is no echo.
    """
    jump, link[VALUE] = value_m - link[VALUE], value_m
    if not abs(waited_s) <= physics.ECHO_UNHEARD_S:
        link[ECHO_M] = link[LOWER_S] = 0.0
        return 0.0
    if abs(jump) > most_m:
        was, now = link[ECHO_M], link[ECHO_M] + jump
        # Who walks on meanwhile has made the way back longer or shorter than the way there.
        back = jump < 0.0 and now < 0.5 * was and now > -most_m
        link[ECHO_M], link[LOWER_S] = (0.0 if back or abs(now) <= most_m else now), 0.0
        if jump > 0.0:
            link[ECHO_ODDS] = SURE
    if link[ECHO_M] > 0.0:
        link[ECHO_ODDS] += math.log(link[KEPT])
        if link[ECHO_ODDS] < 0.0:
            link[ECHO_M] = 0.0
    elif link[ECHO_M] < 0.0:
        link[LOWER_S] += abs(waited_s)
        if link[LOWER_S] >= physics.ECHO_LOWER_S:
            link[ECHO_M] = 0.0
    return float(max(link[ECHO_M], 0.0))


@njit(cache=True, error_model="numpy")
def fit(link: Array, good: float) -> None:
    """Count for or against an echo how a reading of it has fitted: where it ended unheard, they fit again.

    Args:
        link: the link's row, changed.
        good: probability that the reading has the good noise.
    """
    good = min(max(good, LEAST), 1.0 - LEAST)
    told = math.log(good / (1.0 - good) * physics.ECHOES / (1.0 - physics.ECHOES))
    link[ECHO_ODDS] = min(link[ECHO_ODDS] - min(max(told, -TOLD), TOLD), SURE)
    if link[ECHO_ODDS] < 0.0 and link[ECHO_M] > 0.0:
        link[ECHO_M] = 0.0


@njit(cache=True, error_model="numpy")
def noise(echo_m: float, alike: float) -> tuple[float, float, float]:
    """Outliers, shift and spread of a reading that is an echo, see `robust.Mixture`.

    All readings of an echo are too long by the same: together they tell as much as one.

    Args:
        echo_m: what it is too long by.
        alike: which number in its row of alike readings it is.
    """
    return physics.ECHOES, echo_m, physics.RANGE_NOISE.spread * math.sqrt(alike)


@njit(cache=True)
def tell(noises: Array, echo_m: Array, alike: Array) -> None:
    """Give those of m readings that are echoes the noise of one.

    Args:
        noises: outliers, shift and spread of each, m × 3 or longer, changed.
        echo_m: what each is too long by, m; 0: it is no echo.
        alike: which number in its row of alike readings each is, m.
    """
    for i in np.flatnonzero(echo_m > 0.0):
        noises[i, 0], noises[i, 1], noises[i, 2] = noise(echo_m[i], alike[i])
