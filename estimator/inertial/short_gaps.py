"""The way over a short gap between samples, told by how a boot moves before and after it.

Between two known velocities and accelerations there is one polynomial of third degree; what it misses grows
with the cube of the time. After a quarter of a second a swing may have begun and ended: then nobody knows.
"""

import math

import numpy as np

from estimator.graph.dense import Array
from estimator.inertial.boot import GRAVITY, Boot
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.rotations import turned_about
from estimator.inertial.strapdown import ATTITUDE_WALK

CROSSED_S = 0.25
"""So long a gap is crossed."""
MISSED_MPS3 = 8.0
"""What a swing and the blow of a heel make of it: 6 cm in a fifth of a second (3 are seen)."""
VELOCITY_OFF_MPS = 0.1
"""How well a standstill that is yet to come, or has been, tells a velocity in a swing."""


def edge_of(t: float, boot: Boot, sample: Array) -> Array:
    """How a boot moves at one edge of a gap.

    Args:
        t: when that is (s).
        boot: its navigation there.
        sample: what it feels there, 6 (m/s², rad/s).

    Returns:
        The epoch (s), velocity (m/s), acceleration (m/s²) and the rate of its turn to the left (rad/s), 8.
    """
    attitude = boot.held.attitude
    ahead = attitude @ sample[:3] - (0.0, 0.0, boot.known[GRAVITY])
    turns = float(attitude[2] @ (sample[3:] - boot.held.sensors[6:]))
    return np.array([t, *boot.held.velocity, *ahead, turns])


def cross(boot: Boot, node: str, before: Array, after: Array) -> InertialDisplacement:
    """Lead a boot over a gap.

    Args:
        boot: its navigation after it, facing what it faced before; it is turned by what it turns meanwhile.
        node: whose it is.
        before: how it moved before the gap, see `edge_of`.
        after: the same after it.
    """
    gap_s = float(after[0] - before[0])
    turned_rad = 0.5 * gap_s * float(before[7] + after[7])
    spun = turned_about(np.array([0.0, 0.0, turned_rad]), np.eye(3))
    for each in (boot.held, boot.free):
        each.attitude[:] = spun @ each.attitude
        each.velocity[:] = spun @ each.velocity
    speed, ahead = spun @ after[1:4], spun @ after[4:7]
    # ∫ of the cubic of velocity that both edges tell (Hermite).
    way = 0.5 * gap_s * (before[1:4] + speed) + gap_s**2 / 12.0 * (before[4:7] - ahead)
    east, north, up = way.tolist()
    return InertialDisplacement(
        t=float(after[0]),
        node=node,
        delta_m=(east, north, up),
        from_t=float(before[0]),
        heading_rad=boot.heading_rad,
        sigma_m=math.hypot(MISSED_MPS3 * gap_s**3, VELOCITY_OFF_MPS * gap_s),
        turned_rad2=ATTITUDE_WALK**2 * gap_s,
    )
