"""From readings to displacements."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import structs
from scipy.spatial.transform import Rotation

from estimator.inertial.dropped_samples import BRIDGED_S
from estimator.inertial.footholds import APART_S, LATEST_S, OVER_S
from estimator.inertial.levelling import ALIGN_S
from estimator.inertial.navigation import navigate
from estimator.inertial.progress import JITTER_MOST_S
from estimator.inertial.record import navigation_of, record_of
from estimator.inertial.samples import PIECE_S, pieces
from estimator.inertial.short_gaps import CROSSED_S
from estimator.inertial.strapdown import ATTITUDE_WALK
from estimator.inertial.zupt import GYRO_SCALE_SIGMA
from estimator.measurements.imu import Imu
from tests.estimator.inertial.boot_navigation import navigated, total_m, total_sigma_m, true_m
from tests.estimator.inertial.gait import AROUND, STEP_S, Stride, rolled, walked

GAIT = walked(AROUND, start_t=50.0).noisy(np.random.default_rng(1))


def test_displacements_follow_each_other_and_lead_along_the_way() -> None:
    found, texts = navigated(GAIT.readings())
    assert texts == []
    assert all(after.from_t == before.t for before, after in pairwise(found))
    assert all(d.from_t is not None and d.t - d.from_t < LATEST_S for d in found)
    assert found[0].from_t == pytest.approx(50.0)
    for upto in range(10, len(found), 7):
        assert np.linalg.norm(total_m(found[:upto]) - true_m(GAIT, found[upto - 1].t)) < 0.3
    assert np.linalg.norm(total_m(found) - GAIT.place_m[-1]) < 0.3


@pytest.mark.parametrize("first", [0, 400])
def test_the_time_in_which_a_boot_is_levelled_is_told_as_well(first: int) -> None:
    """It stands there, or swings."""
    gait = walked([Stride()] * 5, rests_s=2.0)
    (told, *_), _ = navigated([gait.imu(first)])
    assert told.from_t == pytest.approx(first * STEP_S)
    assert told.t == pytest.approx(first * STEP_S + ALIGN_S)
    moved = true_m(gait, told.t) - true_m(gait, told.from_t or 0.0)
    assert told.sigma_m is not None
    assert np.linalg.norm(total_m([told]) - moved) < 2.5 * told.sigma_m
    assert told.sigma_m < 0.02 or first > 0


def test_whoever_goes_down_a_stairwell_is_ever_less_sure_where_he_faces() -> None:
    """Turns the same way are off by what a gyro's scale is; a corner and back by no more than the corner."""
    quarter = 0.5 * np.pi
    well, _ = navigated(walked([Stride(1.0, quarter)] * 40).readings())
    corners, _ = navigated(walked([Stride(1.0, quarter), Stride(1.0, -quarter)] * 20).readings())
    assert sum(d.turned_rad2 for d in well) > (GYRO_SCALE_SIGMA * 40.0 * quarter) ** 2
    assert sum(d.turned_rad2 for d in corners) < 2.0 * ATTITUDE_WALK**2 * corners[-1].t + 1e-4


def test_a_displacement_says_what_its_way_is_unsure_by() -> None:
    """Its sigma, summed up, holds what the ways of twenty units are off."""
    off, told = [], []
    for seed in range(20):
        gait = walked(AROUND).noisy(np.random.default_rng(seed), bias_radps=0.0)
        found, _ = navigated(gait.readings())
        off.append(total_m(found) - true_m(gait, found[-1].t))
        told.append(sum((d.sigma_m or 0.0) ** 2 for d in found))
    nees = np.sum(np.square(off), axis=1) / (3.0 * np.array(told))
    assert 0.02 < np.mean(nees) < 1.0


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(1, 900), min_size=1, max_size=20))
def test_displacements_are_the_same_however_samples_are_cut_into_readings(lengths: list[int]) -> None:
    cuts = np.unique(np.clip(np.cumsum([0, *lengths, len(GAIT.t)]), 0, len(GAIT.t))).tolist()
    found, _ = navigated([GAIT.imu(first, last) for first, last in pairwise(cuts)])
    expected, _ = navigated(GAIT.readings(1000))
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        assert one.t == pytest.approx(other.t, abs=1e-6)
        np.testing.assert_allclose(one.delta_m, other.delta_m, atol=1e-9)


