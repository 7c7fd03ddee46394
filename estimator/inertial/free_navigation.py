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
    BLOWN_M2PS4,
    BRANCHED_M,
    ERRORS,
    FORCE,
    GLID_M,
    GLIDES_MPS,
    MOVED_M2,
    REJECTED_MPS,
    RESTLESS_S,
    SINCE_S,
    STOOD,
    STRIDES,
    VELOCITY,
    Boot,
    Strapdown,
)
from estimator.inertial.footholds import move_prints
from estimator.inertial.rotations import azimuth_rad, turned_about
from estimator.inertial.strapdown import remove_errors, zero_velocity_update
from estimator.inertial.zero_velocity import ALIKE_S, QUIET
from estimator.inertial.zupt import DOUBTED, hold_level, note_heading

QUIET_S, AGAIN_S = 0.2, 0.3
"""What is quiet for so long may rest; nearer to each other, rests have the same error: they count once."""
RESTS_S = 0.5
"""What is quiet for so long after a blow rests."""
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
RIDE_S = 2.0
"""What has been apart for less is no speed that goes on."""
BACK = 0.3
"""Who was known to move rests when his speed has gone back to so much of it: whoever knows ever less would
believe anything in the end."""
BLOW_MPS2 = 10.0
"""A force that changes by so much from one sample to the next has done more between them."""
BELIEVED_OFF = 0.1
"""What is off of a way that is believed, as a share."""
CARRIED_MPS = 10.0
"""Nobody is carried faster: his unit measures something else."""
LOST_MPS = 1.0
"""Accelerometers tell nothing any more of a boot whose velocity they know no better."""


@njit(cache=True, error_model="numpy")
def hold_or_release(boot: Boot, sigma_mps: float) -> None:
    """Hold the free navigation where the boot rests, and decide between the two.

    Args:
        boot: changed in place; it seems to stand.
        sigma_mps: how fast it may be (m/s).
    """
    free, comparison, quiet_s = boot.free, boot.comparison, boot.stance[QUIET]
    strides = boot.footing[STOOD] == 1.0
    comparison[STRIDES] += 1.0 if strides else 0.0
    comparison[RESTLESS_S] = 0.0 if strides or quiet_s > QUIET_S else comparison[RESTLESS_S] + ALIKE_S
    speeds_m2 = np.diag(free.covariance)[VELOCITY:ATTITUDE]
    if speeds_m2.max() > LOST_MPS**2:
        _restart_free(boot)
    elif quiet_s > QUIET_S and comparison[SINCE_S] > AGAIN_S:
        _try_rest(boot, np.sqrt(sigma_mps**2 + BEGUN_MPS**2))


@njit(cache=True, error_model="numpy")
def _try_rest(boot: Boot, sigma_mps: float) -> None:
    """Hold the free navigation at velocity 0 if that is plausible: within `RESTING`, and slower than before.

    Where it then contradicts the held navigation, the boot was moved and the free one is adopted.
    """
    free, comparison = boot.free, boot.comparison
    speed_mps = np.sqrt(np.dot(free.velocity, free.velocity))
    back = comparison[REJECTED_MPS] == 0.0 or speed_mps < BACK * comparison[REJECTED_MPS]
    if back and _mahalanobis2(free, VELOCITY, free.velocity, sigma_mps) < RESTING:
        error = np.zeros(ERRORS)
        zero_velocity_update(free, error, np.zeros(3), sigma_mps)
        remove_errors(free, error)
        apart = separation_m(boot)
        if contradicts(boot) and np.dot(apart, apart) < (CARRIED_MPS * comparison[SINCE_S]) ** 2:
            _adopt_free(boot)
        if boot.stance[QUIET] < comparison[SINCE_S]:
            # Who was given up while all was quiet rides on until something happens.
            comparison[GLIDES_MPS : GLID_M + 2] = 0.0
        start_free(boot)
        return
    comparison[REJECTED_MPS] = max(comparison[REJECTED_MPS], speed_mps)
    if boot.stance[QUIET] > RESTS_S and comparison[BLOWN_M2PS4] >= BLOW_MPS2**2:
        # Its accelerometers could not follow: what they made of a blow is no ride.
        _restart_free(boot)
        comparison[GLIDES_MPS : GLID_M + 2] = 0.0


@njit(cache=True, error_model="numpy")
def _mahalanobis2(boot: Strapdown, state: int, value: Array, sigma: float) -> float:
    """Squared Mahalanobis distance of errors `value`, the states from `state` on: vᵀ (P + σ² I)⁻¹ v."""
    size = len(value)
    spread = boot.covariance[state : state + size, state : state + size].copy()
    left, found = value.copy(), 0.0
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
def separation_m(boot: Boot) -> Array:
    """From where the held navigation is to where the free one is, 3 (m)."""
    return boot.comparison[BRANCHED_M : BRANCHED_M + 3] + boot.free.place - boot.held.place


