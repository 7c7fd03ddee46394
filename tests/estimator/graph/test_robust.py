"""Mixtures of good and bad noise against their densities, as scipy has them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from estimator.graph.robust import FARTHER, WILD, mixture_cost, weigh

OUTLIERS, SHIFT, SPREAD = 0.05, 2.0, 6.0


@given(st.floats(-60.0, 60.0), st.floats(0.01, 10.0), st.sampled_from([0.0, 1e-12, OUTLIERS, 0.9]))
def test_cost_and_weights_are_those_of_the_densities(off: float, sigma: float, outliers: float) -> None:
    one = [np.array([number]) for number in (off, sigma, outliers, SHIFT, SPREAD)]
    residual, sigmas, *noise = one
    with np.errstate(divide="ignore"):
        usual, rare, seldom = np.log([1.0 - outliers, (1.0 - WILD) * outliers, WILD * outliers])
    root = 0.5 * np.log(2.0 * np.pi)
    good = usual + norm.logpdf(off, 0.0, sigma) + root
    bad = rare + norm.logpdf(off, SHIFT, np.hypot(sigma, SPREAD)) + root
    wild = seldom + norm.logpdf(off, SHIFT, np.hypot(sigma, FARTHER * SPREAD)) + root
    whole = np.logaddexp(np.logaddexp(good, bad), wild)
    assert mixture_cost(residual, sigmas, *noise)[0] == pytest.approx(-whole, abs=1e-9)
    found = weigh(residual, sigmas, np.zeros(1), *noise)
    assert found.good[0] == pytest.approx(np.exp(good - whole), abs=1e-9)
    from_good = np.exp(good - whole) / sigma**2
    from_bad = np.exp(bad - whole) / (sigma**2 + SPREAD**2)
    from_bad += np.exp(wild - whole) / (sigma**2 + (FARTHER * SPREAD) ** 2)
    assert found.information[0] == pytest.approx(from_good + from_bad)
    gradient = from_good * off + from_bad * (off - SHIFT)
    assert found.information[0] * found.residual[0] == pytest.approx(gradient, abs=1e-9)


def test_a_wild_reading_pulls_less_than_a_bad_one_the_farther_off_it_is() -> None:
    """A redescending loss: what is 20 times as far off as bad readings are has hardly any pull left."""
    noise = [np.full(2, number) for number in (OUTLIERS, SHIFT, SPREAD)]
    found = weigh(np.array([2.0 * SPREAD, 20.0 * SPREAD]), np.full(2, 0.3), np.zeros(2), *noise)
    pull = found.information * found.residual
    assert pull[1] < 0.2 * pull[0]


def test_what_is_beyond_all_measure_costs_more_than_anything_and_is_still_a_number() -> None:
    one = np.ones(1)
    told = mixture_cost(one * 1e200, one, one * OUTLIERS, one * SHIFT, one * SPREAD)
    assert 1e299 < told[0] < np.inf