def test_its_heading_is_told_in_the_frame_that_it_began_in() -> None:
    found, _ = navigated(GAIT.readings(), heading_rad=0.4)
    assert found[0].heading_rad == pytest.approx(0.4, abs=0.01)
    assert found[-1].heading_rad == pytest.approx(0.4 + GAIT.heading_rad, abs=0.1)


def test_samples_that_come_twice_count_once() -> None:
    readings = GAIT.readings(100)
    found, texts = navigated([r for reading in readings for r in (reading, reading)])
    assert set(texts) == {"samples of this time were reported before"}
    assert found == navigated(readings)[0]
    overlapping = [GAIT.imu(first, first + 300) for first in range(0, len(GAIT.t), 200)]
    np.testing.assert_allclose(total_m(navigated(overlapping)[0]), total_m(found), atol=0.1)


@pytest.mark.parametrize("each", [10, 20, 200])
@pytest.mark.parametrize("jitter_s", [0.002, 0.01])
def test_epochs_of_a_gateway_that_jitter_cost_no_samples(each: int, jitter_s: float) -> None:
    chance = np.random.default_rng(1)
    late = [structs.replace(r, t=r.t + abs(float(chance.normal(0.0, jitter_s)))) for r in GAIT.readings(each)]
    found, texts = navigated(late)
    assert texts == []
    assert np.linalg.norm(total_m(found) - GAIT.place_m[-1]) < 0.4
    assert found[-1].t == pytest.approx(GAIT.t[-1], abs=APART_S + OVER_S + JITTER_MOST_S)


def test_a_clock_that_runs_fast_is_followed() -> None:
    """Who says 200 a second and sends 201 is half a hundredth ahead after each reading."""
    fast = [structs.replace(r, t=50.0 + (r.t - 50.0) * 200.0 / 201.0) for r in GAIT.readings()]
    found, _ = navigated(fast)
    assert np.linalg.norm(total_m(found) - GAIT.place_m[-1]) < 0.02 * 22.0
    assert found[-1].t == pytest.approx(fast[-1].until_t, abs=APART_S + OVER_S + JITTER_MOST_S)


@pytest.mark.parametrize("lost", [2, 5, 10, 18])
@pytest.mark.parametrize("at", [900, 930, 960])
def test_a_few_lost_samples_are_told_by_what_they_may_have_been(lost: int, at: int) -> None:
    gait = walked([Stride()] * 10)
    found, _ = navigated([gait.imu(0, at), gait.imu(at + lost, None)])
    off_m = np.linalg.norm(total_m(found) - true_m(gait, found[-1].t))
    assert off_m < 3.0 * total_sigma_m(found)
    assert off_m < 0.5


@pytest.mark.parametrize("lost", [24, 60, 400])
def test_after_missing_samples_the_boot_is_sought_again_and_may_have_turned(lost: int) -> None:
    gait = walked([Stride()] * 20)
    assert lost * STEP_S > BRIDGED_S
    known = None
    for piece in pieces(gait.imu(0, 1600)):
        known = navigate(known, piece, 0.0).navigation
    first, *_ = pieces(gait.imu(1600 + lost, None))
    done = navigate(known, first, 0.0)
    assert done.turned_rad2 > (2.0 * lost * STEP_S) ** 2 or done.turned_rad2 > 1.0
    # What a short gap led over is told with what follows it; of a longer one nothing is.
    began_t, ends_t = 1600 * STEP_S, (1600 + lost) * STEP_S
    after = [d for d in done.displacements if d.t > began_t + 1e-6]
    if lost * STEP_S > CROSSED_S:
        assert all((d.from_t or 0.0) >= ends_t - 1e-6 for d in after)
    moved = total_m(after) if after else np.zeros(3)
    begins_t = min((d.from_t or 0.0 for d in after), default=ends_t)
    assert (
        np.linalg.norm(moved - true_m(gait, max(done.navigation.told_t, ends_t)) + true_m(gait, begins_t))
        < 0.05
    )
    assert known is not None
    assert done.navigation.told_t >= (1600 + lost) * STEP_S - 1e-6


