"""Once through an incident by the filter: what is fused, and where the solution of the whole starts."""

import math
from bisect import bisect_left
from collections.abc import Sequence

from estimator.fusion.canonical_order import UNTIL_T
from estimator.fusion.holding import flush
from estimator.fusion.memory.ledger import Ledger
from estimator.fusion.memory.state import FusionState
from estimator.fusion.tick import fold_tick
from estimator.inertial.samples import AnyFolded
from estimator.smoothing.window import solve_for_headings, solve_if_due

TICK_S = 2.0
"""Only where to start is to be found: ticks are longer than the online tracker's. In still longer ones a node
moves too far for the noise that is learned on the way."""
RARER = 48.0
"""Only where to start is to be found: the window is solved this many times more rarely."""


class FirstPass:
    """Readings folded once, tick by tick; it goes on where it stopped, and makes no difference that it did.

    Args:
        origin_wgs84: latitude (°), longitude (°), height (m) of the local origin, if known.
    """

    def __init__(self, origin_wgs84: tuple[float, float, float] | None = None) -> None:
        self._state = FusionState(origin_wgs84)
        self._state.ledger = Ledger(complete=True)

    def fold(self, readings: Sequence[AnyFolded]) -> None:
        """Fold readings, all those of each of their ticks.

        Args:
            readings: in canonical order, none of a tick that is folded or of one before it.
        """
        _fold(self._state, readings)

    def ended(self, readings: Sequence[AnyFolded]) -> FusionState:
        """What is known where these readings are the last: a state of its own, and this goes on without them.

        Args:
            readings: as `fold` takes them.
        """
        state = self._state.copy()
        _fold(state, readings)
        flush(state)
        solve_for_headings(state)
        state.keep_poses()
        return state


def end_of_tick(t: float) -> float:
    """End of the tick of the first pass that an epoch belongs to, which the tick itself does not have (s)."""
    return (math.floor(t / TICK_S) + 1) * TICK_S


def _fold(state: FusionState, readings: Sequence[AnyFolded]) -> None:
    start = 0
    while start < len(readings):
        until_t = end_of_tick(readings[start].until_t)
        end = bisect_left(readings, until_t, start, key=UNTIL_T)
        fold_tick(state, until_t, readings[start:end])
        solve_if_due(state, until_t, RARER)
        start = end
