"""Whether a ranging technology is calibrated, from what the readings alone say of its scale."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.learned.calibration import (
    TRUSTED,
    Calibration,
    doubt,
    narrow_sigma,
    uncalibrated,
)

NARROW = narrow_sigma(0.0)
SIGMAS = [NARROW, 0.03, physics.RANGE_SCALE_WIDE]
"""Of priors that an estimate may have been made with."""


def judged(sigma: float, truth: float, alone: float) -> float:
    """What is said of a technology whose scale is read as `truth` with standard deviation `alone`."""
    variance = 1.0 / (sigma**-2 + alone**-2)
    return uncalibrated(sigma, truth * variance / alone**2, variance, NARROW)


@pytest.mark.parametrize("sigma", SIGMAS)
def test_seven_percent_seen_sharply_are_not_calibrated(sigma: float) -> None:
    assert judged(sigma, 0.07, 0.005) > 0.99
    assert judged(sigma, -0.07, 0.005) > 0.99


@pytest.mark.parametrize("sigma", SIGMAS)
def test_what_a_units_own_scale_may_explain_is_no_reason_for_distrust(sigma: float) -> None:
    """Odometry tells a scale to 2 %, which is what boots differ by."""
    assert judged(sigma, 0.003, 0.002) < 0.1
    assert judged(sigma, 0.02, physics.SCALE_SIGMA) < TRUSTED
    assert judged(sigma, 0.07, physics.SCALE_SIGMA) > TRUSTED


def followed(*told: float) -> list[float]:
    """The priors that a scale has had, where each solution has told how likely it is not calibrated."""
    known, sigmas = Calibration(), list[float]()
    for share in told:
        known = known.judged(share, NARROW, known.scale_sigma(NARROW))
        sigmas.append(known.scale_sigma(NARROW))
    return sigmas


def test_trust_that_what_follows_without_it_gives_back_is_not_lost_for_the_same_again() -> None:
    """What a narrow prior has bent says a quarter and more, what follows from a wide one less, for ever."""
    wide = physics.RANGE_SCALE_WIDE
    assert followed(0.2, 0.28, 0.18, 0.28, 0.3) == [NARROW, wide, NARROW, NARROW, NARROW]


def test_trust_is_lost_again_where_it_is_likelier_that_a_scale_is_not_calibrated() -> None:
    wide = physics.RANGE_SCALE_WIDE
    assert followed(0.2, 0.28, 0.18, 0.55, 0.3, 0.2) == [NARROW, wide, NARROW, wide, wide, NARROW]


def test_a_scale_is_trusted_first_by_odds_of_three_to_one() -> None:
    assert followed(0.3, 0.26, 0.24) == [physics.RANGE_SCALE_WIDE, physics.RANGE_SCALE_WIDE, NARROW]


@pytest.mark.parametrize("sigma", SIGMAS)
def test_where_nothing_is_known_the_usual_share_stays(sigma: float) -> None:
    assert uncalibrated(sigma, 0.0, sigma**2, NARROW) == physics.UNCALIBRATED
    assert judged(sigma, 0.5, 10.0) == pytest.approx(physics.UNCALIBRATED, rel=0.01)


@pytest.mark.parametrize("seed", range(20))
def test_the_answer_does_not_depend_on_the_prior_that_the_estimate_was_made_with(seed: int) -> None:
    chance = np.random.default_rng(seed)
    truth, alone = float(chance.normal(0.0, 0.05)), float(chance.uniform(0.002, 0.05))
    told = [judged(sigma, truth, alone) for sigma in SIGMAS]
    assert told == pytest.approx([told[0]] * len(told), rel=1e-6)


def test_the_odds_are_those_of_two_gaussians() -> None:
    """Against Bayes' rule written out with densities."""

    def density(value: float, sigma: float) -> float:
        return math.exp(-0.5 * (value / sigma) ** 2) / sigma

    said, alone = 0.04, 0.02
    wide = physics.UNCALIBRATED * density(said, math.hypot(alone, physics.RANGE_SCALE_WIDE))
    narrow = (1.0 - physics.UNCALIBRATED) * density(said, math.hypot(alone, physics.RANGE_SCALE_SIGMA))
    assert judged(0.1, said, alone) == pytest.approx(wide / (wide + narrow), rel=1e-9)


def test_where_walls_make_many_ranges_too_long_a_scale_of_some_percent_is_no_miscalibration() -> None:
    in_sight, obstructed = (uncalibrated(0.15, 0.04, 0.01**2, narrow_sigma(share)) for share in (0.02, 0.4))
    assert in_sight > 0.9
    assert obstructed < 0.5


def test_where_other_ranges_hardly_scatter_many_echoes_are_no_reason_to_let_a_scale_go() -> None:
    """What walls make of a range scatters as much as it makes it longer."""
    assert narrow_sigma(0.4, 0.3 / 10.0) > 0.03
    assert narrow_sigma(0.4, 0.1 / 50.0) < 0.006


@given(
    share=st.floats(0.0, 1.0),
    said=st.floats(-0.3, 0.3),
    alone=st.floats(0.001, 1.0),
    wide=st.booleans(),
)
def test_what_a_scale_may_be_otherwise_adds_its_second_moment(
    share: float, said: float, alone: float, wide: bool
) -> None:
    """Against both posteriors, each written out from what the readings alone say."""
    sigmas = (physics.RANGE_SCALE_WIDE, NARROW) if wide else (NARROW, physics.RANGE_SCALE_WIDE)
    (shown, variance), (other, unsure) = (
        (said * sigma**2 / (sigma**2 + alone**2), sigma**2 * alone**2 / (sigma**2 + alone**2))
        for sigma in sigmas
    )
    odds = 1.0 - share if wide else share
    added = doubt(Calibration(share, NARROW, sigmas[0]), shown, variance) * variance**2
    assert added == pytest.approx(odds * ((other - shown) ** 2 + max(unsure - variance, 0.0)), abs=1e-9)


def test_before_a_scale_is_estimated_there_is_no_doubt_of_it() -> None:
    assert doubt(Calibration(), 0.0, physics.RANGE_SCALE_WIDE**2) == 0.0
