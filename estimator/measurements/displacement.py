"""`displacement`: what a PDR unit has moved since its last report."""

from typing import NamedTuple

import numpy as np
from numba import njit

from estimator.graph.dense import Array
from estimator.measurements.base import AngleRad, EpochSeconds, Identifier, Reading, SigmaM, Vector3M


class Displacement(Reading, tag="displacement", frozen=True):
    """The displacement of a PDR unit since its last one, in the unit's own navigation frame.

    The frame has z up and x nominally east; it is turned by an unknown, slowly drifting heading error.

    Attributes:
        node: the unit.
        delta_m: displacement (m).
        from_t: start of the displacement, Unix seconds; None: since the last one.
        heading_rad: the unit's heading at `t` in that frame (rad).
        sigma_m: standard deviation per axis (m).
    """

    node: Identifier
    delta_m: Vector3M
    from_t: EpochSeconds | None = None
    heading_rad: AngleRad | None = None
    sigma_m: SigmaM | None = None

    def __post_init__(self) -> None:
        """Refuse a displacement that ends before it starts.

        Raises:
            ValueError: `from_t` is later than `t`.
        """
        if self.from_t is not None and self.from_t > self.t:
            raise ValueError("`from_t` is later than `t`: a displacement ends after it starts")


class Awaited(Reading, tag="awaited", frozen=True):
    """That the first report of a unit is still to come: `t` is when it has begun to sum up what that tells.

    Attributes:
        node: the unit.
        told_t: epoch of the report, Unix seconds.
    """

    node: Identifier
    told_t: EpochSeconds


class Moved(NamedTuple):
    """Where units stand after a displacement, with derivatives by where they stood.

    Attributes:
        state: position, ψ, β, s − 1 of each, g × 6.
        transition: derivatives of `state` by the state before, g × 6 × 6.
    """

    state: Array
    transition: Array


@njit(cache=True)
def move(state: Array, delta_m: Array, duration_s: Array) -> Moved:
    """P' = p + s Rz(ψ) δ and ψ' = ψ + β Δt: the unit's frame turns while it walks.

    The frame's turn halfway is used for the displacement, exact to second order in β Δt. The scale is that of
    steps: heights are not scaled, or an error of the air pressure's heights would stretch the whole map.

    Args:
        state: east, north, up (m), ψ (rad), β (rad/s), s − 1 of each unit, g × 6.
        delta_m: displacement in the unit's frame, g × 3 (m).
        duration_s: Δt, g (s).
    """
    g = len(state)
    after, transition = state.copy(), np.zeros((g, 6, 6))
    for i in range(g):
        psi, bias, scale = state[i, 3], state[i, 4], 1.0 + state[i, 5]
        halfway = psi + 0.5 * bias * duration_s[i]
        cosine, sine = np.cos(halfway), np.sin(halfway)
        east = cosine * delta_m[i, 0] - sine * delta_m[i, 1]
        north = sine * delta_m[i, 0] + cosine * delta_m[i, 1]
        after[i, 0] += scale * east
        after[i, 1] += scale * north
        after[i, 2] += delta_m[i, 2]
        after[i, 3] += bias * duration_s[i]
        for axis in range(6):
            transition[i, axis, axis] = 1.0
        transition[i, 0, 3], transition[i, 1, 3] = -scale * north, scale * east
        transition[i, 0, 4] = transition[i, 0, 3] * 0.5 * duration_s[i]
        transition[i, 1, 4] = transition[i, 1, 3] * 0.5 * duration_s[i]
        transition[i, 0, 5], transition[i, 1, 5] = east, north
        transition[i, 3, 4] = duration_s[i]
    return Moved(after, transition)
