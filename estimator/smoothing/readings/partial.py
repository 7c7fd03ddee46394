"""Readings of a part of a window: what moves and is not in it is held where it is."""

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.memory.ledger import BODY_BEARING
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.ends import FIXED, FREE, UNIT, Table, place_ends
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.readings.linearisation import Readings

Chosen = NDArray[np.bool_]


def partial(
    readings: Readings, numbers: Unknowns, x: Array, pairs: Chosen, singles: Chosen, drops: Chosen
) -> Readings:
    """Some readings of a window as those of a part of it.

    Args:
        readings: of the window: m pairs, n singles, d drops.
        numbers: of the part.
        x: the window's estimate, flat.
        pairs: which of the pairs, m.
        singles: which of the singles, n.
        drops: which of the drops, d.
    """
    a, b = (_ends(table, numbers, x, pairs) for table in (readings.a, readings.b))
    kind, was = readings.kind[pairs], readings.a
    facing = x[was.at[pairs, 3]]
    # The heading that a bearing counts from is held as well.
    held = (kind == BODY_BEARING) & (was.kind[pairs] == UNIT) & (a.kind == FIXED)
    return Readings(
        kind=kind,
        value=readings.value[pairs],
        constant=readings.constant[pairs] + np.where(held, facing, 0.0),
        extra=np.maximum(numbers.place[readings.extra[pairs]], 0),
        lost=readings.lost[pairs],
        ahead=readings.ahead[pairs],
        a=a,
        b=b,
        axis=readings.axis[singles],
        told=readings.told[singles],
        off=np.where(readings.off[singles] >= 0, numbers.place[readings.off[singles]], -1),
        speed=readings.speed[singles],
        on=_ends(readings.on, numbers, x, singles),
        by=_ends(readings.by, numbers, x, drops),
        crumb=_ends(readings.crumb, numbers, x, drops),
        headings=numbers.layout.headings(),
    )


def _ends(table: Table, numbers: Unknowns, x: Array, chosen: Chosen) -> Table:
    """Some ends of readings in a part of their window."""
    kind, at, fixed_m, delta_m, moment, duration_s = table
    some = Table(
        kind[chosen], at[chosen], fixed_m[chosen], delta_m[chosen], moment[chosen], duration_s[chosen]
    )
    held = ((some.kind == UNIT) | (some.kind == FREE)) & (numbers.place[some.at[:, 0]] < 0)
    if held.any():
        fixed_m = np.where(held[:, None], place_ends(some, x).place, some.fixed_m)
        some = some._replace(kind=np.where(held, FIXED, some.kind), fixed_m=fixed_m)
    return some._replace(at=np.maximum(numbers.place[some.at], 0))
