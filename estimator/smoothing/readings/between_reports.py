"""What a bearer's place is unsure by inside a displacement over a long time, for readings of a window.

Only where it begins and ends is told: between them he may have walked anywhere
(`long_displacements.bridged_m2`). All readings in it are off by the same way: however many there are, they
tell of its ends what one would tell of them that knows the way as little.
"""

import numpy as np

from estimator.fusion.motion.long_displacements import UPWARDS, alike
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.readings.window_readings import WindowReadings


def widened(layout: Layout, found: WindowReadings) -> tuple[Array, Array, Array, Array]:
    """Variances of ends of readings, with what their units have not told; see `WindowReadings.unsure_m2`.

    Args:
        layout: of the window.
        found: its readings.
    """
    ways = [(walk.number, walk.way) for walk in layout.walks if walk.way is not None and walk.way.bridges]
    if not ways:
        return found.unsure_m2
    pairs, singles, drops = found.told
    one, other, single, by = (each.copy() for each in found.unsure_m2)
    ends = (
        (one, pairs[:, 2], pairs[:, 0]),
        (other, pairs[:, 3], pairs[:, 0]),
        (single, singles[:, 1], singles[:, 0]),
        (by, drops[:, 2], drops[:, 0]),
    )
    for number, way in ways:
        own = [(unsure_m2, np.flatnonzero(numbers == number), t) for unsure_m2, numbers, t in ends]
        shared, first = alike(way.marks, np.concatenate([t[at] for _, at, t in own])), 0
        for unsure_m2, at, t in own:
            times = shared[first : first + len(at)]
            unsure_m2[at] += (times * way.bridged(t[at]))[:, None] * UPWARDS
            first += len(at)
    return one, other, single, by
