"""Where everybody is at the newest readings, for a picture: these come before their displacements."""

from estimator.fusion.holding import flush, names_of
from estimator.fusion.memory.state import AnyHeld, FusionState
from estimator.fusion.motion.dead_reckoning import go_on
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
    until: dict[str, float] = {}
    for reading in state.waiting:
        names = names_of(reading)
        placed = all(name in state.nodes and state.nodes[name].decided for name in names)
        if placed and _tells(reading):
            until |= {name: max(reading.t, until.get(name, reading.t)) for name in names}
    go_on(state, until)
    flush(state)


def _tells(reading: AnyHeld) -> bool:
    """Whether it tells of a place that is known: only then is that place's fix as new as the reading."""
    if isinstance(reading, Position):
        return reading.position_m is not None
    return isinstance(reading, (Range, Rssi, Altitude))