@njit(cache=True, error_model="numpy")
def contradicts(boot: Boot) -> bool:
    """Whether the free navigation is too far from the held one for what sensors may be off by.

    Only where the boot has seemed to stand all the time: strides both follow in their own ways.
    """
    stood = boot.comparison[STRIDES] == 0.0
    return bool(stood and _mahalanobis2(boot.free, 0, separation_m(boot), APART_SIGMA_M) > MOVED)


@njit(cache=True, error_model="numpy")
def _adopt_free(boot: Boot) -> None:
    """Put the free navigation in the place of the held one: the boot was moved while it seemed to stand."""
    held, free, comparison = boot.held, boot.free, boot.comparison
    apart = separation_m(boot)
    held.place[:] += apart
    move_prints(boot.footholds, apart)
    across = max(free.covariance[0, 0], free.covariance[1, 1])
    comparison[MOVED_M2] += across + BELIEVED_OFF**2 * (apart[0] ** 2 + apart[1] ** 2)
    comparison[MOVED_M2 + 1] += free.covariance[2, 2] + BELIEVED_OFF**2 * apart[2] ** 2
    held.velocity[:] = free.velocity
    held.attitude[:] = free.attitude
    held.covariance[:FORCE, :FORCE] = free.covariance[:FORCE, :FORCE]
    hold_level(boot)
    note_heading(boot)


@njit(cache=True, error_model="numpy")
def start_free(boot: Boot) -> None:
    """Start the free navigation at the held one's place and heading; attitude and sensors stay its own."""
    held, free, comparison = boot.held, boot.free, boot.comparison
    comparison[BRANCHED_M : BRANCHED_M + 3] = held.place
    comparison[APART_M : APART_M + 2] = 0.0
    comparison[SINCE_S] = comparison[STRIDES] = comparison[REJECTED_MPS] = comparison[BLOWN_M2PS4] = 0.0
    axis = int(boot.known[AXIS])
    turned_rad = azimuth_rad(held.attitude, axis) - azimuth_rad(free.attitude, axis)
    free.attitude[:] = turned_about(np.array([0.0, 0.0, turned_rad]), free.attitude)
    free.place[:] = 0.0
    free.covariance[:3, :] = 0.0
    free.covariance[:, :3] = 0.0
    for c in range(VELOCITY, ATTITUDE):
        free.covariance[c, c] += BEGUN_MPS**2


@njit(cache=True, error_model="numpy")
def _restart_free(boot: Boot) -> None:
    """Restart a free navigation that knows too little, with the held velocity; what is open may go on."""
    held, free, comparison = boot.held, boot.free, boot.comparison
    far_m = np.sqrt(comparison[APART_M] ** 2 + comparison[APART_M + 1] ** 2)
    speed_mps = max(comparison[REJECTED_MPS], far_m / max(comparison[SINCE_S], RIDE_S))
    for c in range(2):
        if comparison[STRIDES] > 0.0:
            comparison[GLIDES_MPS + c] = comparison[GLID_M + c] = 0.0
        elif comparison[SINCE_S] > RIDE_S and far_m > 0.0:
            glides_mps = speed_mps * comparison[APART_M + c] / far_m
            comparison[GLIDES_MPS + c] = max(comparison[GLIDES_MPS + c], glides_mps)
    # What gyros and rests have told of its attitude and its sensors stays as good as it is.
    free.velocity[:] = held.velocity
    free.covariance[VELOCITY:ATTITUDE, :] = 0.0
    free.covariance[:, VELOCITY:ATTITUDE] = 0.0
    for c in range(VELOCITY, ATTITUDE):
        free.covariance[c, c] = DOUBTED**2 * held.covariance[c, c]
    start_free(boot)


@njit(cache=True, error_model="numpy")
def add_doubt(boot: Boot, since_s: float) -> None:
    """Add to the place's variance what an undecided or unobservable motion may have moved the boot by.

    Args:
        boot: changed in place.
        since_s: time since this was done last (s).
    """
    comparison, contradicted, apart = boot.comparison, contradicts(boot), separation_m(boot)
    for c in range(2):
        far_m = np.sqrt(apart[0] ** 2 + apart[1] ** 2) if c == 0 else abs(apart[2])
        if contradicted:
            comparison[MOVED_M2 + c] += max(far_m**2 - comparison[APART_M + c] ** 2, 0.0)
            comparison[APART_M + c] = max(comparison[APART_M + c], far_m)
        dragged_mps = DRAGGED_MPS if c == 0 and comparison[RESTLESS_S] > DRAGGED_S else 0.0
        more_m = max(comparison[GLIDES_MPS + c], dragged_mps) * since_s
        comparison[MOVED_M2 + c] += more_m * (more_m + 2.0 * comparison[GLID_M + c])
        comparison[GLID_M + c] += more_m
