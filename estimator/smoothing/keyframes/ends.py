"""Where the ends of readings are, for any estimate: keyframes with what was walked since, or what stands."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.walks import rotate_displacement

FIXED, STANDING, UNIT, FREE, UNPLACED = range(5)
"""What the node of an end is in a window."""


class Table(NamedTuple):
    """m ends of readings as numbers.

    Attributes:
        kind: what node each is of, m.
        at: where its numbers are in the flat unknowns, m × 6; 0 where there is none.
        fixed_m: where it is, if it is fixed, m × 3 (m).
        delta_m: displacement since its keyframe, in the unit's frame, m × 3 (m).
        moment: its first moment, m × 3 (m s).
        duration_s: time since its keyframe, m (s).
    """

    kind: Integers
    at: Integers
    fixed_m: Array
    delta_m: Array
    moment: Array
    duration_s: Array


class Places(NamedTuple):
    """Where m ends are.

    Attributes:
        place: positions, m × 3 (m); their derivatives by the first three columns are 1, if there are any.
        turned: derivatives by the last three columns, m × 3 × 3.
    """

    place: Array
    turned: Array


@njit(cache=True)
def faced(x: Array, headings: Integers) -> Array:
    """An estimate's numbers, and of its headings the cosines and sines, × 3; of other numbers there are none.

    Many readings are made soon after the same keyframe: each angle is asked once.

    Args:
        x: the estimate, flat.
        headings: which of its numbers are headings that ends of readings count from.
    """
    found = np.empty((len(x), 3))
    for i in range(len(x)):
        found[i, 0] = x[i]
    for heading in headings:
        found[heading, 1], found[heading, 2] = np.cos(x[heading]), np.sin(x[heading])
    return found


@njit(cache=True, forceinline=True)
def place_end(ends: Table, i: int, x: Array, place: Array, turned: Array) -> None:
    """Where one end is at an estimate.

    Put where it is called: a call would count each of its arrays, which takes longer than all of the rest.

    Args:
        ends: the table that it is in.
        i: its row.
        x: the estimate, see `faced`.
        place: takes its position, 3 (m).
        turned: takes the derivatives by the last three columns, 3 × 3; zeros before.
    """
    kind, at = ends.kind[i], ends.at[i]
    for c in range(3):
        place[c] = x[at[c], 0] if kind in (STANDING, UNIT, FREE) else ends.fixed_m[i, c]
    if kind == UNIT:
        cosine, sine, bias, scale = x[at[3], 1], x[at[3], 2], x[at[4], 0], 1.0 + x[at[5], 0]
        led = rotate_displacement(cosine, sine, bias, scale, ends.delta_m[i], ends.moment[i])
        place[0] += led.east
        place[1] += led.north
        place[2] += led.up
        turned[0, 0], turned[1, 0] = led.by_heading_e, led.by_heading_n
        turned[0, 1], turned[1, 1] = led.by_bias_e, led.by_bias_n
        turned[0, 2], turned[1, 2] = led.by_scale_e, led.by_scale_n
    elif kind == FREE:
        for c in range(3):
            place[c] += x[at[3 + c], 0] * ends.duration_s[i]
            turned[c, c] = ends.duration_s[i]


@njit(cache=True)
def place_ends(ends: Table, x: Array) -> Places:
    """Where m ends are at an estimate x, flat."""
    m, numbers = len(ends.kind), faced(x, ends.at[:, 3][ends.kind == UNIT])
    place, turned = np.empty((m, 3)), np.zeros((m, 3, 3))
    for i in range(m):
        place_end(ends, i, numbers, place[i], turned[i])
    return Places(place, turned)
