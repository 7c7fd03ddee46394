"""Where somebody crosses a radio's reach, from what is heard at all, and what that tells of reaches."""

from collections.abc import Sequence

import numpy as np

from estimator.fusion.entering.technologies import REACH, path_loss_variable
from estimator.fusion.learned import reach
from estimator.fusion.learned.links import KEPT, SAME_PLACE
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.memory.hearing import Crossing, Listener, listen
from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.memory.state import FusionState
from estimator.fusion.order import tick_of
from estimator.fusion.rows.descent import Found
from estimator.fusion.rows.rows import EXTRA, KIND, LINK, SIGMA
from estimator.graph.dense import Array
from estimator.measurements.rssi import Rssi

TELLING = ("unit", "static", "fixed")
"""How those move of whom it is known where they were between two seconds."""


def hear(state: FusionState, readings: Sequence[Rssi]) -> list[Crossing]:
    """Note who hears whom.

    Args:
        state: its listeners and what it knows of reaches are changed.
        readings: all powers of a tick, in order of epoch.

    Returns:
        The crossings that are sure now.
    """
    heard: dict[tuple[int, str], dict[str, float]] = {}
    for reading in readings:
        heard.setdefault((tick_of(reading.t), reading.a), {})[reading.b] = reading.t
    if not heard:
        return []
    crossings: list[Crossing] = []
    silent, packets, lost = state.reach.silent, 0, 0
    for (_, name), now in heard.items():
        told = listen(name, state.listeners.get(name, Listener()), now, silent or reach.MOST_SILENT)
        state.listeners[name] = told.listener
        packets, lost = packets + told.heard, lost + told.lost
        crossings += told.crossings
    state.reach = state.reach.with_packets(packets, lost)
    telling = [] if silent is None else [one for one in crossings if _tells(state, one)]
    if telling:
        _note(state)
    return telling


def _tells(state: FusionState, crossing: Crossing) -> bool:
    """Whether a crossing is of a radio that lies or walks with a unit, by one that walks with one."""
    modes = [state.nodes[name].mode for name in (crossing.a, crossing.b) if name in state.nodes]
    return len(modes) == 2 and "unit" in modes and all(mode in TELLING for mode in modes)


def learn_reach(state: FusionState, table: Array, found: Found) -> None:
    """What crossings tell of by how much reaches differ.

    Args:
        state: the fusion, whose `reach` is changed.
        table: of m readings, see `rows.Row`.
        found: what they have led to.
    """
    start = state.graph.starts.get(path_loss_variable(REACH))
    if start is None:
        return
    # Through a floor one tells nothing of it: it has no link there.
    crossed = (table[:, KIND] == RSSI) & (table[:, EXTRA] == start) & (table[:, LINK] >= 0.0)
    if not crossed.any():
        return
    for r in np.flatnonzero(crossed).tolist():
        # What was crossed at the same place just before tells nothing new of how reaches differ.
        if state.links.table[int(table[r, LINK]), KEPT] < SAME_PLACE:
            predicted, variance = float(found.predicted[r]), float(table[r, SIGMA]) ** 2
            # What it was off by before it was followed, as far as it was believed.
            off_db = float(found.residual[r]) * (1.0 + float(found.good[r]) * predicted / variance)
            state.reach = state.reach.with_crossing(off_db, predicted)
    _note(state)


def _note(state: FusionState) -> None:
    """Put what is known of reaches where the noise of all technologies is looked up."""
    variance = (state.reach.sigma_db / reach.NOMINAL_DB) ** 2
    state.noise[REACH] = LearnedNoise(1.0, variance, 1.0, reach.SHARED * variance, least=0.0)
