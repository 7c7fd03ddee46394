"""Firefighters whose boots send raw samples, followed as those with any PDR unit."""

import math

import numpy as np
import pytest
from msgspec import structs

from estimator.estimate import NodeEstimate
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude
from estimator.measurements.imu import Imu
from estimator.measurements.node import Node
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from tests.estimator.ellipses import INSIDE, SURE, outside
from tests.estimator.inertial.boot_motion import BootMotion
from tests.estimator.inertial.gait import AROUND, STEP_S, Gait, Stride, walked

START_T = 1000.0
GAIT = walked(AROUND, START_T, heading_rad=0.7).noisy(np.random.default_rng(3))
BEGINS = Node(
    t=START_T, node="ff1", role="responder", position_m=(5.0, -3.0, 0.0), sigma_m=0.1, heading_rad=0.7
)


def incident(gait: Gait = GAIT, each: int = 200) -> list[AnyReading]:
    return [BEGINS, *gait.readings(each)]


def truth_m(gait: Gait, t: float) -> np.ndarray:
    there = [np.interp(t, gait.t + STEP_S, gait.place_m[:, axis]) for axis in range(3)]
    return np.asarray(np.array(there) + np.array([5.0, -3.0, 0.0]))


def shown(tracker: KirchhoffTracker) -> NodeEstimate:
    return next(e for e in tracker.estimates() if e.node == "ff1")


def test_he_is_shown_where_he_is_all_the_time() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([BEGINS])
    for reading in GAIT.readings():
        tracker.fold([reading])
        estimate = shown(tracker)
        assert estimate.position_m is not None
        assert np.linalg.norm(np.array(estimate.position_m) - truth_m(GAIT, estimate.t)) < 0.5
        assert reading.until_t - estimate.t < 1.0
    assert estimate.heading_rad == pytest.approx(GAIT.heading_rad, abs=0.1)
    assert estimate.position_m is not None
    assert estimate.position_m[2] == pytest.approx(1.02, abs=0.2)


def test_a_reading_counts_once_however_many_displacements_it_makes() -> None:
    tracker = KirchhoffTracker()
    readings = incident(each=500)
    tracker.fold([*readings, readings[3]])
    counts = tracker.counts()
    assert counts["received"] == len(readings) + 1
    assert counts["fused"] == len(readings)
    assert counts["not_fused"] == 1


def test_readings_out_of_order_give_the_same() -> None:
    in_order, late = KirchhoffTracker(), KirchhoffTracker()
    in_order.fold(incident())
    readings = incident()
    late.fold([*readings[:5], *readings[9:15]])
    late.estimates()
    late.fold([*readings[15:], *readings[5:9]])
    assert late.estimates() == in_order.estimates()


@pytest.mark.parametrize("cut", [1, 4, 12])
def test_a_tracker_restored_in_the_middle_of_a_stride_goes_on_to_the_last_bit(cut: int) -> None:
    readings = incident(each=130)
    whole = KirchhoffTracker()
    whole.fold(readings[:cut])
    restored = KirchhoffTracker.restore(whole.snapshot())
    for tracker in (whole, restored):
        tracker.fold(readings[cut:])
    assert restored.estimates() == whole.estimates()


def test_the_smoothed_view_follows_him_too() -> None:
    track = BatchSmoother(TrackerSettings()).smooth(incident())["ff1"]
    assert track[-1].t > GAIT.t[-1] - 1.0
    for point in track:
        assert np.linalg.norm(np.array(point.position_m) - truth_m(GAIT, point.t)) < 0.6


def heard(gait: Gait, place_m: tuple[float, float, float], sigma_m: float, each_s: float) -> list[AnyReading]:
    """Ranges to one radio all the time."""
    chance = np.random.default_rng(5)
    return [
        Range(
            t=t,
            a="ff1",
            b="a1",
            range_m=abs(float(np.linalg.norm(truth_m(gait, t) - place_m) + chance.normal(0.0, 0.1))),
            technology="uwb",
            sigma_m=sigma_m,
        )
        for t in np.arange(START_T + each_s, gait.t[-1], each_s).tolist()
    ]


ANCHOR = Node(t=START_T, node="a1", role="anchor", position_m=(0.0, 10.0, 1.0), sigma_m=0.05)


