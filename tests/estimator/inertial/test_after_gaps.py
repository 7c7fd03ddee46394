"""A boot that is found again by its next standstill."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimator.inertial.after_gaps import find_standstill, level_backwards
from estimator.inertial.boot import Boot
from estimator.inertial.rotations import azimuth_rad
from estimator.inertial.zupt_aided import advance
from tests.estimator.inertial.gait import STEP_S, Gait, Stride, walked

MOUNTED = [(0.0, 0.0, 0.0), (0.0, 0.4, 0.0), (0.3, -0.5, 0.4)]


def navigated_boot(gait: Gait, upto: int) -> Boot:
    boot, done = Boot.new(0.0), 0
    while done < upto:
        done += advance(boot, gait.force[done:upto].copy(), gait.rate[done:upto].copy(), STEP_S)
    return boot


def samples(gait: Gait, first: int, last: int) -> np.ndarray:
    return np.ascontiguousarray(np.hstack([gait.force, gait.rate])[first:last])


@pytest.mark.parametrize("mounted_rad", MOUNTED)
@pytest.mark.parametrize("at", [860, 880, 900, 920])
def test_a_swing_read_backwards_begins_as_it_does_read_forwards(
    at: int, mounted_rad: tuple[float, float, float]
) -> None:
    """Held against a navigation that has missed nothing."""
    gait = walked([Stride()] * 10, mounted=Rotation.from_rotvec(mounted_rad))
    whole = navigated_boot(gait, at)
    boot, some = whole.to_level_again(), samples(gait, at, at + 150)
    upto = find_standstill(boot, some, STEP_S)
    assert upto > 0
    boot.known[1] = azimuth_rad(whole.held.attitude, int(whole.known[2])) - whole.known[3]
    assert level_backwards(boot, some, upto, STEP_S)
    np.testing.assert_allclose(boot.held.velocity, whole.held.velocity, atol=0.1)
    np.testing.assert_allclose(boot.held.attitude, whole.held.attitude, atol=0.03)


def test_a_boot_that_swings_all_the_time_is_not_found() -> None:
    gait = walked([Stride()] * 10)
    swing = samples(gait, 400 + 2 * 220 + 10, 400 + 2 * 220 + 90)
    assert find_standstill(navigated_boot(gait, 850).to_level_again(), swing, STEP_S) == 0


def test_the_height_of_the_standstill_counts_from_where_the_swing_was_taken_up() -> None:
    """So that the foothold is as high as the floor, not as the boot in mid air."""
    gait = walked([Stride()] * 10)
    at = 400 + 2 * 220 + 50
    boot, some = navigated_boot(gait, at).to_level_again(), samples(gait, at, at + 150)
    upto = find_standstill(boot, some, STEP_S)
    assert level_backwards(boot, some, upto, STEP_S)
    fallen_m = gait.place_m[at + upto - 10][2] - gait.place_m[at - 1][2]
    assert boot.footing[2] == pytest.approx(fallen_m, abs=0.02)
