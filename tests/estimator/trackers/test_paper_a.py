"""What paper A's system does with readings."""

import pytest

from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.bearing import Bearing
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.imu import Imu
from estimator.measurements.node import Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.status import Status
from estimator.trackers.base import TrackerSettings
from estimator.trackers.paper_a import PaperATracker
from tests.estimator.inertial.gait import Stride, walked
from tests.estimator.paper_a.folding import estimate, folded, place

START: list[AnyReading] = [
    Node(t=0.0, node="base", role="base"),
    Node(t=0.0, node="ff1", role="responder", position_m=(0.0, 0.0, 0.0), sigma_m=0.1),
]


def step(t: float, *, node: str = "ff1", east: float = 1.0, since: float | None = None) -> Displacement:
    return Displacement(t=t, node=node, delta_m=(east, 0.0, 0.0), from_t=since)


def test_a_firefighter_moves_by_his_displacements_and_drops_breadcrumbs_where_he_stands() -> None:
    tracker = folded([*START, step(1.0), step(2.0), Drop(t=2.0, node="b1", by="ff1"), step(3.0)])
    assert place(tracker, "ff1") == pytest.approx([3.0, 0.0, 0.0])
    assert place(tracker, "b1") == pytest.approx([2.0, 0.0, 0.0])
    assert estimate(tracker, "ff1").speed_mps == pytest.approx(1.0)
    assert estimate(tracker, "ff1").heading_rad is None


def test_a_firefighter_of_unknown_beginning_enters_at_the_base() -> None:
    tracker = folded(
        [Node(t=0.0, node="base", role="base", position_m=(5.0, 5.0, 0.0)), step(1.0, since=0.0)]
    )
    assert place(tracker, "ff1") == pytest.approx([6.0, 5.0, 0.0])


def test_a_beacon_that_only_ranges_tell_of_stays_undecided() -> None:
    ranges = [Range(t=float(t), a="ff1", b="beacon", range_m=10.0) for t in range(1, 30)]
    tracker = folded([*START, Node(t=0.0, node="beacon", role="beacon"), *map(step, range(1, 30)), *ranges])
    beacon = estimate(tracker, "beacon")
    assert beacon.position_m is None
    assert beacon.covariance_m2 is None
    assert tracker.relative("ff1", "beacon") is None
    assert tracker.counts()["not_fused"] == len(ranges)
    assert len(tracker.take_notices()) == 1


def test_readings_that_the_paper_has_no_place_for_are_counted_as_not_fused() -> None:
    tracker = folded(START)
    before = place(tracker, "ff1").tolist()
    foreign: list[AnyReading] = [
        Imu(t=1.0, node="ff1", rate_hz=10.0, accel_mps2=[(0.0, 0.0, 9.8)], gyro_radps=[(0.0, 0.0, 0.0)]),
        Bearing(t=1.0, a="ff1", b="base", bearing_rad=1.0),
        Altitude(t=1.0, node="ff1", up_m=7.0),
        Status(t=1.0, node="ff1", battery=0.5),
    ]
    tracker.fold(foreign)
    tracker.fold(foreign)
    assert tracker.counts()["not_fused"] == 8
    assert place(tracker, "ff1").tolist() == before
    assert [n.code for n in tracker.take_notices()] == ["not_fused"] * 3


def test_a_boot_that_sends_raw_samples_is_followed_as_a_pdr_unit() -> None:
    gait = walked([Stride()] * 10, start_t=1.0)
    tracker = folded(START)
    before = place(tracker, "ff1")
    tracker.fold([*gait.readings()])
    assert place(tracker, "ff1") - before == pytest.approx(gait.place_m[-1], abs=0.3)
    assert tracker.counts()["fused"] >= len(gait.readings())
    restored = PaperATracker.restore(tracker.snapshot())
    after = walked([Stride()] * 3, start_t=gait.readings()[-1].until_t).readings()
    for one in (tracker, restored):
        one.fold([*after])
    assert restored.estimates() == tracker.estimates()


