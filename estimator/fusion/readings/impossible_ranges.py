"""Ranges that are far too long to be any: a gateway that tells millimetres, or of a node elsewhere.

Walls and echoes make a range too long by metres, and robust noise knows them. One that is ten times as long
as two can be apart is another thing: taken as an outlier it still pulls, and what is asked about told places,
delays and scales would explain it by whatever is least unlikely.
"""

from collections.abc import Callable

import numpy as np

from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.range import Range

FAR_M, TIMES, SIGMAS = 100.0, 10.0, 4.0
"""No range that is shorter is asked about; one is too long that is longer by this, and so many times, than
two are apart, with so many sigmas of where they are."""
UNHEARD_OF_M = 1000.0
"""No radio that a firefighter wears or drops is ranged from farther off, wherever it is."""


def is_impossible(
    state: FusionState, reading: Range, a: NodeState, b: NodeState, covariance: Callable[[], Array]
) -> bool:
    """Whether a range is far longer than both can be apart; said of each two once.

    Args:
        state: the fusion; it is told.
        reading: the range.
        a: one end.
        b: the other one.
        covariance: gives that of all places, of which such a range alone asks.
    """
    if reading.range_m <= FAR_M:
        return False
    most_m, likely = UNHEARD_OF_M, ""
    if a.decided and b.decided:
        apart_m = float(np.linalg.norm(_place_m(state, a) - _place_m(state, b)))
        if reading.range_m <= FAR_M + TIMES * apart_m:
            return False
        most_m = FAR_M + TIMES * (apart_m + SIGMAS * _sigma_m(state, a, b, covariance()))
        likely = f", where {apart_m:.0f} m are likely"
    if reading.range_m <= most_m:
        return False
    says = f"a range between {reading.a} and {reading.b} says {reading.range_m:.0f} m{likely}"
    text = f"{says}: such are set aside; see whether their gateway tells millimetres, and where both are"
    state.say("not_fused", reading.t, a.node, text, once=f"far {min(a.node, b.node)} {max(a.node, b.node)}")
    return True


def _place_m(state: FusionState, node: NodeState) -> Array:
    return np.array(node.place_m) if node.mode == "fixed" else state.graph.value(node.position)


def _sigma_m(state: FusionState, a: NodeState, b: NodeState, covariance: Array) -> float:
    """Standard deviation of how far apart two are, at most (m)."""
    total = 0.0
    for node in (a, b):
        if node.mode != "fixed":
            rows = state.graph.rows(node.position)
            total += float(np.sqrt(np.trace(covariance[rows, rows])))
    return total
