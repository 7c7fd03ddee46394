"""A few missing samples are bridged by a straight line, with the doubt that it was none."""

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.boot import ATTITUDE, FORCE, GRAVITY_MPS2, VELOCITY, Boot
from estimator.inertial.levelling import ANYWHERE_RAD

BRIDGED_S = 0.03
"""So long a gap is bridged: a swing's samples lie on a straight line for so long."""
TURNING_S = 0.1
"""And what a boot turns about for so long."""
BRIDGED_OFF, FASTER_OFF = 0.3, 0.5
"""What a bridge may be off by, as a share of what goes on in it; and so much of its forces."""

TURNS_RADPS, TURNED_RAD, TURNED_RADPS = 3.0, 1.0, 0.1
"""While samples are missing their bearer may turn on his heel; then he mostly goes on; in the end he may face
anything, which is 1.8 rad."""


def bridge(boot: Boot, before: Array, after: Array, missing: int, off_s: float) -> tuple[Array, float, float]:
    """Samples in the place of missing ones.

    Args:
        boot: its doubts are added to, in place.
        before: the last sample before them, 6 (m/s², rad/s).
        after: the first one after them.
        missing: how many there are.
        off_s: how long they last (s).

    Returns:
        The samples, missing × 6; what they add to the variance of the place (m²), and of the heading (rad²).
    """
    shares = (np.arange(1, missing + 1) / (missing + 1.0))[:, None]
    found = before + shares * (after - before)
    velocity, turned_rad2 = boot.held.velocity, short_turn_rad2(found, off_s)
    lost_m2 = (BRIDGED_OFF * off_s) ** 2 * float(np.dot(velocity, velocity))
    ahead = found[:, :3] @ boot.free.attitude.T - (0.0, 0.0, GRAVITY_MPS2)
    faster_m2ps2 = (FASTER_OFF * off_s) ** 2 * float((ahead**2).sum(axis=1).max())
    for each in (boot.held, boot.free):
        each.covariance[range(ATTITUDE, FORCE), range(ATTITUDE, FORCE)] += turned_rad2
        each.covariance[range(VELOCITY, ATTITUDE), range(VELOCITY, ATTITUDE)] += faster_m2ps2
    return found, lost_m2, turned_rad2


def short_turn_rad2(samples: Array, off_s: float) -> float:
    """Variance of a heading by what a boot turns in a short gap, from the rates at both its ends (rad²).

    Args:
        samples: in the place of the missing ones, or beside them, k × 6 (m/s², rad/s).
        off_s: how long that lasts (s).
    """
    return (BRIDGED_OFF * off_s) ** 2 * float((samples[:, 3:] ** 2).sum(axis=1).max())


def long_turn_rad2(gone_s: float) -> float:
    """Variance of a heading by what its bearer may turn in a long gap of `gone_s` (s) (rad²)."""
    return min(TURNS_RADPS * gone_s, TURNED_RAD + TURNED_RADPS * gone_s, ANYWHERE_RAD) ** 2
