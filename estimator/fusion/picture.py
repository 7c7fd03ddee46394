"""Where everybody is at the newest readings, for a picture: these come before their displacements."""

from collections.abc import Sequence
from itertools import groupby

from estimator.fusion.canonical_order import tick_of
from estimator.fusion.holding import flush, names_of
from estimator.fusion.memory.state import AnyHeld, FusionState
from estimator.fusion.motion.dead_reckoning import go_on, go_on_at, paces
from estimator.fusion.readings.between_footholds import step_on
from estimator.measurements.altitude import Altitude
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi


def look(state: FusionState) -> None:
    """Hold what waits for a displacement: whose unit has just told how he goes goes on so until then.

    Args:
        state: a copy, changed in place: what is foreseen here is never held against what is told later.
    """
    step_on(state)
    seldom = paces(state)
    if not seldom:
        go_on(state, _told_of(state, state.waiting))
        flush(state)
        return
    waiting, state.waiting = state.waiting, ()
    for _, some in groupby(waiting, key=lambda reading: tick_of(reading.t)):
        state.waiting = tuple(some)
        until = _told_of(state, state.waiting)
        go_on_at(state, until, seldom)
        go_on(state, {name: t for name, t in until.items() if name not in seldom})
        flush(state)


def _told_of(state: FusionState, readings: Sequence[AnyHeld]) -> dict[str, float]:
    """Up to when readings tell of each place that is known, by node (s)."""
    until: dict[str, float] = {}
    for reading in readings:
        names = names_of(reading)
        placed = all(name in state.nodes and state.nodes[name].decided for name in names)
        if placed and _tells(reading):
            until |= {name: max(reading.t, until.get(name, reading.t)) for name in names}
    return until


def _tells(reading: AnyHeld) -> bool:
    """Whether it tells of a place that is known: only then is that place's fix as new as the reading."""
    if isinstance(reading, Position):
        return reading.position_m is not None
    return isinstance(reading, (Range, Rssi, Altitude))
