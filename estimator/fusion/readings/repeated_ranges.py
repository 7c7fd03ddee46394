"""Ranges that are none: a driver goes on handing out the last one that its radio has measured.

Ranges have noise, and whoever walks on is never as far from a radio as before to the last digit. One that is
told again and again, while its bearer has walked on or his other ranges change, is no measurement.
"""

import numpy as np

from estimator.fusion.learned.link_correlation import REPEATS, SINCE_T, SINCE_WAY, TOLD, Links
from estimator.fusion.memory.nodes import NodeState

REPEATED, COARSE = 3, 6
"""So often in a row a range is told by chance once in a thousand times, and one in whole decimetres."""
LASTS_S = 1.5
"""Chance lasts no longer: of ten a second that differ by centimetres, one in a hundred repeats two others."""
WALKED_M = 1.0
DECIMETRES = 10.0
DIGITS = 1e-6


def is_repeated(links: Links, link: int, t: float, range_m: float, a: NodeState, b: NodeState) -> bool:
    """Whether a range is only told again.

    Args:
        links: of all; the link's row is changed.
        link: its number.
        t: epoch of the range (s).
        range_m: the range (m).
        a: one end.
        b: the other one.
    """
    row, way_m = links.table[link], a.way_m + b.way_m
    if row[TOLD] != range_m:
        # The first of all is no change.
        row[SINCE_T] = -np.inf if np.isnan(row[TOLD]) else t
        row[TOLD], row[REPEATS], row[SINCE_WAY] = range_m, 1.0, way_m
        return False
    row[REPEATS] += 1.0
    whole = abs(range_m * DECIMETRES - round(range_m * DECIMETRES)) < DIGITS
    if row[REPEATS] < (COARSE if whole else REPEATED) or t < row[SINCE_T] + LASTS_S:
        return False
    if way_m > row[SINCE_WAY] + WALKED_M:
        return True
    moving = {node.node for node in (a, b) if node.moving}
    others = [number for (_, *ends), number in links.numbers.items() if not moving.isdisjoint(ends)]
    return bool((links.table[others, SINCE_T] > row[SINCE_T]).any())