def test_nothing_is_made_up_for_missing_samples() -> None:
    gait = walked([Stride()] * 20)
    found, _ = navigated([gait.imu(0, 1600), gait.imu(2400, None)])
    gap = next(i for i, (a, b) in enumerate(pairwise(found)) if b.from_t != a.t)
    assert found[gap].t <= 1600 * STEP_S + 1e-6
    assert found[gap + 1].from_t == pytest.approx(2400 * STEP_S)
    missed = true_m(gait, found[gap + 1].from_t or 0.0) - true_m(gait, found[gap].t)
    assert np.linalg.norm(total_m(found) + missed - gait.place_m[-1]) < 0.5


@pytest.mark.parametrize(("each", "lost"), [(10, 0.1), (10, 0.2), (20, 0.1)])
def test_what_a_bad_link_leaves_of_a_walk_says_how_unsure_it_is(each: int, lost: float) -> None:
    """Beside the ways in the gaps, of which nothing is told."""
    chance, nees = np.random.default_rng(0), []
    for seed in range(6):
        gait = walked([Stride()] * 20).noisy(np.random.default_rng(seed))
        found, _ = navigated([r for r in gait.readings(each) if r.t < 2.0 or chance.random() > lost])
        told = sum(true_m(gait, d.t) - true_m(gait, d.from_t or 0.0) for d in found)
        nees.append(float(np.sum((total_m(found) - told) ** 2)) / (3.0 * total_sigma_m(found) ** 2))
    assert 0.1 < np.mean(nees) < 1.6


@pytest.mark.parametrize("each", [100, 150, 200])
@pytest.mark.parametrize("seed", [700, 701])
def test_where_every_second_reading_is_lost_the_others_are_told_whole(each: int, seed: int) -> None:
    """Up to half a second: what comes in it before the boot stands is read backwards from there."""
    gait = walked(AROUND * 2).noisy(np.random.default_rng(seed))
    readings = gait.readings(each)
    heard = [r for i, r in enumerate(readings) if r.t < 2.0 or i % 2 == 0]
    found, _ = navigated(heard)
    told_s = sum(d.t - (d.from_t or 0.0) for d in found)
    assert told_s > (0.55 if each == 100 else 0.8) * sum(r.until_t - r.t for r in heard)
    lengths = [
        np.linalg.norm(d.delta_m[:2])
        - np.linalg.norm((true_m(gait, d.t) - true_m(gait, d.from_t or 0.0))[:2])
        for d in found
    ]
    assert max(abs(off_m) for off_m in lengths) < 0.15


@pytest.mark.parametrize("angle_rad", [-1.4, -1.5, 1.4, 1.65])
@pytest.mark.parametrize("lost", [1580, 1640, 1700, 1750])
def test_a_unit_whose_x_axis_points_up_goes_on_where_it_went(angle_rad: float, lost: int) -> None:
    gait = walked([Stride()] * 20, mounted=Rotation.from_rotvec([0.0, angle_rad, 0.0]))
    found, _ = navigated([gait.imu(0, lost), gait.imu(lost + 100, None)])
    before = np.array([d.delta_m for d in found if d.t < lost * STEP_S]).sum(axis=0)
    after = np.array([d.delta_m for d in found if (d.from_t or 0.0) > lost * STEP_S + 1.0]).sum(axis=0)
    assert np.dot(before, after) > 0.95 * np.linalg.norm(before) * np.linalg.norm(after)


@pytest.mark.parametrize("scale", [0.0, 1.0 / 9.80665])
def test_a_unit_that_feels_no_gravity_tells_nothing_and_says_so(scale: float) -> None:
    found, texts = navigated(GAIT._replace(force=scale * GAIT.force).readings())
    assert found == []
    assert "no gravity" in texts[0]


