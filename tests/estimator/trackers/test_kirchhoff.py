"""The default tracker: order of arrival, and what it says of nodes."""

import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.imu import Imu
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.rssi import Rssi
from estimator.trackers.base import TrackerSettings
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.walks import two_responders

WALK = two_responders(50)


def folded(*batches: list[AnyReading], lag_s: float = 60.0) -> KirchhoffTracker:
    tracker = KirchhoffTracker(TrackerSettings(lag_s=lag_s))
    for batch in batches:
        tracker.fold(batch)
    return tracker


def estimate(tracker: KirchhoffTracker, node: str) -> NodeEstimate:
    return next(e for e in tracker.estimates() if e.node == node)


IN_ORDER = folded(WALK).estimates()


@settings(max_examples=6, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 12))
def test_readings_in_any_order_and_any_batches_inside_the_lag_give_the_same_estimates(
    seed: int, batches: int
) -> None:
    chance = random.Random(seed)
    shuffled = WALK[:]
    chance.shuffle(shuffled)
    cuts = sorted(chance.randrange(len(shuffled)) for _ in range(batches))
    tracker = KirchhoffTracker()
    for start, end in zip([0, *cuts], [*cuts, len(shuffled)], strict=True):
        tracker.fold(shuffled[start:end])
        if chance.random() < 0.5:
            tracker.estimates()
    by_name = {e.node: e for e in (tracker.settled() or tracker).estimates()}
    assert by_name == {e.node: e for e in IN_ORDER}


def test_one_node_whose_readings_are_always_late_changes_nothing_in_the_end() -> None:
    late = [(r.t + (1.3 if getattr(r, "node", getattr(r, "a", "")) == "ff1" else 0.0), r) for r in WALK]
    tracker = KirchhoffTracker()
    for _, reading in sorted(late, key=lambda item: item[0]):
        tracker.fold([reading])
        tracker.estimates()
    assert tracker.estimates() == IN_ORDER


def test_readings_beyond_the_lag_are_counted_and_noticed_but_not_fused() -> None:
    tracker = folded(WALK, lag_s=5.0)
    before = tracker.estimates()
    tracker.take_notices()
    tracker.fold([Range(t=1.0, a="ff1", b="anchor", range_m=50.0)])
    assert tracker.estimates() == before
    assert tracker.counts()["too_late"] == 1
    assert [n.code for n in tracker.take_notices()] == ["too_late"]


def test_the_walk_ends_where_it_ended_and_the_unknown_beacon_is_found() -> None:
    tracker = folded(WALK)
    walker, beacon = estimate(tracker, "ff1"), estimate(tracker, "beacon")
    truth = sum(np.array([np.cos(2 * np.pi * k / 40), np.sin(2 * np.pi * k / 40)]) for k in range(1, 51))
    assert walker.position_m is not None
    assert beacon.position_m is not None
    assert np.hypot(*(np.array(walker.position_m[:2]) - truth)) < 0.7
    assert np.hypot(beacon.position_m[0] + 5.0, beacon.position_m[1] - 12.0) < 1.0
    assert estimate(tracker, "b10").retired


def test_a_range_only_node_stays_undecided_while_its_mirror_image_fits_as_well() -> None:
    straight: list[AnyReading] = [
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1),
        Node(t=0.0, node="beacon", role="beacon"),
    ]
    for k in range(1, 31):
        straight.append(Displacement(t=float(k), node="ff1", delta_m=(1.0, 0.0, 0.0)))
        straight.append(Range(t=float(k), a="ff1", b="beacon", range_m=float(np.hypot(k - 15.0, 8.0))))
    tracker = folded(straight)
    assert estimate(tracker, "beacon").position_m is None
    turned: list[AnyReading] = []
    for k in range(1, 21):
        turned.append(Displacement(t=30.0 + k, node="ff1", delta_m=(0.0, 1.0, 0.0)))
        turned.append(Range(t=30.0 + k, a="ff1", b="beacon", range_m=float(np.hypot(15.0, k - 8.0))))
    tracker.fold(turned)
    found = estimate(tracker, "beacon").position_m
    assert found is not None
    assert np.hypot(found[0] - 15.0, found[1] - 8.0) < 1.0


def test_standing_still_tells_the_gyro_bias() -> None:
    """A unit that reports turning while it stands has its later displacements turned back."""
    bias = 0.005
    readings: list[AnyReading] = [
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), heading_sigma_rad=0.01)
    ]
    readings += [
        Displacement(t=float(k), node="ff1", delta_m=(0.0, 0.0, 0.0), heading_rad=-bias * k)
        for k in range(1, 61)
    ]
    for k in range(61, 121):
        turn = -bias * (k - 0.5)
        delta = (float(np.cos(turn)), float(np.sin(turn)), 0.0)
        readings.append(Displacement(t=float(k), node="ff1", delta_m=delta, heading_rad=-bias * k))
    found = estimate(folded(readings), "ff1").position_m
    assert found is not None
    assert np.hypot(found[0] - 60.0, found[1]) < 2.0


def test_a_responder_nobody_placed_enters_at_the_base() -> None:
    tracker = folded(
        [
            Node(t=0.0, node="base", role="base", position_m=(5.0, 5.0, 0.0)),
            Displacement(t=1.0, node="ff1", delta_m=(1.0, 0.0, 0.0)),
        ]
    )
    found = estimate(tracker, "ff1")
    assert found.position_m == pytest.approx((6.0, 5.0, 0.0), abs=1e-6)
    assert found.covariance_m2 is not None
    assert found.covariance_m2[0] == pytest.approx(9.0, rel=0.05)


