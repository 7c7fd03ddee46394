"""What rests tell of gyros."""

import numpy as np
import pytest

from estimator.inertial.advancing import advance
from estimator.inertial.boot import BIAS_RADPS, Boot
from estimator.inertial.navigation import Navigation, navigate
from estimator.inertial.resting import GRANTED_RADPS, RESTED_RADPS, UNRESTED_RADPS
from estimator.inertial.samples import pieces
from tests.estimator.inertial.gait import STEP_S, Gait
from tests.estimator.inertial.led import followed, true_m, where
from tests.estimator.inertial.moves import Moves

BIAS = np.array([0.03, -0.04, 0.05])


def biased(gait: Gait) -> Gait:
    return gait._replace(rate=gait.rate + BIAS)


def led(gait: Gait) -> Boot:
    boot, done = Boot.new(0.0), 0
    while done < len(gait.force):
        done += advance(boot, gait.force[done:], gait.rate[done:], STEP_S)
    return boot


def turned_rad(gait: Gait) -> float:
    """What the heading of a unit that sends it may have turned by, as is said (rad)."""
    known: Navigation | None = None
    variance = 0.0
    for piece in pieces(gait.imu()):
        done = navigate(known, piece, 0.0)
        known, variance = done.navigation, variance + done.turned_rad2
    return float(np.sqrt(variance))


def test_who_walks_when_his_unit_is_switched_on_has_unknown_biases_until_he_rests() -> None:
    walks = biased(Moves().walks(10).gait())
    boot = led(walks)
    assert boot.gyros[BIAS_RADPS] == pytest.approx(UNRESTED_RADPS, rel=0.01)
    rests = led(biased(Moves().walks(10).rests(3.0).gait()))
    np.testing.assert_allclose(rests.held.sensors[6:], BIAS, atol=2e-3)
    assert rests.gyros[BIAS_RADPS] < 1.1 * RESTED_RADPS


def test_what_his_heading_may_have_turned_by_meanwhile_is_said() -> None:
    """It turns by the bias times the time, which is no random walk."""
    walks = biased(Moves().walks(20).gait())
    expected = np.sqrt(UNRESTED_RADPS**2 - GRANTED_RADPS**2) * (walks.t[-1] - 0.5)
    assert turned_rad(walks) == pytest.approx(expected, rel=0.05)
    rested = biased(Moves().rests(2.0).walks(20).gait())
    assert turned_rad(rested) == 0.0


def test_after_the_rest_his_ways_are_straight() -> None:
    gait = Moves().walks(4).rests(3.0).walks(30).gait()
    found, _ = followed(biased(gait).readings())
    after = [d for d in found if (d.from_t or 0.0) > 7.0]
    told, true = where(after), true_m(gait, after[-1].t) - true_m(gait, after[0].from_t or 0.0)
    assert np.linalg.norm(told) == pytest.approx(np.linalg.norm(true), rel=0.02)


def test_a_boot_that_is_levelled_anew_keeps_what_its_rests_have_told() -> None:
    boot = led(biased(Moves().rests(3.0).walks(3).gait())).anew()
    np.testing.assert_allclose(boot.held.sensors[6:], BIAS, atol=2e-3)
    assert boot.gyros[BIAS_RADPS] < 1.1 * RESTED_RADPS
