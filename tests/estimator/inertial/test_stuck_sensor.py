"""Sensors that are stuck or dead, and those that are only coarse."""

from itertools import pairwise

import numpy as np
import pytest

from estimator.inertial.navigation import navigate
from estimator.inertial.record import navigation_of, record_of
from estimator.inertial.samples import pieces
from estimator.inertial.stuck_sensor import NEVER_S, STUCK_S
from tests.estimator.inertial.boot_motion import BootMotion, Unit
from tests.estimator.inertial.boot_navigation import navigated, total_m, total_sigma_m, true_m
from tests.estimator.inertial.gait import AROUND, STEP_S, Gait, Stride, walked

GAIT = Unit(3, 0.01, 0.1, 0.01).feels(walked(AROUND))
STUCK_AT = 1730
"""In the middle of a swing."""


def held(gait: Gait, first: int, last: int | None, channels: list[int], value: float | None = None) -> Gait:
    """The same, but for channels that keep their values, or tell one value."""
    both = np.hstack([gait.force, gait.rate])
    both[first:last, channels] = both[first, channels] if value is None else value
    return gait._replace(force=both[:, :3], rate=both[:, 3:])


def rounded(gait: Gait, force_mps2: float, rate_radps: float) -> Gait:
    """The same, told by a unit whose steps are as coarse as that."""
    force, rate = np.round(gait.force / force_mps2), np.round(gait.rate / rate_radps)
    return gait._replace(force=force * force_mps2, rate=rate * rate_radps)


@pytest.mark.parametrize("channels", [[0], [1], [2], [3], [4], [5], [3, 4, 5], [0, 1, 2, 3, 4, 5]])
@pytest.mark.parametrize("at", [STUCK_AT, STUCK_AT + 80])
def test_a_sensor_that_is_stuck_tells_nothing_and_says_so(channels: list[int], at: int) -> None:
    found, texts = navigated(held(GAIT, at, None, channels).readings())
    assert found[-1].t <= at * STEP_S + 1e-6
    assert np.linalg.norm(total_m(found) - true_m(GAIT, found[-1].t)) < 0.3
    assert len(set(texts)) == 1
    assert "replace it" in texts[0]
    assert ("gyro z" in texts[0]) == (channels in ([5], [3, 4, 5]))


def test_a_gyro_that_tells_nil_is_stuck_as_well() -> None:
    found, texts = navigated(held(GAIT, STUCK_AT, None, [5], 0.0).readings())
    assert found[-1].t <= STUCK_AT * STEP_S + 1e-6
    assert "gyro z" in texts[0]


def test_a_sensor_that_comes_back_to_life_goes_on_after_a_gap() -> None:
    last = STUCK_AT + 800
    found, _ = navigated(held(GAIT, STUCK_AT, last, [0]).readings())
    gap = next(i for i, (a, b) in enumerate(pairwise(found)) if b.from_t != a.t)
    assert found[gap].t <= STUCK_AT * STEP_S + 1e-6
    assert (found[gap + 1].from_t or 0.0) >= last * STEP_S - 1e-6
    known, turned_rad2 = None, 0.0
    for reading in held(GAIT, STUCK_AT, last, [0]).readings():
        for piece in pieces(reading):
            done = navigate(known, piece, 0.0)
            known, turned_rad2 = done.navigation, turned_rad2 + done.turned_rad2
    assert turned_rad2 > 1.0


@pytest.mark.parametrize("channel", range(6))
def test_a_channel_that_is_dead_from_the_start_is_found_when_the_boot_moves(channel: int) -> None:
    value = 9.8 if channel == 2 else 0.0
    found, texts = navigated(held(GAIT, 0, None, [channel], value).readings())
    assert found[-1].t < 3.5
    assert any("stuck" in text for text in texts)


@pytest.mark.parametrize("channels", [[0, 1, 2], [3, 4, 5]])
def test_a_sensor_that_is_dead_from_the_start_is_found_when_the_boot_moves(channels: list[int]) -> None:
    found, texts = navigated(held(GAIT, 0, None, channels).readings())
    assert found[-1].t < 3.5
    assert "stuck" in texts[0]


def test_a_unit_that_never_tells_anything_else_is_dead() -> None:
    rests = BootMotion().rests(40.0).gait()
    found, texts = navigated(rests.readings())
    assert found[-1].t < NEVER_S + 1.0
    assert "all its channels" in texts[0]


@pytest.mark.parametrize(("force_mps2", "rate_radps"), [(0.3, 0.1), (0.1, 0.1), (0.05, 0.02), (1e-9, 0.05)])
def test_a_boot_with_a_coarse_unit_that_rests_stays_where_it_is(force_mps2: float, rate_radps: float) -> None:
    gait = BootMotion().rests(3.0).walks(6).rests(60.0).gait()
    for seed in range(3):
        coarse = rounded(
            Unit(seed, bias_mps2=0.05 * seed, bias_radps=0.005 * seed).feels(gait), force_mps2, rate_radps
        )
        found, texts = navigated(coarse.readings())
        assert texts == []
        assert found[-1].t > gait.t[-1] - 1.5
        rests = [d for d in found if (d.from_t or 0.0) > 12.0]
        assert total_sigma_m(rests) < 0.5


def test_a_unit_without_noise_may_rest() -> None:
    """As simulated ones do."""
    found, texts = navigated(BootMotion().rests(3.0).walks(6).rests(60.0).walks(6).gait().readings())
    assert texts == []
    assert len(found) > 10
    assert all(after.from_t == before.t for before, after in pairwise(found))


def test_a_link_that_repeats_a_few_samples_makes_no_gap() -> None:
    gait = walked([Stride()] * 10)
    noisy = held(Unit(1).feels(gait), 900, 900 + round(0.8 * STUCK_S / STEP_S), list(range(6)))
    found, texts = navigated(noisy.readings())
    assert texts == []
    assert len(found) > 10
    assert all(after.from_t == before.t for before, after in pairwise(found))


@pytest.mark.parametrize("each", [7, 30, 100, 410])
def test_what_is_missing_is_the_same_however_samples_are_cut_into_readings(each: int) -> None:
    stuck = held(held(GAIT, STUCK_AT, STUCK_AT + 500, [0, 4]), 3000, 3060, list(range(6)))
    found, _ = navigated(stuck.readings(each))
    expected, _ = navigated(stuck.readings(1000))
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        assert one.t == pytest.approx(other.t, abs=1e-6)
        np.testing.assert_allclose(one.delta_m, other.delta_m, atol=1e-9)


@pytest.mark.parametrize("upto", [STUCK_AT + 50, STUCK_AT + 300])
def test_a_navigation_that_waits_is_the_same_after_being_written_down(upto: int) -> None:
    stuck, before = held(GAIT, STUCK_AT, STUCK_AT + 320, [0]), None
    for piece in pieces(stuck.imu(0, upto)):
        before = navigate(before, piece, 0.0).navigation
    assert before is not None
    assert len(before.waiting) > 0 or before.missing > 0
    after = navigation_of(record_of(before))
    told = []
    for begins in (before, after):
        known, goes = begins, list[object]()
        for piece in pieces(stuck.imu(upto, 3000)):
            done = navigate(known, piece, 0.0)
            known, goes = done.navigation, [*goes, *done.displacements, done.turned_rad2]
        told.append(goes)
    assert told[0] == told[1]