@pytest.mark.parametrize("heard_each_s", [None, 0.25, 0.5])
def test_while_samples_are_missing_he_may_have_turned(heard_each_s: float | None) -> None:
    """Also where somebody is heard meanwhile, at the very epoch at which samples come again."""
    gait = walked([Stride()] * 20, START_T, heading_rad=0.7)
    tracker = KirchhoffTracker()
    more = [] if heard_each_s is None else [ANCHOR, *heard(gait, (0.0, 10.0, 1.0), 5.0, heard_each_s)]
    tracker.fold([BEGINS, *(r for r in more if r.t <= START_T + 6.0), gait.imu(0, 1200)])
    sure = shown(tracker)
    tracker.fold([r for r in more if START_T + 6.0 < r.t <= START_T + 13.0])
    tracker.fold([gait.imu(1600, 2600), Altitude(t=START_T + 8.5, node="ff1", up_m=0.0)])
    unsure = shown(tracker)
    assert sure.heading_sigma_rad is not None
    assert unsure.heading_sigma_rad is not None
    # What is heard afterwards tells some of it again.
    assert sure.heading_sigma_rad < 0.2 < (0.5 if heard_each_s is None else 0.25) < unsure.heading_sigma_rad
    assert outside(unsure.position_m, unsure.covariance_m2, truth_m(gait, unsure.t)) < INSIDE


@pytest.mark.parametrize("each", [10, 200, 1000, 2200])
def test_radios_are_heard_beside_readings_of_any_length(each: int) -> None:
    """A reading of ten seconds comes after all that was heard meanwhile."""
    ranges = heard(GAIT, (0.0, 10.0, 1.0), 0.1, 0.5)
    tracker = KirchhoffTracker()
    tracker.fold([ANCHOR, *incident(each=each), *ranges])
    estimate = shown(tracker)
    assert estimate.position_m is not None
    assert np.linalg.norm(np.array(estimate.position_m) - truth_m(GAIT, estimate.t)) < 0.3
    assert tracker.counts()["not_fused"] == 0
    for point in BatchSmoother(TrackerSettings()).smooth([ANCHOR, *incident(each=each), *ranges])["ff1"]:
        assert np.linalg.norm(np.array(point.position_m) - truth_m(GAIT, point.t)) < 0.6


def test_a_heading_that_is_told_after_the_first_samples_turns_his_way() -> None:
    gait = walked([Stride()] * 10, START_T, heading_rad=0.7)
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=START_T, node="base", role="base", position_m=(5.0, -3.0, 0.0))])
    readings = gait.readings(100)
    tracker.fold([readings[0], structs.replace(BEGINS, t=START_T + 0.4), *readings[1:]])
    estimate = shown(tracker)
    assert estimate.position_m is not None
    assert np.linalg.norm(np.array(estimate.position_m) - truth_m(gait, estimate.t)) < 0.5


def test_who_turns_to_the_east_at_once_has_not_begun_there() -> None:
    begins = structs.replace(BEGINS, heading_rad=1.5)
    gait = walked([Stride(turn_rad=-1.5), *[Stride()] * 10], START_T, heading_rad=1.5, rests_s=0.6)
    tracker = KirchhoffTracker()
    tracker.fold([begins, *gait.readings()])
    estimate = shown(tracker)
    assert estimate.position_m is not None
    assert np.linalg.norm(np.array(estimate.position_m) - truth_m(gait, estimate.t)) < 0.7


def test_radios_that_hear_a_boot_tell_what_it_faced() -> None:
    """Three known radios, and a unit that may face anything at first."""
    places = {"a1": (0.0, 10.0, 1.0), "a2": (20.0, -5.0, 1.0), "a3": (10.0, 15.0, 1.0)}
    chance = np.random.default_rng(5)
    radios = [Node(t=START_T, node=n, role="anchor", position_m=p, sigma_m=0.05) for n, p in places.items()]
    ranges = [
        Range(
            t=t,
            a="ff1",
            b=name,
            range_m=float(np.linalg.norm(truth_m(GAIT, t) - place) + chance.normal(0.0, 0.1)),
            technology="uwb",
            sigma_m=0.1,
        )
        for t in np.arange(START_T + 0.3, GAIT.t[-1], 0.5).tolist()
        for name, place in places.items()
    ]
    unknown = Node(
        t=START_T,
        node="ff1",
        role="responder",
        position_m=(5.0, -3.0, 0.0),
        sigma_m=0.1,
        heading_sigma_rad=3.0,
    )
    tracker = KirchhoffTracker()
    tracker.fold([unknown, *radios, *ranges, *GAIT.readings()])
    estimate = shown(tracker)
    assert estimate.position_m is not None
    assert np.linalg.norm(np.array(estimate.position_m) - truth_m(GAIT, estimate.t)) < 0.3
    assert estimate.heading_sigma_rad is not None
    assert estimate.heading_sigma_rad < 0.1
    assert math.cos((estimate.heading_rad or 0.0) - GAIT.heading_rad) > math.cos(0.1)


