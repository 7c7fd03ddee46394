"""Copies of one reading: two gateways hear a radio, and both report what it has told."""

from collections.abc import Sequence

from estimator.fusion.memory.state import FusionState
from estimator.inertial.samples import AnyFolded
from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.bearing import Bearing
from estimator.measurements.drop import Drop
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.rssi import Rssi

ONCE = (Range, Rssi, Bearing, Position, Altitude, Pressure, Drop, Retire)
"""What counts again each time it is told. Displacements are joined (`same_epoch`), samples follow their
boot's own clock, and who is introduced again in the same words stays who he is."""


def without_copies(state: FusionState, readings: Sequence[AnyFolded]) -> list[AnyFolded]:
    """The readings without copies: what says the same of the same epoch in every field was measured once.

    Args:
        state: the fusion: counts the copies as not fused.
        readings: in canonical order, in which copies are neighbours.
    """
    found: list[AnyFolded] = []
    before: AnyFolded | None = None
    for reading in readings:
        if reading == before and isinstance(reading, ONCE):
            state.count("not_fused")
        else:
            found.append(reading)
        before = reading
    return found
