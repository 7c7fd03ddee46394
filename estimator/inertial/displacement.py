"""What navigated samples tell: displacements that know how well they are known."""

import math

import numpy as np

from estimator.inertial.boot import (
    ATTITUDE,
    BIAS_RADPS,
    CHANGED,
    FLAT_M2,
    GRAVITY_MPS2,
    MOVED_M2,
    RESTED_S,
    TURNED_RAD2,
    VELOCITY,
    Boot,
)
from estimator.inertial.footholds import HIDDEN_M2PS2
from estimator.inertial.strapdown import ATTITUDE_WALK, FORCE_SIGMA_MPS2, SCALE_SIGMA
from estimator.inertial.zaru import TOLD_AFTER_S
from estimator.inertial.zupt import UNHELD_S
from estimator.measurements.displacement import Displacement

STRIDE_SIGMA_M_PER_ROOT_M = 0.02
"""Random error of a stride, more than the filter itself believes, which takes each standstill for perfect:
published errors of ZUPT-aided units are 0.3 to 1 % of ways of some ten strides, heights as much."""
SWINGS_S = 0.5
"""So long a velocity that a clipped peak has made wrong leads astray: the next standstill tells it."""
FELT_OFF_MPS2 = math.hypot(FORCE_SIGMA_MPS2, SCALE_SIGMA * GRAVITY_MPS2)
"""What its accelerometers may be off by, and no motion."""


class InertialDisplacement(Displacement, tag="led", frozen=True):
    """A displacement that samples have made: it counts with them.

    Attributes:
        up_m2: variance of its height beside `sigma_m`, as floors may not be flat (m²).
        turned_rad2: variance that its heading gains, beside what the bias does to it (rad²).
        bias_rad2ps2: variance that the bias of its heading takes: it has begun without a good rest, or a
            rest has told that it was another one ((rad/s)²).
        rested_radps: a rest has, some seconds ago: it is nil now but for so much (rad/s); nil: none has.
    """

    up_m2: float = 0.0
    turned_rad2: float = 0.0
    bias_rad2ps2: float = 0.0
    rested_radps: float = 0.0


def displacement_of(boot: Boot, node: str, from_t: float, t: float, unsure_m2: float) -> InertialDisplacement:
    """Where a boot's navigation has led since this was told last.

    Args:
        boot: its navigation; its place counts from where it was then.
        node: whose it is.
        from_t: when that was (s).
        t: now (s).
        unsure_m2: what its place is unsure by that the boot does not know of (m²).
    """
    held = boot.held
    east, north, up = held.place.tolist()
    velocities, span_s = range(VELOCITY, ATTITUDE), t - from_t
    hidden_m2 = float(boot.footholds[HIDDEN_M2PS2]) * min(span_s, SWINGS_S) ** 2
    speed_m2 = max(float(held.covariance[velocities, velocities].max()) * span_s**2, hidden_m2)
    way_m2 = STRIDE_SIGMA_M_PER_ROOT_M**2 * float(np.sqrt(np.dot(held.place, held.place)))
    moved_m2, lifted_m2 = boot.comparison[MOVED_M2 : MOVED_M2 + 2].tolist()
    # What it stands on may have moved: then it went so far at least, but for what its sensors feel at rest.
    felt_m2 = (FELT_OFF_MPS2 * UNHELD_S * (t - from_t)) ** 2
    moved_m2 = max(moved_m2, float(np.dot(boot.unheld[3:], boot.unheld[3:])) - felt_m2)
    return InertialDisplacement(
        t=t,
        node=node,
        delta_m=(east, north, up),
        from_t=from_t,
        heading_rad=boot.heading_rad,
        sigma_m=math.sqrt(way_m2 + speed_m2 + moved_m2 + unsure_m2) + 1e-6,
        up_m2=float(boot.footing[FLAT_M2]) + max(lifted_m2 - moved_m2, 0.0),
        turned_rad2=ATTITUDE_WALK**2 * (t - from_t) + float(boot.known[TURNED_RAD2]),
        bias_rad2ps2=float(boot.gyros[CHANGED]),
        rested_radps=float(boot.gyros[BIAS_RADPS]) if boot.gyros[RESTED_S] > TOLD_AFTER_S else 0.0,
    )
