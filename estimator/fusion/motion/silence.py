"""How far the bearer of a unit may have gone while it reports nothing."""

import math

from numba import njit

from estimator.fusion import physics

LONGEST_S = 600.0
"""No more is added at once: nobody is followed over longer silences."""
LEAST_M2 = 1e-9
SILENT_S = 4.0
"""Who has reported nothing for as long is silent, and followed by ranges alone: less is a lost packet."""


@njit(cache=True)
def wandered_m2(span_s: float, since_s: float) -> float:
    """Variance that a way gains along each horizontal axis in a part of a silence (m²).

    The speed is forgotten with time. Nobody is anywhere at once: in a tenth of a second the way grows with
    the square of the time, and after a few seconds as that of a random walk (Ornstein and Uhlenbeck 1930).

    Args:
        span_s: how long the part lasts (s).
        since_s: how long the silence has lasted before it (s); infinite: nobody knows.
    """
    return gone_m2(physics.SILENT_SPEED_MPS, physics.SILENT_MEMORY_S, span_s, since_s)


@njit(cache=True)
def unheard_m2(span_s: float, since_s: float) -> float:
    """The same of somebody of whom nothing at all is heard in that part, at least (m²).

    Who searches a corridor keeps his way for longer than a second. What he is heard of each second shows it;
    where nothing shows it he may be that much farther.

    Args:
        span_s: how long he is not heard of (s).
        since_s: how long his unit has reported nothing before that (s); infinite: nobody knows.
    """
    kept = gone_m2(physics.SILENT_SPEED_MPS, physics.UNHEARD_MEMORY_S, span_s, 0.0)
    return max(wandered_m2(span_s, since_s), kept)


def unplaced_m2(span_s: float, since_s: float) -> float:
    """The same of somebody of whom powers alone are heard (m²).

    A power tells his place to several metres, and nothing of how he goes: he may keep his way as who is not
    heard of. Held to a random walk that forgets it within a second, he would fall behind, and good powers
    would be outliers of where he was thought to be (decision 0086).

    Args:
        span_s: how long the part lasts (s).
        since_s: how long his unit has reported nothing before it (s); infinite: nobody knows.
    """
    return gone_m2(physics.SILENT_SPEED_MPS, physics.UNHEARD_MEMORY_S, span_s, since_s)


@njit(cache=True)
def went_on(since_s: float) -> tuple[float, float]:
    """How far somebody whose unit has just told his velocity goes on, and the variance about that.

    He goes on as he went, which is forgotten as in `unheard_m2`: the same process, of which a beginning is
    known (Ornstein and Uhlenbeck 1930).

    Args:
        since_s: time since then (s).

    Returns:
        The time in which he would go as far at that velocity (s); the variance along each axis (m²).
    """
    speed_mps, memory_s = physics.SILENT_SPEED_MPS, physics.UNHEARD_MEMORY_S
    span = min(max(since_s, 0.0), LONGEST_S)
    forgotten = -math.expm1(-span / memory_s)
    variance = (speed_mps * memory_s) ** 2 * (2.0 * span / memory_s - 2.0 * forgotten - forgotten**2)
    return memory_s * forgotten, max(variance, LEAST_M2)


@njit(cache=True)
def gone_m2(speed_mps: float, memory_s: float, span_s: float, since_s: float) -> float:
    """The same of any usual speed along an axis, and any time in which it is forgotten (m²)."""
    span = min(max(span_s, 0.0), LONGEST_S)
    started = memory_s * math.exp(-since_s / memory_s) * -math.expm1(-span / memory_s)
    return max(2.0 * speed_mps**2 * memory_s * (span - started), LEAST_M2)