def test_two_responders_that_range_each_other_are_relatively_better_known_than_each_alone() -> None:
    readings: list[AnyReading] = [
        Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=3.0),
        Node(t=0.0, node="ff2", role="responder", position_m=(3.5, 0.0, 0.0), sigma_m=3.0),
    ]
    for k in range(1, 21):
        readings += [
            Displacement(t=float(k), node="ff1", delta_m=(1.0, 0.0, 0.0)),
            Displacement(t=float(k), node="ff2", delta_m=(1.0, 0.0, 0.0)),
            Range(t=float(k), a="ff1", b="ff2", range_m=3.0, technology="uwb"),
        ]
    tracker = folded(readings)
    between = tracker.relative("ff1", "ff2")
    alone = estimate(tracker, "ff1").covariance_m2
    assert between is not None
    assert alone is not None
    assert between.covariance_m2[0] < 0.2 * alone[0]
    with pytest.raises(KeyError):
        tracker.relative("ff1", "nobody")


def test_a_retired_node_keeps_its_last_estimate() -> None:
    before = folded(WALK[:100])
    after = folded(WALK[:100], [Retire(t=WALK[100].t, node="ff2")])
    there, then = estimate(after, "ff2"), estimate(before, "ff2")
    assert there.retired
    assert there.position_m == pytest.approx(then.position_m, abs=0.5)


def test_when_all_have_left_the_picture_stands_and_nothing_is_said_of_it() -> None:
    entered = Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.3)
    walk = [Displacement(t=float(t), node="ff1", delta_m=(1.0, 0.0, 0.0)) for t in range(1, 31)]
    tracker = folded([Node(t=0.0, node="base", role="base"), entered, *walk, Retire(t=31.0, node="ff1")])
    for t in range(32, 120):
        tracker.fold([Range(t=float(t), a="base", b="beacon", range_m=5.0)])
    assert estimate(tracker, "ff1").position_m == pytest.approx((30.0, 0.0, 0.0), abs=1.0)
    assert [notice.text for notice in tracker.take_notices() if notice.code == "unsolved"] == []


@pytest.mark.parametrize(
    ("reading", "code"),
    [
        (Drop(t=3.0, node="ff2", by="ff1"), "conflict"),
        (Range(t=3.0, a="ff1", b="gone", range_m=3.0), "conflict"),
        (Node(t=3.0, node="ff1", role="beacon"), "conflict"),
        (Displacement(t=3.0, node="anchor", delta_m=(1.0, 0.0, 0.0)), "conflict"),
        (Displacement(t=3.0, node="ff1", delta_m=(90.0, 0.0, 0.0)), "outlier"),
        (Position(t=3.0, node="ff1", wgs84=(47.0, 8.0, 400.0)), "no_origin"),
        (
            Imu(t=3.0, node="ff3", rate_hz=10.0, accel_mps2=[(0.0, 0.0, 9.8)], gyro_radps=[(0.0, 0.0, 0.0)]),
            "not_fused",
        ),
    ],
)
def test_what_cannot_be_true_or_is_not_fused_is_noticed(reading: AnyReading, code: str) -> None:
    tracker = folded(
        [
            Node(t=0.0, node="base", role="base"),
            Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0)),
            Node(t=0.0, node="ff2", role="responder"),
            Node(t=0.0, node="gone", role="beacon", position_m=(1.0, 1.0, 0.0)),
            Node(t=0.0, node="anchor", role="anchor", position_m=(5.0, 1.0, 0.0)),
            Retire(t=1.0, node="gone"),
            Displacement(t=2.0, node="ff1", delta_m=(1.0, 0.0, 0.0)),
            Displacement(t=2.0, node="ff2", delta_m=(1.0, 0.0, 0.0)),
        ]
    )
    assert tracker.take_notices() == []
    tracker.fold([reading])
    tracker.fold([Displacement(t=4.0, node=n, delta_m=(1.0, 0.0, 0.0)) for n in ("ff1", "ff2")])
    assert [n.code for n in tracker.take_notices()] == [code]
    assert tracker.take_notices() == []


def test_who_entered_nobody_knows_where_waits_for_ranges_and_that_is_said() -> None:
    tracker = folded(
        [
            Node(t=0.0, node="ff2", role="responder"),
            Node(t=0.0, node="anchor", role="anchor", position_m=(5.0, 1.0, 0.0)),
            Displacement(t=2.0, node="ff2", delta_m=(1.0, 0.0, 0.0)),
        ]
    )
    assert [(n.code, n.node) for n in tracker.take_notices()] == [("not_fused", "ff2")]
    assert estimate(tracker, "ff2").position_m is None


def test_a_reading_that_names_an_unknown_node_introduces_it() -> None:
    tracker = folded(
        [Rssi(t=0.0, a="x1", b="x2", dbm=-60.0), Displacement(t=0.0, node="x3", delta_m=(1.0, 0.0, 0.0))]
    )
    roles = {e.node: e.role for e in tracker.estimates()}
    assert roles == {"x1": "breadcrumb", "x2": "breadcrumb", "x3": "responder"}


def test_a_claimed_sigma_of_next_to_nothing_is_no_reason_to_fail() -> None:
    tracker = KirchhoffTracker(TrackerSettings())
    tracker.fold([Node(t=0.0, node="base", role="base", position_m=(0.0, 0.0, 0.0))])
    tracker.fold([Node(t=0.0, node="ff1", role="responder", position_m=(3.0, 0.0, 0.0))])
    for second in range(40):
        range_m = 3.0 + 0.3 * (second % 3)
        tracker.fold([Range(t=float(second), a="ff1", b="base", range_m=range_m, sigma_m=5e-324)])
        for estimate in tracker.estimates():
            assert estimate.position_m is not None
            assert np.isfinite(estimate.position_m).all()
