"""Displacements of one unit that are stamped with the same epoch: parts of its way, or copies of one."""

import math
from collections.abc import Sequence
from itertools import groupby

from msgspec.structs import replace

from estimator.fusion.learned.report_period import Reported
from estimator.fusion.memory.state import FusionState
from estimator.inertial.displacement import InertialDisplacement
from estimator.measurements.displacement import Displacement

COPY = 1e-6
"""Copies of a reading by two gateways may differ by how they write a number (m, rad)."""


def _whose(reading: Displacement) -> tuple[float, str, bool]:
    return reading.t, reading.node, type(reading) is InertialDisplacement


def joined(state: FusionState, readings: Sequence[Displacement]) -> list[Displacement]:
    """Add up what one unit reports of one epoch: each tells of what was walked since the one before.

    Stamps may be rounded. Only one of each that say the same counts: two gateways have heard it.

    Args:
        state: the fusion: counts those that go into another.
        readings: in canonical order, of one tick.

    Returns:
        One of each unit and epoch, in order of epoch.
    """
    if len(readings) < 2:
        return list(readings)
    by_epoch = {_whose(reading): reading for reading in readings}
    if len(by_epoch) == len(readings):
        return [by_epoch[one] for one in sorted(by_epoch)]
    found = []
    for _, same in groupby(sorted(readings, key=_whose), key=_whose):
        first, *others = same
        parts = [first]
        for other in others:
            if any(_is_copy(other, part) for part in parts):
                text = f"{other.node} reported this epoch's displacement before"
                state.say("conflict", other.t, other.node, text, once=f"epochs of {other.node}")
                state.count("not_fused")
            else:
                parts.append(other)
        found.append(first if len(parts) == 1 else _sum_of(parts))
        state.count("fused", len(parts) - 1)
    return found


def _is_copy(one: Displacement, other: Displacement) -> bool:
    return one.from_t == other.from_t and says_the_same(one, other)


def says_the_same(one: Displacement | Reported, other: Displacement | Reported) -> bool:
    """Whether two reports of one unit tell of the same step, and of the same heading if they tell of one."""
    # Most are told apart by what they say of one axis.
    near = abs(one.delta_m[0] - other.delta_m[0]) <= COPY and math.dist(one.delta_m, other.delta_m) <= COPY
    if one.heading_rad is None or other.heading_rad is None:
        return near and one.heading_rad is other.heading_rad
    return near and abs(one.heading_rad - other.heading_rad) <= COPY


def _sum_of(parts: Sequence[Displacement]) -> Displacement:
    """The way of all parts: what they are unsure by adds up as well."""
    east, north, up = (sum(part.delta_m[axis] for part in parts) for axis in range(3))
    begun = [part.from_t for part in parts if part.from_t is not None]
    sigmas = [part.sigma_m for part in parts]
    told = [sigma for sigma in sigmas if sigma is not None]
    sigma_m = math.hypot(*told) if len(told) == len(sigmas) else None
    from_t = min(begun) if begun else None
    return replace(parts[-1], delta_m=(east, north, up), from_t=from_t, sigma_m=sigma_m)
