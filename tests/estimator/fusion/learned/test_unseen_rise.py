"""Altimeters jump, or their bearers ride or fall: what else is known tells which is likelier."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fusion.learned.unseen_rise import LEAST_M, Circumstances, Rise, risen_p

STOREY_M = 3.4
CREW = Circumstances(bearers=3, together=True, standing=True, witnesses=1)
ALONE = Circumstances(bearers=1, together=True, standing=True, witnesses=1)


SEEN = st.builds(Circumstances, st.integers(1, 6), st.booleans(), st.booleans(), st.integers(0, 6))


@given(st.floats(-40.0, 40.0), SEEN)
def test_it_is_a_probability_and_alike_up_and_down(up_m: float, seen: Circumstances) -> None:
    assert 0.0 <= risen_p(up_m, seen) <= 1.0
    assert risen_p(up_m, seen) == risen_p(-up_m, seen)


def test_a_crew_that_stands_together_rides() -> None:
    assert risen_p(STOREY_M, CREW) > 0.9
    assert risen_p(10.0 * STOREY_M, CREW._replace(witnesses=0)) > 0.99


def test_a_crew_of_whom_one_walks_or_is_elsewhere_meets_a_step_of_pressure() -> None:
    assert risen_p(STOREY_M, CREW._replace(standing=False)) == 0.0
    assert risen_p(STOREY_M, CREW._replace(together=False)) == 0.0


@pytest.mark.parametrize("seen", [CREW, ALONE])
def test_nobody_rides_less_than_a_storey(seen: Circumstances) -> None:
    assert risen_p(0.99 * LEAST_M, seen) == 0.0


def test_who_alone_has_jumped_by_a_storey_may_have_fallen_or_not() -> None:
    assert 0.3 < risen_p(-STOREY_M, ALONE) < 0.7


def test_who_walks_on_has_hardly_fallen() -> None:
    assert risen_p(-STOREY_M, ALONE._replace(standing=False)) < 0.1


def test_the_more_others_have_not_jumped_the_less_it_is_a_step_of_pressure() -> None:
    ps = [risen_p(STOREY_M, CREW._replace(witnesses=count)) for count in range(3)]
    assert ps == sorted(ps)
    assert ps[0] < ps[-1]


def test_what_begins_soon_after_to_the_same_side_is_its_rest() -> None:
    rise = Rise(since_t=100.0, until_t=108.0, up_m=5.0, was="altimeter 0")
    assert rise.goes_on(110.0, 3.0)
    assert not rise.goes_on(110.0, -3.0)
    assert not rise.goes_on(140.0, 3.0)


def test_what_leads_back_has_undone_it() -> None:
    rise = Rise(since_t=100.0, until_t=108.0, up_m=-3.0, was="altimeter 0")
    assert rise.is_undone(2.8)
    assert not rise.is_undone(-3.0)
    assert not rise.is_undone(6.0)
    assert not Rise().is_undone(0.0)
