"""Boots that stand: floors are flat, stairs are not, and a slope is not told from either."""

import numpy as np
import pytest

from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.zupt import LEVEL_M
from tests.estimator.inertial.boot_navigation import navigated, total_m
from tests.estimator.inertial.gait import Gait, Stride, walked


def off_along_x(gait: Gait) -> Gait:
    """Felt by an accelerometer that is off along its own axis: each stride seems to rise."""
    return gait._replace(force=gait.force + np.array([0.15, 0.0, 0.0]))


def up_sigma_m(found: list[InertialDisplacement]) -> float:
    return float(np.sqrt(sum((d.sigma_m or 0.0) ** 2 + d.up_m2 for d in found)))


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