@pytest.mark.parametrize("each", [10, 77, 400])
def test_who_runs_is_followed_however_his_samples_are_cut(each: int) -> None:
    gait = walked([Stride(length_m=2.6)] * 20)
    found, texts = navigated(gait.readings(each))
    assert texts == []
    assert np.linalg.norm(total_m(found)[:2] - gait.place_m[-1][:2]) < 0.05 * 52.0


@pytest.mark.parametrize("above_m", [0.07, 0.1, 0.13])
def test_strides_of_a_boot_that_rolls_from_heel_to_ball_are_not_taken_for_shorter(above_m: float) -> None:
    gait = rolled(20, above_m)
    found, _ = navigated(gait.readings())
    assert total_m(found)[0] == pytest.approx(gait.place_m[-1][0], rel=0.006)


def test_long_readings_are_folded_in_pieces_of_half_a_second() -> None:
    whole = GAIT.imu(0, 2100)
    cut = list(pieces(whole))
    assert [p.last for p in cut] == [False] * (len(cut) - 1) + [True]
    assert all(p.until_t - p.t <= PIECE_S + 1e-9 for p in cut)
    assert all(after.t == pytest.approx(before.until_t) for before, after in pairwise(cut))
    assert np.array_equal(np.vstack([p.array for p in cut])[:, :3], np.array(whole.accel_mps2))


def test_too_few_samples_a_second_are_refused() -> None:
    slow = Imu(t=1.0, node="ff1", rate_hz=10.0, accel_mps2=[(0.0, 0.0, 9.8)], gyro_radps=[(0.0, 0.0, 0.0)])
    found, texts = navigated([slow])
    assert found == []
    assert "10 samples a second" in texts[0]
    assert slow.until_t == 1.0


def test_samples_that_lead_nowhere_are_told_and_navigation_goes_on_afterwards() -> None:
    falls = Imu(
        t=53.0,
        node="ff1",
        rate_hz=200.0,
        accel_mps2=[(300.0, 0.0, 0.0)] * 200,
        gyro_radps=[(900.0, 0.0, 0.0)] * 200,
    )
    rests = walked([], start_t=54.0).noisy(np.random.default_rng(2))
    found, texts = navigated([GAIT.imu(0, 600), falls, *rests.readings()])
    assert any("levelled anew" in text for text in texts)
    assert np.isfinite([d.delta_m for d in found]).all()
    assert np.linalg.norm(found[-1].delta_m) < 0.01


def test_a_navigation_is_the_same_after_being_written_down() -> None:
    before = None
    for piece in pieces(GAIT.imu(0, 1000)):
        before = navigate(before, piece, 0.0).navigation
    assert before is not None
    after = navigation_of(record_of(before))
    more = next(pieces(GAIT.imu(1000, 2000)))
    assert navigate(after, more, 0.0).displacements == navigate(before, more, 0.0).displacements


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1e2, 1e4, 1e8]), st.sampled_from([1.0, 1e2, 1e4]))
def test_whatever_samples_say_displacements_are_numbers(seed: int, force: float, rate: float) -> None:
    """A unit that is broken, between two walks: nothing is told that is no number, and navigation goes on."""
    chance = np.random.default_rng(seed)
    broken = walked([], rests_s=1.0)
    noise = chance.normal(0.0, 1.0, (2, *broken.force.shape)) * (chance.random((2, 1, 1)) < 0.7)
    broken = broken._replace(force=broken.force + force * noise[0], rate=broken.rate + rate * noise[1])
    walks = [walked([Stride()] * 2, start_t=t) for t in (0.0, 12.0)]
    middle = broken._replace(t=walks[0].t[-1] + STEP_S + broken.t)
    found, _ = navigated([*walks[0].readings(), *middle.readings(), *walks[1].readings()])
    assert np.isfinite([[*d.delta_m, d.sigma_m or 0.0, d.up_m2, d.heading_rad or 0.0] for d in found]).all()
    assert np.linalg.norm(found[-1].delta_m) < 0.05