@pytest.mark.parametrize("role", ["base", "breadcrumb"])
def test_samples_of_what_does_not_walk_are_set_aside(role: str) -> None:
    tracker = KirchhoffTracker()
    tracker.fold([Node(t=START_T, node="ff1", role=role), *GAIT.readings()])  # type: ignore[arg-type]
    assert tracker.counts()["not_fused"] == len(GAIT.readings())
    assert [n.code for n in tracker.take_notices()] == ["conflict"]


def test_who_has_retired_walks_no_more() -> None:
    tracker = KirchhoffTracker()
    tracker.fold([BEGINS, *GAIT.readings()[:10], Retire(t=START_T + 12.0, node="ff1")])
    before = shown(tracker).position_m
    tracker.fold(GAIT.readings()[12:])
    assert shown(tracker).position_m == before


def test_a_unit_too_slow_to_be_followed_says_so_once() -> None:
    slow = [
        Imu(
            t=float(t),
            node="ff1",
            rate_hz=5.0,
            accel_mps2=[(0.0, 0.0, 9.8)] * 5,
            gyro_radps=[(0.0, 0.0, 0.0)] * 5,
        )
        for t in range(1000, 1010)
    ]
    tracker = KirchhoffTracker()
    tracker.fold([BEGINS, *slow])
    notices = tracker.take_notices()
    assert [n.code for n in notices] == ["not_fused"]
    assert "5 samples a second" in notices[0].text


def test_who_walks_down_a_gentle_slope_is_not_said_to_be_on_its_top_for_certain() -> None:
    """His floors are taken for flat, and his storey is as open as his height."""
    gait = walked([Stride(1.3, 0.0, -0.03)] * 60, START_T)
    down, along = KirchhoffTracker(), KirchhoffTracker()
    down.fold(incident(gait))
    along.fold(incident(walked([Stride(1.3)] * 60, START_T)))
    estimate, level = shown(down), shown(along)
    assert estimate.position_m is not None
    assert estimate.covariance_m2 is not None
    assert level.covariance_m2 is not None
    off_m = estimate.position_m[2] - truth_m(gait, estimate.t)[2]
    assert off_m > 1.0
    assert off_m < 1.5 * math.sqrt(estimate.covariance_m2[5])
    assert level.covariance_m2[5] < 0.5**2
    assert estimate.covariance_m2[0] < 1.1 * level.covariance_m2[0]


FACES_EAST = structs.replace(BEGINS, heading_rad=0.0)
ABOUT_HERE = structs.replace(FACES_EAST, sigma_m=1.0)


def later(gait: Gait) -> Gait:
    return gait._replace(t=START_T + gait.t)


@pytest.mark.parametrize("bias_radps", [-0.04, 0.04])
@pytest.mark.parametrize("radios", [False, True])
def test_who_walks_when_his_unit_is_switched_on_is_where_his_ellipse_says(
    bias_radps: float, radios: bool
) -> None:
    """Nothing has told the biases of its gyros until he rests; then they are others than ranges had told."""
    gait = later(BootMotion().walks(20).rests(3.0).walks(20).gait())
    gait = gait._replace(rate=gait.rate + bias_radps)
    far_m = (60.0, 10.0, 1.0)
    far = structs.replace(ANCHOR, node="a2", position_m=far_m)
    near = heard(gait, (0.0, 10.0, 1.0), 0.1, 0.5)
    more = [ANCHOR, far, *near, *(structs.replace(r, b="a2") for r in heard(gait, far_m, 0.1, 0.5))]
    more = more if radios else []
    tracker = KirchhoffTracker()
    tracker.fold([ABOUT_HERE, *more[:2]])
    off = []
    for reading in gait.readings():
        until_t = reading.until_t
        tracker.fold([reading, *(r for r in more[2:] if until_t - 1.0 < r.t <= until_t)])
        estimate = shown(tracker)
        off.append(outside(estimate.position_m, estimate.covariance_m2, truth_m(gait, estimate.t)))
    # Of thirty pictures one may be farther off than its ellipse of 95 %.
    assert max(off) < SURE
    assert np.median(off) < INSIDE


def test_who_crawls_is_shown_where_he_is_all_the_time() -> None:
    gait = later(BootMotion().rests(2.0).walks(4).kneels().crawls(30, 0.4, 0.7, 0.5, 0.02).rests(1.0).gait())
    tracker = KirchhoffTracker()
    tracker.fold([FACES_EAST])
    for reading in gait.noisy(np.random.default_rng(4)).readings():
        tracker.fold([reading])
        estimate = shown(tracker)
        assert estimate.position_m is not None
        assert np.linalg.norm(np.array(estimate.position_m) - truth_m(gait, estimate.t)) < 1.0