def test_a_displacement_faster_than_5_m_a_second_is_dropped_and_said() -> None:
    tracker = folded([*START, step(1.0), step(2.0, east=5.5)])
    assert place(tracker, "ff1")[0] == pytest.approx(1.0)
    assert tracker.counts()["outlier"] == 1
    assert [n.code for n in tracker.take_notices()] == ["outlier"]


def test_a_reading_older_than_its_node_s_newest_state_is_too_late() -> None:
    tracker = folded([*START, step(1.0), step(2.0)])
    before = tracker.estimates()
    tracker.fold([step(1.5), Range(t=1.0, a="ff1", b="base", range_m=30.0)])
    assert tracker.estimates() == before
    assert tracker.counts()["too_late"] == 2
    tracker.fold([Range(t=2.0, a="ff1", b="base", range_m=3.0)])
    assert place(tracker, "ff1")[0] > 2.0


def test_a_displacement_that_begins_before_the_last_one_ended_counts_only_for_what_is_new() -> None:
    tracker = folded([*START, step(1.0), step(3.0, east=3.0, since=0.0)])
    assert place(tracker, "ff1")[0] == pytest.approx(1.0 + 2.0)


def test_a_time_without_displacements_makes_a_firefighter_less_certain() -> None:
    known = folded([*START, step(1.0), step(11.0, since=1.0)])
    silent = folded([*START, step(1.0), step(11.0, since=10.0)])
    spread = [estimate(tracker, "ff1").covariance_m2 for tracker in (known, silent)]
    assert spread[0] is not None
    assert spread[1] is not None
    assert spread[1][0] > spread[0][0] + 30.0


def test_a_firefighter_without_a_unit_follows_his_fixes() -> None:
    fixes = [
        Position(t=float(t), node="ff1", position_m=(1.0 * t, 0.0, 0.0), sigma_m=(1.0, 1.0, 1.0))
        for t in range(1, 30)
    ]
    assert place(folded([*START, *fixes]), "ff1") == pytest.approx([29.0, 0.0, 0.0], abs=1.5)


def test_a_retired_node_keeps_its_last_place_and_takes_no_part_any_more() -> None:
    tracker = folded([*START, step(1.0), Drop(t=1.0, node="b1", by="ff1"), Retire(t=2.0, node="b1")])
    retired = estimate(tracker, "b1")
    assert retired.retired
    assert retired.position_m == pytest.approx((1.0, 0.0, 0.0))
    before = place(tracker, "ff1").tolist()
    tracker.fold([Range(t=3.0, a="ff1", b="b1", range_m=50.0)])
    assert place(tracker, "ff1").tolist() == before
    assert estimate(tracker, "b1") == retired


def test_a_fix_in_wgs84_needs_the_origin() -> None:
    fix = Position(t=1.0, node="ff1", wgs84=(47.0, 8.0, 400.0))
    lost = folded([fix])
    assert estimate(lost, "ff1").position_m is None
    assert [n.code for n in lost.take_notices()] == ["no_origin"]
    located = PaperATracker(TrackerSettings(origin_wgs84=(47.0, 8.0, 400.0)))
    located.fold([fix])
    assert place(located, "ff1") == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)


def test_a_breadcrumb_is_known_better_relative_to_its_bearer_than_to_the_base() -> None:
    walk = [step(float(t)) for t in range(1, 41)]
    tracker = folded([*START, *walk, Drop(t=40.0, node="b1", by="ff1")])
    apart, own = tracker.relative("ff1", "b1"), estimate(tracker, "b1").covariance_m2
    assert apart is not None
    assert own is not None
    assert apart.delta_m == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert apart.covariance_m2[0] == pytest.approx(0.09)
    assert own[0] > 1.0
    with pytest.raises(KeyError):
        tracker.relative("ff1", "nobody")
