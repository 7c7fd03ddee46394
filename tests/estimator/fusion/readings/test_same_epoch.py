"""A unit whose displacements are stamped with the same epoch."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.trackers.entry import BASE, off_m, shown

ENTERS = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3)
CHANCE = np.random.default_rng(1)
HALVES = [
    Displacement(t=float(math.ceil(k / 2)), node="ff1", delta_m=(float(CHANCE.normal(0.5, 0.02)), 0.0, 0.0))
    for k in range(1, 121)
]


def whole(second: Displacement) -> Displacement:
    return replace(second, from_t=second.t - 1.0)


@pytest.mark.parametrize("told", [False, True], ids=["since the last one", "since a rounded epoch"])
def test_what_is_reported_twice_a_second_and_stamped_in_seconds_counts_whole(told: bool) -> None:
    readings = [BASE, ENTERS, *(map(whole, HALVES) if told else HALVES)]
    tracker = KirchhoffTracker()
    tracker.fold(readings)
    assert off_m(shown(tracker), (60.0, 0.0)) < 1.0
    assert tracker.take_notices() == []
    assert tracker.counts()["fused"] == len(readings)
    assert math.dist(BatchSmoother().smooth(readings)["ff1"][-1].position_m[:2], (60.0, 0.0)) < 1.0


def test_what_two_gateways_have_heard_counts_once() -> None:
    copies = [replace(half, delta_m=(round(half.delta_m[0], 7), 0.0, 0.0)) for half in HALVES[::2]]
    once, twice = KirchhoffTracker(), KirchhoffTracker()
    once.fold([BASE, ENTERS, *HALVES[::2]])
    twice.fold([BASE, ENTERS, *HALVES[::2], *copies])
    at = shown(once).position_m
    assert at is not None
    assert off_m(shown(twice), at) < 0.01
    assert [notice.code for notice in twice.take_notices()] == ["conflict"]


def test_what_two_parts_are_unsure_by_adds_up() -> None:
    parts = [replace(half, sigma_m=1.0) for half in HALVES[:2]]
    added = replace(parts[0], delta_m=(1.0, 0.0, 0.0), sigma_m=math.sqrt(2.0))
    spreads = []
    for readings in ([added], parts):
        tracker = KirchhoffTracker()
        tracker.fold([BASE, ENTERS, *readings])
        spreads.append(shown(tracker).covariance_m2)
    assert spreads[1] == pytest.approx(spreads[0], rel=0.02, abs=1e-3)
