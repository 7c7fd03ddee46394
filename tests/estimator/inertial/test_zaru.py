"""What rests tell of gyros."""

import math

import numpy as np
import pytest

from estimator.inertial.boot import BIAS_RADPS, Boot
from estimator.inertial.footholds import OVER_S
from estimator.inertial.zaru import (
    ANEW_RAD2PS2,
    RESTED_RADPS,
    SETTLES_RADPS,
    TOLD_AFTER_S,
    UNRESTED_RADPS,
    bias_share,
)
from estimator.inertial.zupt_aided import advance
from tests.estimator.inertial.boot_motion import BootMotion, Unit
from tests.estimator.inertial.boot_navigation import navigated, total_m, true_m
from tests.estimator.inertial.gait import STEP_S, Gait

BIAS = np.array([0.03, -0.04, 0.05])


def biased(gait: Gait) -> Gait:
    return gait._replace(rate=gait.rate + BIAS)


def navigated_boot(gait: Gait) -> Boot:
    boot, done = Boot.new(0.0), 0
    while done < len(gait.force):
        done += advance(boot, gait.force[done:], gait.rate[done:], STEP_S)
    return boot


def test_who_walks_when_his_unit_is_switched_on_has_unknown_biases_until_he_rests() -> None:
    walks = biased(BootMotion().walks(10).gait())
    boot = navigated_boot(walks)
    assert boot.gyros[BIAS_RADPS] == pytest.approx(UNRESTED_RADPS, rel=0.01)
    rests = navigated_boot(biased(BootMotion().walks(10).rests(4.0).gait()))
    np.testing.assert_allclose(rests.held.sensors[6:], BIAS, atol=2e-3)
    assert rests.gyros[BIAS_RADPS] < 1.1 * SETTLES_RADPS


def test_a_bias_that_no_rest_has_told_is_unknown_and_another_one_afterwards() -> None:
    found, _ = navigated(biased(BootMotion().walks(10).rests(3.0).walks(8).gait()).readings())
    assert found[0].bias_rad2ps2 == pytest.approx(UNRESTED_RADPS**2 - RESTED_RADPS**2)
    changed = [d for d in found[1:] if d.bias_rad2ps2 > 0.0]
    assert [d.bias_rad2ps2 for d in changed] == [ANEW_RAD2PS2]
    assert 11.0 + 2.0 - OVER_S <= changed[0].t <= 11.0 + 3.5
    rested = [d for d in found if d.rested_radps > 0.0]
    assert len(rested) == 1
    assert TOLD_AFTER_S - 0.5 <= rested[0].t - changed[0].t <= TOLD_AFTER_S + 1.0


@pytest.mark.parametrize("bias_radps", [0.0, 0.05])
def test_a_first_rest_that_ends_too_soon_says_so_and_is_believed_of_bad_units_only(bias_radps: float) -> None:
    """The boot begins to turn in its last fifth of a second."""
    gait = BootMotion().rests(0.3).turns(0.3, 2.0).rests(1.0).gait()
    boot = navigated_boot(gait._replace(rate=gait.rate + bias_radps)._replace(force=gait.force[:101]))
    off_radps = np.linalg.norm(boot.held.sensors[6:] - bias_radps)
    assert boot.gyros[BIAS_RADPS] > 2.0 * RESTED_RADPS
    assert off_radps < 2.0 * np.sqrt(3.0) * boot.gyros[BIAS_RADPS]


def test_of_trembling_rates_little_is_bias_and_of_steady_ones_all() -> None:
    turning = np.array([0.0, 0.005, 0.018])
    trembling, left2 = bias_share(turning, 0.02**2)
    assert trembling < 0.3
    assert 0.005 < math.sqrt(left2) < 0.012
    assert bias_share(turning, 0.0) == pytest.approx((1.0, 0.0))
    assert bias_share(np.full(3, 0.05), 0.02**2)[0] > 0.7


def test_what_a_rest_has_told_already_is_nothing_new() -> None:
    found, _ = navigated(biased(BootMotion().rests(3.0).walks(5).rests(5.0).walks(5).gait()).readings())
    assert not any(d.rested_radps > 0.0 or d.bias_rad2ps2 > 0.0 for d in found)


def test_after_the_rest_his_ways_are_straight() -> None:
    gait = BootMotion().walks(4).rests(9.0).walks(30).gait()
    found, _ = navigated(biased(gait).readings())
    after = [d for d in found if (d.from_t or 0.0) > 13.0]
    told, true = total_m(after), true_m(gait, after[-1].t) - true_m(gait, after[0].from_t or 0.0)
    assert np.linalg.norm(told) == pytest.approx(np.linalg.norm(true), rel=0.02)


def test_a_boot_that_is_levelled_anew_keeps_what_its_rests_have_told() -> None:
    boot = navigated_boot(biased(BootMotion().rests(3.0).walks(3).gait())).to_level_again()
    np.testing.assert_allclose(boot.held.sensors[6:], BIAS, atol=2e-3)
    assert boot.gyros[BIAS_RADPS] < 1.1 * RESTED_RADPS


@pytest.mark.parametrize(("angle_rad", "duration_s"), [(0.1, 3.0), (0.35, 6.0), (1.57, 30.0)])
def test_a_slow_turn_on_the_spot_is_no_bias(angle_rad: float, duration_s: float) -> None:
    """Who turns as slowly as a gyro drifts is taken at his gyros' word, once their biases are known."""
    gait = (
        BootMotion().rests(2.0).walks(2).rests(1.0).turns(angle_rad, duration_s).rests(1.0).walks(30).gait()
    )
    found, _ = navigated(Unit(1).feels(gait).readings())
    assert found[-1].heading_rad == pytest.approx(angle_rad, abs=0.08)
    off_m = total_m(found) - true_m(gait, found[-1].t) + true_m(gait, found[0].from_t or 0.0)
    assert np.linalg.norm(off_m) < 0.05 * 32 * 1.3
