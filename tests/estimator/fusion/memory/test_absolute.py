"""Fixes that share an error are worth what they tell together, and no more."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.memory.absolute import Absolute, SharedError

SIGMA_M = 3.0


def told(rate_hz: float, span_s: float, memory_s: float, shared: float) -> tuple[float, float]:
    """Information on a place that stays, by the readings' sigmas, and exactly (1/m²).

    Exactly: 1ᵀ C⁻¹ 1, with the covariance C of an error that is forgotten exponentially, and white noise.
    """
    t = np.arange(0.0, span_s, 1.0 / rate_hz)
    alike, information = SharedError(), 0.0
    for epoch in t.tolist():
        alike = alike.with_one(epoch, 0.0, memory_s)
        information += alike.sigma(SIGMA_M, shared) ** -2
    common = shared * np.exp(-np.abs(t[:, None] - t) / memory_s)
    covariance = SIGMA_M**2 * (common + (1.0 - shared) * np.eye(len(t)))
    ones = np.ones(len(t))
    return information, float(ones @ np.linalg.solve(covariance, ones))


@given(
    rate_hz=st.floats(0.1, 5.0),
    span_s=st.floats(1.0, 200.0),
    memory_s=st.floats(5.0, 100.0),
    shared=st.floats(0.05, 0.9),
)
def test_readings_are_never_taken_for_much_more_than_they_tell_nor_for_a_third_of_it(
    rate_hz: float, span_s: float, memory_s: float, shared: float
) -> None:
    ours, exactly = told(rate_hz, span_s, memory_s, shared)
    assert exactly / 3.0 < ours < 1.25 * exactly


def test_an_error_that_stays_is_never_averaged_away() -> None:
    ours, exactly = told(rate_hz=1.0, span_s=300.0, memory_s=1e9, shared=0.5)
    assert ours == pytest.approx(exactly, rel=1e-4)
    assert ours < 1.0 / (0.5 * SIGMA_M**2)


def test_a_single_reading_is_worth_itself() -> None:
    assert SharedError().with_one(5.0, 0.0, 60.0).sigma(SIGMA_M, 0.5) == pytest.approx(SIGMA_M)


def test_who_has_gone_on_has_left_the_error_behind() -> None:
    standing = SharedError().with_one(0.0, 0.0, 60.0, 10.0).with_one(1.0, 0.0, 60.0, 10.0)
    gone_on = SharedError().with_one(0.0, 0.0, 60.0, 10.0).with_one(1.0, 50.0, 60.0, 10.0)
    assert gone_on.sigma(SIGMA_M, 0.5) == pytest.approx(SIGMA_M, rel=0.02)
    assert standing.sigma(SIGMA_M, 0.5) > 1.6 * SIGMA_M


def test_only_fixes_that_agree_with_each_other_add_up_against_a_place() -> None:
    known = Absolute()
    for t, off_m in enumerate(((60.0, 0.0), (61.0, 1.0), (59.0, -1.0))):
        known = known.with_fix(float(t), False, off_m, same_m=4.0)
    assert known.against == 3
    assert known.with_fix(3.0, False, (-40.0, 10.0), same_m=4.0).against == 1
    fitting = known.with_fix(3.0, True, (0.5, 0.0), same_m=4.0)
    assert (fitting.against, fitting.fits) == (0, 1)
    assert math.dist(known.off_m, (59.0, -1.0)) == 0.0


def test_copies_of_one_fix_are_one() -> None:
    known = Absolute()
    for _ in range(4):
        known = known.with_fix(5.0, False, (60.0, 0.0), same_m=4.0)
    assert known.against == 1
