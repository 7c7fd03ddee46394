"""When a boot stands, and how nearly: what each sample says of its speed, as a standard deviation.

Detectors as SHOE (Skog et al. 2010) hold a sum of forces and rates against a threshold, and each walk wants
its own. A boot that stands rolls over heel and ball: the unit on it moves with ω × r, r being the hand's
width to where it touches the ground. So what it rotates by says how it moves, and how fast it can be at most,
and nothing needs to be decided: a boot that hardly turns tells its velocity well, and one that swings tells
nothing.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array

LEVER_M = 0.1
"""From where the boot stands to the unit, which is above it: on the instep, or at the ankle."""
SHAKEN_S = 0.03
"""What is felt beside gravity changes direction several times in so long: times it, it is a speed."""
STEADY_MPS = 0.005
MOST_MPS = 0.2
"""What may be faster is no standstill."""
REMEMBERED_S = 0.02
"""A boot that swings has moments in which nothing is felt: it stands when it has felt little for so long."""
ALIKE_S = 0.025
"""Nearer to each other, standstills have the same error: they count once."""
QUIET_MPS2, QUIET_RADPS, CHANGED_S = 0.25, 0.3, 0.1
"""A boot that is lifted, dragged or swung feels more change than this in a tenth of a second, or turns."""
QUIET, LAST, JERKED = 8, 9, 12
"""Where each is among what is felt."""
BEFORE = np.array([0.0, 0.0, 0.0, 1e6, 1e6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
"""What a boot has felt before its first sample: anything."""


@njit(cache=True, error_model="numpy")
def add_sample(stance: Array, force: Array, rate: Array, gravity_mps2: float, step_s: float) -> None:
    """Take in a sample.

    Args:
        stance: mean force 3, squared rate, squared force beside gravity: of the last `REMEMBERED_S`, the
            squares no less than the sample's own; mean force of the last `CHANGED_S` 3; for how long it
            has been quiet (s); the last force 3, and its squared change to it: 13, changed in place.
        force: specific force, 3 (m/s²).
        rate: angular rate without its bias, 3 (rad/s).
        gravity_mps2: as the unit feels it.
        step_s: time from one sample to the next (s).
    """
    new, slow = 1.0 - np.exp(-step_s / REMEMBERED_S), 1.0 - np.exp(-step_s / CHANGED_S)
    squared = turning = beside = changed = 0.0
    for c in range(3):
        stance[c] += new * (force[c] - stance[c])
        stance[5 + c] += slow * (force[c] - stance[5 + c])
        changed += (stance[c] - stance[5 + c]) ** 2
        squared += stance[c] * stance[c]
        turning += rate[c] ** 2
    mean = np.sqrt(squared)
    scale = gravity_mps2 / max(mean, 1e-9)
    for c in range(3):
        beside += (force[c] - scale * stance[c]) ** 2
    # A unit that falls, or is dead, feels steadily what is no gravity.
    beside = max(beside, (mean - gravity_mps2) ** 2)
    stance[3] = max(turning, stance[3] + new * (turning - stance[3]))
    stance[4] = max(beside, stance[4] + new * (beside - stance[4]))
    quiet = changed < QUIET_MPS2**2 and stance[3] < QUIET_RADPS**2
    stance[QUIET] = stance[QUIET] + step_s if quiet else 0.0
    stance[JERKED] = 0.0
    for c in range(3):
        stance[JERKED] += (force[c] - stance[LAST + c]) ** 2
        stance[LAST + c] = force[c]


@njit(cache=True, error_model="numpy")
def rolling_mps(attitude: Array, rate: Array) -> Array:
    """Velocity of the unit on a boot that rolls over where it stands: ω × r, r pointing up, 3 (m/s).

    A boot rolls forward with each stride. Held against nil, each would be shorter by one or two per cent.

    Args:
        attitude: from the sensor's axes to those of a frame with z up, 3 × 3.
        rate: angular rate without its bias, in the sensor's axes, 3 (rad/s).
    """
    found = np.zeros(3)
    for c in range(3):
        found[0] += LEVER_M * attitude[1, c] * rate[c]
        found[1] -= LEVER_M * attitude[0, c] * rate[c]
    return found


@njit(cache=True, error_model="numpy")
def stance_sigma(stance: Array, since_s: float) -> float:
    """How far off that velocity may be along each axis (m/s); infinite where a boot does not stand.

    Args:
        stance: see `add_sample`.
        since_s: time since a standstill last counted (s).
    """
    sigma = np.sqrt(STEADY_MPS**2 + LEVER_M**2 * stance[3] + SHAKEN_S**2 * stance[4])
    return float(sigma) if since_s >= ALIKE_S and sigma < MOST_MPS else np.inf
