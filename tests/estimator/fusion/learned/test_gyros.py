"""How well a crew's gyros are calibrated, from what the readings alone say of each one's bias."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion import physics
from estimator.fusion.learned.calibration import UNTOLD, Told, told_of
from estimator.fusion.learned.gyros import SPREADS, bias_sigma_radps

USUAL_RADPS = physics.BIAS_SIGMA_MOST_RADPS / math.sqrt(3.0)
"""Standard deviation under a spread that may be anything up to the most."""


def said(bias_dps: float, sigma_dps: float) -> Told:
    """What readings say that tell a bias with a standard deviation (degrees per second)."""
    information = math.radians(sigma_dps) ** -2
    return information, information * math.radians(bias_dps)


def test_before_any_unit_tells_a_bias_may_be_anything_of_its_kind() -> None:
    assert bias_sigma_radps(UNTOLD, []) == pytest.approx(USUAL_RADPS, rel=0.01)
    assert bias_sigma_radps(UNTOLD, [UNTOLD, UNTOLD]) == pytest.approx(USUAL_RADPS, rel=0.01)


def test_a_crew_of_good_gyros_makes_the_next_ones_bias_better_known_and_a_bad_crew_worse() -> None:
    good = [said(0.04, 0.02), said(-0.06, 0.02), said(0.05, 0.02), said(0.03, 0.02)]
    bad = [said(0.4, 0.02), said(-0.5, 0.02), said(0.45, 0.02), said(-0.6, 0.02)]
    assert bias_sigma_radps(UNTOLD, good) < 0.5 * USUAL_RADPS
    assert bias_sigma_radps(UNTOLD, bad) > 1.2 * USUAL_RADPS


def test_a_bad_unit_in_a_good_crew_is_not_taken_for_a_good_one() -> None:
    crew = [said(0.04, 0.02), said(-0.06, 0.02), said(0.05, 0.02)]
    bad, usual = said(1.0, 0.3), said(0.05, 0.3)
    assert bias_sigma_radps(bad, [*crew, bad]) > 2.0 * bias_sigma_radps(usual, [*crew, usual])


def test_what_says_little_changes_little() -> None:
    vague = [said(0.3, 3.0)] * 3
    assert bias_sigma_radps(vague[0], vague) == pytest.approx(USUAL_RADPS, rel=0.03)


@given(
    bias=st.floats(0.01, 1.0), sigma=st.floats(0.01, 2.0), others=st.lists(st.floats(-0.6, 0.6), max_size=3)
)
def test_a_bias_is_left_as_far_and_as_unsure_as_all_spreads_together_leave_it(
    bias: float, sigma: float, others: list[float]
) -> None:
    """Its posterior by integration over bias and spread; but none is wider than the widest spread."""
    own, other_m2 = said(bias, sigma), math.radians(0.05) ** 2
    prior = bias_sigma_radps(own, [own, *(said(other, 0.05) for other in others)])
    alone, d = math.radians(sigma) ** 2, math.radians(bias)
    grid = np.linspace(-math.radians(6.0), math.radians(6.0), 40_001)
    joint = np.zeros(len(grid))
    for spread in SPREADS:
        known = spread + other_m2
        weight = math.prod(
            math.exp(-0.5 * math.radians(other) ** 2 / known) / math.sqrt(known) for other in others
        )
        joint += weight / math.sqrt(spread) * np.exp(-0.5 * (grid**2 / spread + (grid - d) ** 2 / alone))
    total = joint.sum()
    mean = float((grid * joint).sum() / total)
    variance = float(((grid - mean) ** 2 * joint).sum() / total)
    share = prior**2 / (prior**2 + alone)
    widest = SPREADS[-1] / (SPREADS[-1] + alone)
    assert share == pytest.approx(min(max(mean / d, variance / alone), widest), rel=2e-3, abs=1e-4)


@given(
    bias=st.floats(0.01, 3.0), sigma=st.floats(0.01, 2.0), others=st.lists(st.floats(-0.6, 0.6), max_size=3)
)
def test_no_bias_is_less_known_beforehand_than_by_the_widest_spread(
    bias: float, sigma: float, others: list[float]
) -> None:
    own = said(bias, sigma)
    prior = bias_sigma_radps(own, [own, *(said(other, 0.05) for other in others)])
    assert math.sqrt(SPREADS[0]) * 0.999 <= prior <= math.sqrt(SPREADS[-1]) * 1.001


@given(bias=st.floats(-0.6, 0.6), sigma=st.floats(0.01, 1.0), prior=st.floats(0.02, 1.0))
def test_the_answer_does_not_depend_on_the_prior_that_the_estimate_was_made_with(
    bias: float, sigma: float, prior: float
) -> None:
    information, product = said(bias, sigma)
    variance = 1.0 / (information + math.radians(prior) ** -2)
    assert told_of(math.radians(prior), product * variance, variance) == pytest.approx((information, product))


def test_an_estimate_that_is_the_prior_tells_nothing() -> None:
    assert told_of(0.005, 0.0, 0.005**2) == UNTOLD
    assert told_of(0.005, 0.0, 0.0) == UNTOLD
    assert told_of(0.005, math.nan, math.nan) == UNTOLD
