"""What bearers' bodies do to readings: a radio is worn, and what lies behind its bearer is seen through him.

A range to it is too long and a power from it too low, both by about the cosine of the angle between where he
faces and where the other radio lies. Where he faces is where he goes by his unit; that, and where all are, as
it was thought to be before the window is solved: numbers that are known. How large the effect is, the third
number of each technology tells. Of who has no unit nobody knows what he faces.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.measurements.body import ahead_of
from estimator.smoothing.keyframes.displacement_sums import Ways
from estimator.smoothing.keyframes.ground import Ground
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import HEADING, STATES
from estimator.smoothing.readings.linearisation import Readings, separations


def ahead_in(layout: Layout, ground: Ground, readings: Readings, pairs: Array, slab: Integers) -> Array:
    """How far ahead of its bearer the other radio of each pair lies, of ranges how far behind, m.

    It is what a reading is off by for each metre or decibel that bodies do; nil of bearings, and of radios
    that nobody wears.

    Args:
        layout: of the window.
        ground: the same, as arrays.
        readings: of it.
        pairs: rows of the ledger, m × 11.
        slab: keyframe of each, m at least.
    """
    x = layout.start()
    keyframes = x[: layout.length * layout.width].reshape(layout.length, layout.width)
    worn = np.array([one.node.role not in physics.OUTSIDE_ROLES for one in layout.walks], dtype=np.bool_)
    return ahead(pairs, slab, ground, worn, keyframes, separations(readings, x))


@njit(cache=True)
def ahead(
    pairs: Array, slab: Integers, ground: Ground, worn: NDArray[np.bool_], keyframes: Array, way: Array
) -> Array:
    """See `ahead_in`.

    Args:
        pairs: rows of the ledger, m × 11.
        slab: keyframe of each, m at least.
        ground: of the window.
        worn: whether the radio of each walk has a bearer.
        keyframes: the estimate, k × 6 walks.
        way: from the second end of each pair to the first, m × 3 (m).
    """
    found, ways, walk = np.zeros(len(pairs)), ground.ways, ground.nodes.walk
    unit = np.full(len(walk), -1)
    for w in range(len(ways.numbers)):
        unit[ways.numbers[w]] = w
    steps = by_steps(ways)
    for i in range(len(pairs)):
        if pairs[i, 1] > RSSI:
            continue
        for end in range(2):
            number = int(pairs[i, 2 + end])
            w, away = walk[number], -1.0 if end == 0 else 1.0
            if w < 0 or unit[number] < 0 or not worn[w]:
                continue
            first, after = ways.firsts[unit[number]], ways.firsts[unit[number] + 1]
            j = min(first + np.searchsorted(ways.marks[first:after], pairs[i, 0]), after - 1)
            turn = keyframes[slab[i], STATES * w + HEADING]
            cosine, sine = np.cos(turn), np.sin(turn)
            east, north = cosine * steps[j, 0] - sine * steps[j, 1], sine * steps[j, 0] + cosine * steps[j, 1]
            found[i] += ahead_of(east, north, away * way[i, 0], away * way[i, 1])
        if pairs[i, 1] == RANGE:
            found[i] = -found[i]
    return found


@njit(cache=True)
def by_steps(ways: Ways) -> Array:
    """Where bearers go before each mark of their ways, in their units' frames: unit vectors, × 2.

    Who stands faces where he went; nil before he has set out.
    """
    found = np.zeros((len(ways.marks), 2))
    for w in range(len(ways.numbers)):
        for j in range(ways.firsts[w] + 1, ways.firsts[w + 1]):
            east = ways.sums[j, 0] - ways.sums[j - 1, 0]
            north = ways.sums[j, 1] - ways.sums[j - 1, 1]
            way_m = np.hypot(east, north)
            if way_m > physics.GOES_MPS * (ways.marks[j] - ways.marks[j - 1]):
                found[j, 0], found[j, 1] = east / way_m, north / way_m
            else:
                found[j] = found[j - 1]
    return found
