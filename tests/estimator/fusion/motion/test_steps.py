"""Who climbs a stair with a unit that measures heights, and with one that does not."""

import numpy as np
import pytest

from estimator.estimate import NodeEstimate
from estimator.fusion.physics import CLIMB_M_PER_ROOT_M
from estimator.levels import most_probable
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import Node
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker

LEVELS = [(0, "Ground", 0.0), (1, "First", 3.0)]
ON_LEVEL, STAIR = 30, 12
"""Seconds along a corridor of 1 m/s, up a stair, and on along the corridor above."""
RISE_M, SECONDS = 0.25, 2 * ON_LEVEL + STAIR
BASE_PA, PA_PER_M = 101_325.0, 12.0


def up_m(t: int) -> float:
    return RISE_M * min(max(t - ON_LEVEL, 0), STAIR)


def climbs(measures_heights: bool, *others: AnyReading) -> list[AnyReading]:
    begins: list[AnyReading] = [
        Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1),
    ]
    steps: list[AnyReading] = [
        Displacement(
            t=float(t),
            from_t=t - 1.0,
            node="ff1",
            delta_m=(1.0, 0.0, up_m(t) - up_m(t - 1) if measures_heights else 0.0),
        )
        for t in range(1, SECONDS + 1)
    ]
    return [*begins, *steps, *others]


def altimeter(since: int = 1) -> list[AnyReading]:
    chance = np.random.default_rng(1)
    return [
        Altitude(t=float(t), node="ff1", up_m=up_m(t) + float(chance.normal(0.0, 0.5)), sigma_m=0.5)
        for t in range(since, SECONDS + 1)
    ]


def barometer() -> list[AnyReading]:
    base = Pressure(t=0.5, node="base", pressure_pa=BASE_PA)
    own = [
        Pressure(t=float(t), node="ff1", pressure_pa=BASE_PA - PA_PER_M * up_m(t))
        for t in range(1, SECONDS + 1)
    ]
    return [base, *own]


def shown(readings: list[AnyReading], node: str = "ff1") -> list[NodeEstimate]:
    """How it is shown second by second."""
    tracker, found = KirchhoffTracker(), []
    for second in range(SECONDS + 1):
        tracker.fold([r for r in readings if second - 1 < r.t <= second])
        found += [e for e in tracker.estimates() if e.node == node]
    return found


def up_of(estimate: NodeEstimate) -> tuple[float, float]:
    """Height and its standard deviation (m)."""
    assert estimate.position_m is not None
    assert estimate.covariance_m2 is not None
    return estimate.position_m[2], float(np.sqrt(estimate.covariance_m2[5]))


def storey_of(estimate: NodeEstimate) -> tuple[int, float]:
    up, sigma = up_of(estimate)
    storey = most_probable(LEVELS, up, sigma**2)
    assert storey is not None
    return storey.level, storey.probability


def test_a_unit_that_measures_heights_is_believed() -> None:
    level, sure = storey_of(shown(climbs(True))[-1])
    assert level == 1
    assert sure > 0.99


@pytest.mark.parametrize("heights", [altimeter(), barometer()], ids=["altimeter", "barometer"])
def test_other_readings_tell_the_storey_of_a_unit_that_measures_no_heights(heights: list[AnyReading]) -> None:
    track = shown(climbs(False, *heights))
    for estimate in track[ON_LEVEL // 2 :]:
        up, sigma = up_of(estimate)
        assert abs(up - up_m(round(estimate.t))) < 3.0 * sigma
    level, sure = storey_of(track[-1])
    assert level == 1
    assert sure > 0.7


def test_the_first_height_tells_where_he_has_climbed_to_before() -> None:
    last = shown(climbs(False, *altimeter(since=SECONDS - 10)))[-1]
    assert up_of(last)[0] == pytest.approx(up_m(SECONDS), abs=1.0)


def test_nobody_is_sure_of_a_storey_that_nothing_measures() -> None:
    readings = climbs(False, Drop(t=SECONDS - 5.0, node="b1", by="ff1"))
    climbed_m = CLIMB_M_PER_ROOT_M * np.sqrt(SECONDS)
    up, sigma = up_of(shown(readings)[-1])
    assert sigma == pytest.approx(climbed_m, rel=0.1)
    assert abs(up - up_m(SECONDS)) < 2.0 * sigma
    assert storey_of(shown(readings)[-1])[1] < 0.9
    assert storey_of(shown(readings, "b1")[-1])[1] < 0.9


@pytest.mark.parametrize("node", ["ff1", "b1"])
def test_the_smoothed_view_and_the_evidence_say_so_as_well(node: str) -> None:
    readings = climbs(False, Drop(t=SECONDS - 5.0, node="b1", by="ff1"))
    smoother = BatchSmoother(TrackerSettings())
    last, evidence = smoother.smooth(readings)[node][-1], smoother.evidence(readings, node)
    assert evidence is not None
    online = up_of(shown(readings, node)[-1])[1]
    assert np.sqrt(last.covariance_m2[5]) == pytest.approx(online, rel=0.05)
    assert np.sqrt(evidence.covariance_m2[5]) == pytest.approx(online, rel=0.05)


def test_where_he_is_across_is_as_sure_as_it_was() -> None:
    plain, climbing = shown(climbs(True))[-1], shown(climbs(False))[-1]
    assert plain.covariance_m2 is not None
    assert climbing.covariance_m2 is not None
    assert climbing.covariance_m2[:2] == pytest.approx(plain.covariance_m2[:2], rel=0.05)
    assert climbing.covariance_m2[3] == pytest.approx(plain.covariance_m2[3], rel=0.05)
