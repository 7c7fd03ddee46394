"""How somebody goes on of whom a moment is missing: as he went, with the doubt that he did not."""

import math
from collections.abc import Sequence
from itertools import pairwise

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.motion.recent_places import Mark
from estimator.fusion.motion.silence import gone_m2, went_on

RECENT_S = 2.0
"""A pace is that of the last strides: what is older counts ever less."""
SWINGS_MPS, SWINGS_M = 1.5, 0.4
"""A boot swings ahead of its bearer's pace by so much, and is off it by a third of a stride at most."""


def onward_m(trail: Sequence[Mark], span_s: float, since_s: float) -> Vector3:
    """How far somebody goes on at the pace of his trail, which is forgotten as in `silence.went_on` (m).

    Args:
        trail: epochs (s) and displacements summed up to them (m), at least one.
        span_s: for how long he is to go on (s).
        since_s: for how long his unit has told nothing before that (s).
    """
    last_t = trail[-1][0]
    e = n = u = total = 0.0
    for (t, *here), (next_t, *there) in pairwise(trail):
        if next_t <= t:
            continue
        # The integral of exp(−age / memory) over the time between two marks.
        weight = math.exp((next_t - last_t) / RECENT_S) - math.exp((t - last_t) / RECENT_S)
        more_e, more_n, more_u = (weight * (b - a) / (next_t - t) for a, b in zip(here, there, strict=True))
        e, n, u, total = e + more_e, n + more_n, u + more_u, total + weight
    if total <= 0.0:
        return 0.0, 0.0, 0.0
    share = (went_on(since_s + span_s)[0] - went_on(since_s)[0]) / total
    return share * e, share * n, share * u


def went_on_m2(span_s: float, told_s: float) -> float:
    """Variance along each axis of how far somebody goes on, of whom a report told the mean velocity (m²).

    What is told of some seconds as a sum tells little of how he went at their end: he may have turned a
    corner in between. He is taken to go on at that velocity as in `silence.went_on`; the variance about it is
    that of the same process, of which the mean over a time is known instead of its value.

    Args:
        span_s: for how long he goes on (s).
        told_s: for how long the report lasted (s).
    """
    speed_mps, memory_s = physics.SILENT_SPEED_MPS, physics.UNHEARD_MEMORY_S
    forgotten, before = -math.expm1(-span_s / memory_s), -math.expm1(-told_s / memory_s)
    share = went_on(span_s)[0] / told_s
    onward = gone_m2(speed_mps, memory_s, span_s, 0.0)
    told = gone_m2(speed_mps, memory_s, told_s, 0.0)
    return onward + share**2 * told - 2.0 * share * (speed_mps * memory_s) ** 2 * forgotten * before


def mark_after(last: Mark, t: float, delta_m: Vector3) -> Mark:
    """The mark of who has gone `delta_m` (m) since the last one, at `t` (s)."""
    _, e, n, u = last
    return t, e + delta_m[0], n + delta_m[1], u + delta_m[2]


def missed_m2(span_s: float, missed_s: float, raw: bool) -> float:
    """Variance along each axis of a way that nobody told, while no whole stride has been told (m²).

    What is missed of one walk has one direction: the variances of its gaps add up to that of one gap as long
    as all of them.

    Args:
        span_s: how long the gap lasts (s).
        missed_s: how long those before it have lasted, since a whole stride was told (s).
        raw: it is a boot that is followed, not a body.
    """
    swung_m = min(SWINGS_MPS * span_s, SWINGS_M) if raw else 0.0
    gone = gone_m2(physics.SILENT_SPEED_MPS, physics.UNHEARD_MEMORY_S, span_s, missed_s)
    return gone + swung_m**2
