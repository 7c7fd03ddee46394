"""How a unit reports that never says since when."""

from collections.abc import Iterable

import pytest

from estimator.fusion.learned.report_period import (
    ODDS_MOST,
    RECENT_S,
    SPANS_LEAST,
    Cadence,
    Reported,
    is_whole,
)


def after(epochs_s: Iterable[float], *, still: bool = False, losing: float = 0.0) -> Cadence:
    cadence = Cadence()
    for t in epochs_s:
        told = Reported(t, 1.0, (1.0, 0.0, 0.0), None)
        cadence = cadence.after(told, still=still, losing=losing)
    return cadence


def test_a_period_is_told_by_some_reports_though_others_are_lost() -> None:
    assert after(range(SPANS_LEAST)).period_s is None
    assert after(range(SPANS_LEAST + 1)).period_s == 1.0
    assert after([0.0, 1.0, 3.0, 4.0, 8.0, 10.0, 11.0, 14.0]).period_s == 1.0
    assert after(0.5 * k + 0.03 * (k % 2) for k in range(12)).period_s == pytest.approx(0.5, abs=0.04)


def test_a_unit_that_reports_its_bearers_steps_has_no_period() -> None:
    steps_s = [0.0, 0.5, 1.12, 1.54, 2.3, 2.85, 3.36, 4.14, 6.6, 7.3, 7.8]
    assert after(steps_s).period_s is None


def test_copies_that_are_taken_for_reports_hide_no_period() -> None:
    assert after(k + by_s for k in range(4) for by_s in (0.0, 0.01)).usual_s == pytest.approx(0.99)
    assert Cadence().usual_s is None


def test_many_periods_are_not_told_from_one_more() -> None:
    assert is_whole(1.0)
    assert is_whole(2.9)
    assert is_whole(30.4)
    assert not is_whole(1.5)
    assert not is_whole(0.4)


def test_who_reports_twice_in_a_row_that_he_stands_does_so_always() -> None:
    assert not after([0.0], still=True).stands
    stands = after([0.0, 1.0], still=True)
    assert stands.stands
    assert stands.after(Reported(2.0, 1.0, (1.0, 0.0, 0.0), None), still=False).stands


def test_what_copies_can_be_of_is_some_seconds_old_and_no_habit_is_certain() -> None:
    cadence = after(range(60), losing=1.0)
    assert min(told.t for told in cadence.recent) >= 59.0 - RECENT_S
    assert cadence.losing == ODDS_MOST


def test_a_silence_is_no_usual_time_between_reports() -> None:
    assert after([0.0, 1.0, 2.0, 98.0]).usual_s == 1.0
    assert after([0.0, 98.0]).usual_s is None


def test_the_middle_time_is_a_units_own_where_some_reports_are_lost() -> None:
    assert after([0.0, 1.0, 3.0, 4.0, 7.0, 8.0]).middle_s == 1.0
    assert Cadence().middle_s is None
