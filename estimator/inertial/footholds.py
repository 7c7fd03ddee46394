"""Where a boot's way is cut into displacements: where it stands under its bearer's body.

In a swing a boot is up to a quarter of a stride behind or ahead of the body, and so it is when it comes down
and when it leaves. In the middle of a stance the body passes over it: from there to there a boot has gone as
far as its bearer, and between two such places he is on a straight line between them.
"""

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.inertial.zero_velocity import ALIKE_S

OVER_S, OVER_LEAST_S = 0.3, 0.1
"""The body is over a boot half a stance after it has come down. A walker's stance is 60 % of a stride of 1.0
to 1.2 s (Perry, Gait Analysis), a runner's a quarter of a second: it is taken to be as long as his last one.
Whoever stands is over it from then on, until so long before he leaves."""
APART_S, LEAST_S = 0.5, 0.2
"""While a boot stands, it is told so often that it does; and nothing shorter is told."""
LATEST_S = 1.7
"""Whoever walks sets each boot down more often. Readings wait two seconds for a displacement
(`fusion.physics.PENDING_S`): before that a boot which swings, or never seems to stand, is told as well."""
AWAY_M = 0.3
"""How far it may then be from under the body along each axis: a quarter of a stride at most, of 1.3 m where
its bearer walks and of two and more where he runs."""
STRIDE_S = 0.15
"""What has not stood for longer has made a stride."""
FOOTHOLD = 4
"""So many standstills in a row are a foothold: a tenth of a second."""
NOW_S, BEGAN_S, LAST_S, COUNT, OVER, HIDDEN_M2PS2, WRITTEN, PRINTS = range(8)
"""What `footholds` holds: the time since its way was cut last; by that time, when its last stance began, and
when it was last seen to stand (s); how many standstills that stance has had; half of the stance before it
(s); what its velocity has been unsure by along an axis after clipped peaks, squared (m²/s²); how many places
have been written down, and the last ones of them: the time (s) and the place of each, 3 (m)."""
KEPT = 16
"""The places of `OVER_S`, and some more."""
NOT_YET = -1.0


def new_footholds() -> Array:
    """What is known of a boot that has not been seen to stand."""
    found = np.zeros(PRINTS + 4 * KEPT)
    found[OVER] = OVER_S
    return found


@njit(cache=True, error_model="numpy")
def note_standstill(footholds: Array, place: Array) -> None:
    """Write down that and where the boot stands now, 3 (m)."""
    now_s = footholds[NOW_S]
    if footholds[COUNT] == 0.0 or now_s - footholds[LAST_S] > STRIDE_S:
        if footholds[COUNT] >= FOOTHOLD:
            half_s = 0.5 * (footholds[LAST_S] - footholds[BEGAN_S])
            footholds[OVER] = min(max(half_s, OVER_LEAST_S), OVER_S)
        footholds[BEGAN_S], footholds[COUNT] = now_s, 0.0
    footholds[LAST_S] = now_s
    footholds[COUNT] += 1.0
    at = PRINTS + 4 * (int(footholds[WRITTEN]) % KEPT)
    footholds[at] = now_s
    footholds[at + 1 : at + 4] = place
    footholds[WRITTEN] += 1.0


@njit(cache=True, error_model="numpy")
def due_s(footholds: Array) -> float:
    """When the boot's way is to be cut, by the time since it was cut last (s); `NOT_YET`."""
    now_s, began_s, last_s = footholds[NOW_S], footholds[BEGAN_S], footholds[LAST_S]
    over_s = footholds[OVER]
    left = footholds[COUNT] == 0.0 or now_s - last_s > STRIDE_S
    if footholds[COUNT] >= FOOTHOLD:
        cut_s, apart_s = began_s + over_s, LEAST_S
        if left:
            cut_s = min(cut_s, 0.5 * (began_s + last_s))
        if cut_s < LEAST_S:
            # Its bearer stands on it: so he did `OVER_S` ago.
            cut_s, apart_s = last_s - OVER_S, LEAST_S if left else APART_S
        if apart_s <= cut_s <= last_s:
            return float(cut_s)
    return float(now_s) if now_s >= (LATEST_S if left else LATEST_S + OVER_S) else NOT_YET


@njit(cache=True, error_model="numpy")
def place_at(footholds: Array, t_s: float) -> Array:
    """Where it stood at a time since its way was cut last (s): the nearest that is written down, 3 (m)."""
    nearest, found = np.inf, np.zeros(3)
    for i in range(min(int(footholds[WRITTEN]), KEPT)):
        at = PRINTS + 4 * i
        if abs(footholds[at] - t_s) < nearest:
            nearest = abs(footholds[at] - t_s)
            found[:] = footholds[at + 1 : at + 4]
    return found


@njit(cache=True, error_model="numpy")
def move_prints(footholds: Array, by_m: Array) -> None:
    """Move all that is written down by 3 (m), in place."""
    for i in range(KEPT):
        footholds[PRINTS + 4 * i + 1 : PRINTS + 4 * i + 4] += by_m


def count_from(footholds: Array, t_s: float, place: Array) -> None:
    """Count times from `t_s` (s) and places from 3 (m) from now on, in place."""
    footholds[[NOW_S, BEGAN_S, LAST_S]] -= t_s
    footholds[HIDDEN_M2PS2] = 0.0
    footholds[PRINTS::4] -= t_s
    move_prints(footholds, -place)


def landed_share(footholds: Array) -> float:
    """How much of the time to where the boot's way is to be cut has passed, if it stands there; nil."""
    now_s, began_s = float(footholds[NOW_S]), float(footholds[BEGAN_S])
    landed = footholds[COUNT] > 0.0 and began_s > 0.0 and now_s - footholds[LAST_S] <= STRIDE_S
    return min(now_s / (began_s + float(footholds[OVER])), 1.0) if landed else 0.0


def gone_s(footholds: Array) -> float:
    """For how long who passes over the boot goes on from where it was cut last (s).

    Where it still stands when it should have left he has not gone on.
    """
    now_s, last_s, over_s = float(footholds[NOW_S]), float(footholds[LAST_S]), float(footholds[OVER])
    left = now_s - last_s > 2.0 * ALIKE_S
    return now_s if left else min(now_s, max(2.0 * over_s - now_s, 0.0))
