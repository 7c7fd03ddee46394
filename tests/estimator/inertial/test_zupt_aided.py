"""A boot's navigation: where it leads, and how well it knows that."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimator.inertial.boot import Boot
from estimator.inertial.zupt_aided import advance
from tests.estimator.inertial.gait import AROUND, STEP_S, Gait, Stride, walked


def navigated_boot(gait: Gait, heading_rad: float = 0.0) -> Boot:
    boot, done = Boot.new(heading_rad), 0
    while done < len(gait.force):
        done += advance(boot, gait.force[done:], gait.rate[done:], STEP_S)
    return boot


def test_samples_without_errors_lead_along_the_way_and_up_the_stair() -> None:
    gait = walked(AROUND)
    boot = navigated_boot(gait)
    np.testing.assert_allclose(boot.held.place, gait.place_m[-1], atol=0.005 * 22.0)
    assert boot.heading_rad == pytest.approx(gait.heading_rad, abs=0.01)


@pytest.mark.parametrize("seed", range(5))
def test_a_small_unit_is_a_hundredth_of_the_way_off(seed: int) -> None:
    gait = walked(AROUND).noisy(np.random.default_rng(seed))
    boot = navigated_boot(gait)
    assert np.linalg.norm(boot.held.place - gait.place_m[-1]) < 0.015 * 22.0
    assert np.linalg.norm(boot.held.velocity) < 0.02


@pytest.mark.parametrize("angle_rad", [(0.0, 0.5, 0.0), (np.pi, 0.0, 0.0), (0.3, -1.2, 0.4)])
def test_however_the_unit_is_mounted(angle_rad: tuple[float, float, float]) -> None:
    """The frame's x axis is what the sensor's x axis faces at rest, seen from above."""
    mounted = Rotation.from_rotvec(angle_rad)
    faced = mounted.apply([1.0, 0.0, 0.0])
    gait = walked(AROUND, mounted=mounted)
    boot = navigated_boot(gait, heading_rad=float(np.arctan2(faced[1], faced[0])))
    np.testing.assert_allclose(boot.held.place, gait.place_m[-1], atol=0.005 * 22.0)


@pytest.mark.parametrize("times", [1.0, 3.0])
def test_what_gyros_at_rest_tell_is_taken_for_their_bias(times: float) -> None:
    gait, bias = walked([Stride()] * 5), times * np.array([0.01, -0.02, 0.015])
    boot = navigated_boot(gait._replace(rate=gait.rate + bias))
    np.testing.assert_allclose(boot.held.sensors[6:], bias, atol=1e-6)
    np.testing.assert_allclose(boot.held.place, gait.place_m[-1], atol=0.005 * 6.5)
