"""Mixtures of good and bad noise against their densities, as scipy has them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from estimator.graph.robust import mixture_cost, weigh

OUTLIERS, SHIFT, SPREAD = 0.05, 2.0, 6.0


@given(st.floats(-60.0, 60.0), st.floats(0.01, 10.0), st.sampled_from([0.0, 1e-12, OUTLIERS, 0.9]))
def test_cost_and_weights_are_those_of_the_densities(off: float, sigma: float, outliers: float) -> None:
    one = [np.array([number]) for number in (off, sigma, outliers, SHIFT, SPREAD)]
    residual, sigmas, *noise = one
    with np.errstate(divide="ignore"):
        usual, rare = np.log([1.0 - outliers, outliers])
    root = 0.5 * np.log(2.0 * np.pi)
    good = usual + norm.logpdf(off, 0.0, sigma) + root
    bad = rare + norm.logpdf(off, SHIFT, np.hypot(sigma, SPREAD)) + root
    assert mixture_cost(residual, sigmas, *noise)[0] == pytest.approx(-np.logaddexp(good, bad), abs=1e-9)
    found = weigh(residual, sigmas, np.zeros(1), *noise)
    share = np.exp(good - np.logaddexp(good, bad))
    assert found.good[0] == pytest.approx(share, abs=1e-9)
    wide = sigma**2 + SPREAD**2
    from_good, from_bad = share / sigma**2, (1.0 - share) / wide
    assert found.information[0] == pytest.approx(from_good + from_bad)
    gradient = from_good * off + from_bad * (off - SHIFT)
    assert found.information[0] * found.residual[0] == pytest.approx(gradient, abs=1e-9)


def test_what_is_beyond_all_measure_costs_more_than_anything_and_is_still_a_number() -> None:
    one = np.ones(1)
    told = mixture_cost(one * 1e200, one, one * OUTLIERS, one * SHIFT, one * SPREAD)
    assert 1e299 < told[0] < np.inf
