"""Whether a boot moves though it seems to stand: it is dragged by who crawls, or what it stands on moves.

Beside the navigation that any standstill holds goes another one from where the boot last rested, held by
nothing but the next rest. Where the two end too far apart for what accelerometers and gyros may be off by,
the boot has been moved, and so far. While that is open it is told as doubt.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.boot import (
    APART_M,
    ATTITUDE,
    AXIS,
    BIAS_RADPS,
    BRANCHED_M,
    ERRORS,
    FORCE,
    GLID_M,
    GLIDES_MPS,
    GRAVITY_MPS2,
    MOVED_M2,
    RESTLESS_S,
    SINCE_S,
    STOOD,
    VELOCITY,
    Boot,
    Strapdown,
)
from estimator.inertial.holding import face, level_off
from estimator.inertial.levelling import LEVEL_SIGMA_RAD, doubt
from estimator.inertial.rotations import turned_about
from estimator.inertial.stance import ALIKE_S, QUIET
from estimator.inertial.strapdown import mend, stand_still

QUIET_S, AGAIN_S = 0.2, 0.3
"""What is quiet for so long may rest; nearer to each other, rests have the same error: they count once."""
RESTS_S = 1.0
"""What is quiet for so long rests, or is in a lift."""
BEGUN_MPS = 0.02
"""What seems to rest may just have begun to move, or not have ended to."""
RESTING = 14.2
"""Squared standard deviations: what rests is farther from it once in 400 times (χ² of three)."""
MOVED = 11.3
"""What has not been moved seems to have been once in a hundred times (χ² of three)."""
APART_SIGMA_M = 0.02
"""What both navigations may be apart by for reasons that neither knows of."""
DRAGGED_S, DRAGGED_MPS = 1.0, 0.1
"""Who seems to stand for longer and never rests may crawl, of which that much may be missed."""
STRIDE_S = 2.0
"""What has been apart for less may be one stride, which both have followed differently."""
DOUBTED = 3.0
"""Held by what seems to be a standstill each time, a navigation believes more of itself than is true."""
TILTED_S = 1.0
"""From one stride to the next standstills hold a tilt: so long a bias of gyros turns it."""
CARRIED_MPS = 10.0
"""Nobody is carried faster: his unit measures something else."""
LOST_MPS = 1.0
"""Accelerometers tell nothing any more of a boot whose velocity they know no better."""


@njit(cache=True, error_model="numpy")
def loosen(boot: Boot, sigma_mps: float) -> None:
    """Hold the free navigation where the boot rests, and decide between the two.

    Args:
        boot: changed in place; it seems to stand.
        sigma_mps: how fast it may be (m/s).
    """
    free, loose, quiet_s = boot.free, boot.loose, boot.felt[QUIET]
    restless = quiet_s < QUIET_S and boot.footing[STOOD] > 1.0
    loose[RESTLESS_S] = loose[RESTLESS_S] + ALIKE_S if restless else 0.0
    if quiet_s < QUIET_S or loose[SINCE_S] < AGAIN_S:
        speeds_m2 = np.diag(free.covariance)[VELOCITY:ATTITUDE]
        if speeds_m2.max() > LOST_MPS**2:
            _lose(boot)
        return
    rests_mps = np.sqrt(sigma_mps**2 + BEGUN_MPS**2)
    if _squared(free, VELOCITY, free.velocity, rests_mps) < RESTING:
        error = np.zeros(ERRORS)
        stand_still(free, error, rests_mps)
        mend(free, error)
        if contradicts(boot):
            _believe(boot)
        branch(boot)
        loose[GLIDES_MPS : GLID_M + 2] = 0.0
    elif quiet_s > RESTS_S and not _squared(free, VELOCITY, free.velocity[:2], rests_mps) < RESTING:
        # A blow that its accelerometers could not follow.
        _lose(boot)
        loose[GLIDES_MPS : GLID_M + 2] = 0.0


@njit(cache=True, error_model="numpy")
def _squared(boot: Strapdown, state: int, value: Array, sigma: float) -> float:
    """How unlikely errors of `value`, from `state` on, are by their covariance: vᵀ (P + σ² I)⁻¹ v."""
    size = len(value)
    spread, left, found = (
        boot.covariance[state : state + size, state : state + size].copy(),
        value.copy(),
        0.0,
    )
    for c in range(size):
        spread[c, c] += sigma * sigma
    for c in range(size):
        found += left[c] * left[c] / spread[c, c]
        for r in range(c + 1, size):
            share = spread[r, c] / spread[c, c]
            left[r] -= share * left[c]
            for k in range(c + 1, size):
                spread[r, k] -= share * spread[c, k]
    return float(found)


@njit(cache=True, error_model="numpy")
def apart_m(boot: Boot) -> Array:
    """From where the held navigation is to where the free one is, 3 (m)."""
    return boot.loose[BRANCHED_M : BRANCHED_M + 3] + boot.free.place - boot.held.place


@njit(cache=True, error_model="numpy")
def contradicts(boot: Boot) -> bool:
    """Whether the free navigation is too far from the held one for what sensors may be off by."""
    apart = apart_m(boot)
    carried = np.dot(apart, apart) < (CARRIED_MPS * boot.loose[SINCE_S]) ** 2
    return bool(carried and _squared(boot.free, 0, apart, APART_SIGMA_M) > MOVED)


@njit(cache=True, error_model="numpy")
def _believe(boot: Boot) -> None:
    """It has been moved while it seemed to stand, and now it rests: what the free navigation tells is so."""
    held, free, loose = boot.held, boot.free, boot.loose
    for c in range(3):
        held.place[c] = loose[BRANCHED_M + c] + free.place[c]
    loose[MOVED_M2] += max(free.covariance[0, 0], free.covariance[1, 1])
    loose[MOVED_M2 + 1] += free.covariance[2, 2]
    held.velocity[:] = free.velocity
    held.attitude[:] = free.attitude
    held.covariance[:FORCE, :FORCE] = free.covariance[:FORCE, :FORCE]
    level_off(boot)
    face(boot)


@njit(cache=True, error_model="numpy")
def branch(boot: Boot) -> None:
    """The free navigation goes on from where the held one is, and faces what that faces."""
    held, free, loose = boot.held, boot.free, boot.loose
    loose[BRANCHED_M : BRANCHED_M + 3] = held.place
    loose[APART_M : APART_M + 2] = 0.0
    loose[SINCE_S] = 0.0
    axis = int(boot.known[AXIS])
    there = np.arctan2(held.attitude[1, axis], held.attitude[0, axis])
    here = np.arctan2(free.attitude[1, axis], free.attitude[0, axis])
    free.attitude[:] = turned_about(np.array([0.0, 0.0, there - here]), free.attitude)
    free.place[:] = 0.0
    free.covariance[:3, :] = 0.0
    free.covariance[:, :3] = 0.0
    for c in range(VELOCITY, ATTITUDE):
        free.covariance[c, c] += BEGUN_MPS**2


@njit(cache=True, error_model="numpy")
def _lose(boot: Boot) -> None:
    """Give up the free navigation: it begins anew with what the held one knows."""
    held, free, loose = boot.held, boot.free, boot.loose
    for c in range(2):
        if loose[SINCE_S] > STRIDE_S:
            speed_mps = loose[APART_M + c] / loose[SINCE_S]
            loose[GLIDES_MPS + c] = max(loose[GLIDES_MPS + c], speed_mps)
    free.velocity[:] = held.velocity
    free.attitude[:] = held.attitude
    free.sensors[:6], free.sensors[6:] = 0.0, held.sensors[6:]
    tilt_rad = LEVEL_SIGMA_RAD[0] + boot.gyros[BIAS_RADPS] * TILTED_S
    doubt(free, held.attitude[2] * GRAVITY_MPS2, 0.0, tilt_rad, boot.gyros[BIAS_RADPS])
    known = held.covariance[VELOCITY:FORCE, VELOCITY:FORCE]
    free.covariance[VELOCITY:FORCE, VELOCITY:FORCE] += DOUBTED**2 * known
    branch(boot)


@njit(cache=True, error_model="numpy")
def tell(boot: Boot, since_s: float) -> None:
    """Add to the doubt of its place by how far it may have been moved, as is not known yet, or never will be.

    Args:
        boot: changed in place.
        since_s: time since this was done last (s).
    """
    loose, contradicted, apart = boot.loose, contradicts(boot), apart_m(boot)
    for c in range(2):
        far_m = np.sqrt(apart[0] ** 2 + apart[1] ** 2) if c == 0 else abs(apart[2])
        if contradicted:
            loose[MOVED_M2 + c] += max(far_m**2 - loose[APART_M + c] ** 2, 0.0)
            loose[APART_M + c] = max(loose[APART_M + c], far_m)
        dragged_mps = DRAGGED_MPS if c == 0 and loose[RESTLESS_S] > DRAGGED_S else 0.0
        more_m = max(loose[GLIDES_MPS + c], dragged_mps) * since_s
        loose[MOVED_M2 + c] += more_m * (more_m + 2.0 * loose[GLID_M + c])
        loose[GLID_M + c] += more_m
