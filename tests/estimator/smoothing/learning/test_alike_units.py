"""What one unit shows of its noise is thought of its crew's others as well."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.smoothing.learning.alike_units import ALIKE, OWN, pulled

told = st.tuples(st.floats(-3.0, 3.0), st.floats(-5.0, 5.0), st.floats(0.0, 50.0))


@given(told)
def test_alone_it_is_a_unit_like_any(unit: tuple[float, float, float]) -> None:
    off, score, sure = unit
    spread2 = OWN + ALIKE
    step = pulled(np.array([off]), np.array([score]), np.array([sure]))
    assert step == pytest.approx([(score - off / spread2) / (sure + 1.0 / spread2)])


@given(st.lists(told, min_size=1, max_size=9))
def test_steps_are_those_of_newton_with_the_prior_of_all_together(
    units: list[tuple[float, float, float]],
) -> None:
    """Its covariance is that of what they have in common everywhere, and of their own on the diagonal."""
    off, score, sure = np.array(units).T
    information = np.linalg.inv(ALIKE * np.ones((len(off), len(off))) + OWN * np.eye(len(off)))
    expected = np.linalg.solve(np.diag(sure) + information, score - information @ off)
    assert pulled(off, score, sure) == pytest.approx(expected, abs=1e-9)


def test_one_bad_unit_is_a_warning_of_the_others_and_two_are_more() -> None:
    nothing, off = np.full(4, 1.0), np.zeros(4)
    one = pulled(off, np.array([2.0, 0.0, 0.0, 0.0]), nothing)
    two = pulled(off, np.array([2.0, 2.0, 0.0, 0.0]), nothing)
    assert one[0] > one[1] == pytest.approx(one[3])
    assert one[3] > 0.05
    assert two[3] == pytest.approx(2.0 * one[3])


def test_among_good_units_a_bad_one_is_led_farther_than_they_and_not_they_as_far() -> None:
    """Of each readings say clearly how it is."""
    bad, known = 2.0, np.full(5, 20.0)
    off = np.zeros(5)
    for _ in range(30):
        off = off + pulled(off, known * (np.array([bad, 0.0, 0.0, 0.0, 0.0]) - off), known)
    assert off[0] == pytest.approx(bad, rel=0.1)
    assert np.abs(off[1:]).max() < 0.1
