"""Boots that stand: floors are flat, stairs are not, and a slope is not told from either."""

import numpy as np
import pytest

from estimator.inertial.boot import GRAVITY_MPS2, HELD_S, VELOCITY, Boot
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.footholds import HIDDEN_M2PS2, STRIDE_S
from estimator.inertial.zero_velocity import add_sample
from estimator.inertial.zupt import LEVEL_M, SWINGS_MOST_S, apply_zupt
from tests.estimator.inertial.boot_navigation import navigated, total_m
from tests.estimator.inertial.gait import Gait, Stride, walked


def off_along_x(gait: Gait) -> Gait:
    """Felt by an accelerometer that is off along its own axis: each stride seems to rise."""
    return gait._replace(force=gait.force + np.array([0.15, 0.0, 0.0]))


def up_sigma_m(found: list[InertialDisplacement]) -> float:
    return float(np.sqrt(sum((d.sigma_m or 0.0) ** 2 + d.up_m2 for d in found)))


def gliding(speed_mps: float, turns_radps: float, held_s: float, sigma_mps: float = 0.02) -> Boot:
    """A boot whose navigation says how fast it goes and how sure that is, and which feels next to nothing.

    Args:
        speed_mps: how fast.
        turns_radps: how fast it turns.
        held_s: time since a standstill held it.
        sigma_mps: how well its navigation knows its velocity along each axis.
    """
    boot = Boot.new(0.0)
    boot.held.velocity[0] = speed_mps
    boot.footing[HELD_S] = held_s
    for c in range(VELOCITY, VELOCITY + 3):
        boot.held.covariance[c, c] = sigma_mps**2
    for _ in range(100):
        add_sample(boot.stance, np.array([0.0, 0.0, GRAVITY_MPS2]), turning(turns_radps), GRAVITY_MPS2, 0.005)
    return boot


def turning(turns_radps: float) -> np.ndarray:
    return np.array([0.0, 0.0, turns_radps])


def held(boot: Boot, turns_radps: float) -> bool:
    """Whether a sample is taken for a standstill."""
    return bool(np.isfinite(apply_zupt(boot, np.zeros(3), turning(turns_radps), 0.005)))


@pytest.mark.parametrize("speed_mps", [0.5, 0.7, 3.0])
def test_a_boot_that_glides_evenly_through_its_swing_does_not_stand(speed_mps: float) -> None:
    boot = gliding(speed_mps, turns_radps=1.0, held_s=2.0 * STRIDE_S)
    assert not held(boot, 1.0)
    assert boot.held.velocity[0] == speed_mps


@pytest.mark.parametrize(
    ("speed_mps", "turns_radps", "held_s", "sigma_mps"),
    [
        (0.2, 1.0, 2.0 * STRIDE_S, 0.02),  # The end of a swing is off by so much.
        (0.7, 0.1, 2.0 * STRIDE_S, 0.02),  # It hardly turns.
        (0.7, 1.0, 0.5 * STRIDE_S, 0.02),  # It stood just now.
        (0.7, 1.0, 2.0 * STRIDE_S, 0.3),  # Its navigation does not know.
    ],
)
def test_a_navigation_that_is_not_sure_of_a_swing_does_not_undo_a_standstill(
    speed_mps: float, turns_radps: float, held_s: float, sigma_mps: float
) -> None:
    assert held(gliding(speed_mps, turns_radps, held_s, sigma_mps), turns_radps)


def test_a_navigation_that_swings_for_longer_than_anybody_is_doubted() -> None:
    boot = gliding(0.7, turns_radps=1.0, held_s=SWINGS_MOST_S)
    assert held(boot, 1.0)
    assert abs(boot.held.velocity[0]) < 0.1
    assert np.sqrt(boot.footholds[HIDDEN_M2PS2]) > 0.6


def test_floors_are_flat_whatever_an_accelerometer_is_off_by() -> None:
    found, texts = navigated(off_along_x(walked([Stride()] * 40)).readings())
    assert texts == []
    assert abs(total_m(found)[2]) < 0.1
    assert sum(d.up_m2 for d in found) > 0.0


@pytest.mark.parametrize("up_m", [2.0 * LEVEL_M, 0.17, -0.34])
def test_stairs_are_not(up_m: float) -> None:
    gait = walked([*[Stride()] * 4, *[Stride(0.5, 0.0, up_m)] * 10]).noisy(np.random.default_rng(1))
    found, _ = navigated(gait.readings())
    assert total_m(found)[2] == pytest.approx(10.0 * up_m, abs=0.1)


@pytest.mark.parametrize("up_m", [0.013, -0.026, 0.039])
def test_a_slope_that_is_taken_for_a_floor_is_told_as_doubt(up_m: float) -> None:
    gait = walked([Stride(1.3, 0.0, up_m)] * 50)
    found, _ = navigated(gait.readings())
    off_m = total_m(found)[2] - gait.place_m[-1, 2]
    assert abs(off_m) > 0.4
    assert abs(off_m) < 1.5 * up_sigma_m(found)


def test_on_a_flat_floor_a_good_unit_stays_sure_of_its_height() -> None:
    found, _ = navigated(walked([Stride()] * 50).readings())
    assert up_sigma_m(found) < 0.3
