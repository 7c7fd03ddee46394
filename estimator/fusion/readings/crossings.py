"""Where somebody crosses a radio's reach, from what is heard at all, and what that tells of reaches."""

import math
from collections.abc import Sequence

import numpy as np
from numba import njit

from estimator.fusion.canonical_order import tick_of
from estimator.fusion.entering.technologies import REACH, path_loss_variable
from estimator.fusion.learned import reach
from estimator.fusion.learned.link_correlation import KEPT, SAME_PLACE
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.memory.hearing import Crossing, Heard, Listener, listen
from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.memory.state import FusionState
from estimator.fusion.rows.gauss_newton import GOOD, PREDICTED, RESIDUAL
from estimator.fusion.rows.rows import EXTRA, KIND, LINK, SIGMA
from estimator.graph.dense import Array
from estimator.measurements.rssi import Rssi

NEW = Listener()
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
    if not readings:
        return []
    heard: dict[int, dict[str, Heard]] = {}
    listening, now = dict[str, Heard](), Heard()
    before_t, before, scan = math.nan, "", 0
    for reading in readings:
        t, name = reading.t, reading.a
        if t != before_t:
            listening, before_t, before = heard.setdefault(tick_of(t), {}), t, ""
        if name != before:
            now, before = listening.setdefault(name, Heard()), name
            scan = 0
        now.radios[reading.b] = t
        scan += 1
        now.at_once = max(now.at_once, scan)
    crossings: list[Crossing] = []
    silent, packets, lost = state.reach.silent, 0, 0
    for listening in heard.values():
        for name, now in listening.items():
            told = listen(name, state.listeners.get(name, NEW), now, silent or reach.MOST_SILENT)
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


def learn_reach(state: FusionState, table: Array, told: Array) -> None:
    """What crossings tell of by how much reaches differ.

    Args:
        state: the fusion, whose `reach` is changed.
        table: of m readings, see `rows.Row`.
        told: what has come of them, m × 3, see `gauss_newton.RESIDUAL`.
    """
    start = state.graph.starts.get(path_loss_variable(REACH))
    if start is None or start not in table[:, EXTRA].tolist():
        return
    crossed = crossings_in(table, told, state.links.table, start).tolist()
    if not crossed:
        return
    # What was crossed at the same place just before tells nothing new of how reaches differ.
    news = [one for kept, *one in crossed if kept < SAME_PLACE]
    if news:
        # What each was off by before it was followed, as far as it was believed.
        off_db = [off * (1.0 + good * predicted / sigma**2) for off, predicted, good, sigma in news]
        state.reach = state.reach.with_crossings(off_db, [predicted for _, predicted, *_ in news])
    _note(state)


@njit(cache=True)
def crossings_in(table: Array, told: Array, links: Array, start: int) -> Array:
    """What has come of those of m readings that are crossings of reaches.

    Through a floor one tells nothing of them: it has no link there.

    Args:
        table: the readings, see `rows.Row`.
        told: what has come of them, m × 3, see `gauss_newton.RESIDUAL`.
        links: the newest reading on each link, see `links`.
        start: first row of the reaches' states.

    Returns:
        How much of the error before each was kept, what it was off by, the variance of its prediction, the
        probability that it is good, and its sigma; k × 5.
    """
    found, count = np.empty((len(table), 5)), 0
    for r in range(len(table)):
        if table[r, KIND] == RSSI and table[r, EXTRA] == start and table[r, LINK] >= 0.0:
            found[count, 0] = links[int(table[r, LINK]), KEPT]
            found[count, 1], found[count, 2] = told[r, RESIDUAL], told[r, PREDICTED]
            found[count, 3], found[count, 4] = told[r, GOOD], table[r, SIGMA]
            count += 1
    return found[:count]


def _note(state: FusionState) -> None:
    """Put what is known of reaches where the noise of all technologies is looked up."""
    variance = (state.reach.sigma_db / reach.NOMINAL_DB) ** 2
    state.noise[REACH] = LearnedNoise(1.0, variance, 1.0, reach.SHARED * variance, least=0.0)
