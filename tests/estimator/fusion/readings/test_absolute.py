"""Heights by air pressure are counted from the base that told its own last."""

import math

import pytest

from estimator.measurements.altitude import Pressure
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.kirchhoff import KirchhoffTracker

ROOF_M = 24.0


def pressure_pa(up_m: float) -> float:
    """Of the standard atmosphere near the ground, by the barometric formula."""
    return 101_325.0 * math.exp(-9.80665 * up_m / (287.05287 * 288.15))


@pytest.mark.parametrize("told_last", ["street", "roof"])
def test_two_bases_at_different_heights_tell_the_same_height_of_who_climbs(told_last: str) -> None:
    bases = {"street": 0.0, "roof": ROOF_M}
    order = sorted(bases, key=lambda name: name == told_last)
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=0.0, node=n, role="base", position_m=(0.0, 0.0, up)) for n, up in bases.items()])
    tracker.fold([Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.5)])
    for second in range(1, 121):
        t = float(second)
        told = [
            Pressure(t=t - 0.5 + 0.1 * i, node=name, pressure_pa=pressure_pa(bases[name]))
            for i, name in enumerate(order)
        ]
        step = Displacement(t=t, from_t=t - 1.0, node="ff1", delta_m=(0.5, 0.0, 0.1))
        tracker.fold([step, *told, Pressure(t=t, node="ff1", pressure_pa=pressure_pa(0.1 * second))])
    found = next(estimate for estimate in tracker.estimates() if estimate.node == "ff1")
    assert found.position_m is not None
    assert found.position_m[2] == pytest.approx(12.0, abs=1.0)
