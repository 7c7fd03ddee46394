"""An incident folded ahead while it runs is solved as if all of it had come at once."""

import random
from collections.abc import Sequence

import pytest

from estimator.measurements import AnyReading
from estimator.measurements.position import Position
from estimator.simulate import scenario
from estimator.smoothing.first_pass import TICK_S
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.heard import LONGEST_S, Heard
from tests.estimator.fusion.readings.test_raw_samples import incident as of_raw_samples
from tests.estimator.walks import two_responders

LAG_S = 10.0


def heard_by_parts(readings: Sequence[AnyReading], each: int, late_s: float = LAG_S) -> Heard:
    """Readings that come late by up to `late_s`, folded ahead whenever some have come."""
    chance = random.Random(7)
    came = sorted((r.until_t + chance.uniform(0.0, late_s), i) for i, r in enumerate(readings))
    heard = Heard(LAG_S)
    for first in range(0, len(came), each):
        part = came[first : first + each]
        some = [readings[i] for _, i in part]
        assert heard.can_hear(some)
        heard.hear(some)
        heard.fold_ahead(part[-1][0])
    return heard


@pytest.mark.parametrize("each", [1, 7, 100])
def test_what_was_folded_ahead_changes_no_bit(each: int) -> None:
    walk = two_responders(60)
    heard = heard_by_parts(walk, each)
    smoother = BatchSmoother()
    assert len(heard) == len(walk)
    assert smoother.smooth(heard) == smoother.smooth(walk)
    assert smoother.evidence(heard, "ff1") == smoother.evidence(walk, "ff1")
    assert smoother.advice(heard, "ff1") == smoother.advice(walk, "ff1")


def test_raw_samples_are_folded_ahead_piece_by_piece() -> None:
    readings = of_raw_samples()
    heard = heard_by_parts(readings, 5)
    assert BatchSmoother().smooth(heard) == BatchSmoother().smooth(readings)


def test_who_was_asked_goes_on_as_if_nobody_had() -> None:
    """Asking solves everything, moves breadcrumbs and learns noise: of what is known then only."""
    shown = scenario("kicked-breadcrumb", 1)
    readings = sorted(shown.readings, key=lambda r: r.until_t)
    half, smoother = len(readings) // 2, BatchSmoother()
    heard = Heard(LAG_S)
    for part in (readings[:half], readings[half:]):
        heard.hear(part)
        heard.fold_ahead(part[-1].until_t)
        assert smoother.smooth(heard) == smoother.smooth(heard)
    assert smoother.smooth(heard) == smoother.smooth(readings)


def test_what_tells_of_folded_times_cannot_be_heard_any_more() -> None:
    heard = Heard(LAG_S)
    assert heard.can_hear([fix(-1e9)])
    heard.hear([fix(100.0)])
    heard.fold_ahead(110.0 + TICK_S)
    assert not heard.can_hear([fix(112.0), fix(100.0 + TICK_S / 2)])
    assert heard.can_hear([fix(100.0 + TICK_S)])


def test_time_that_goes_back_folds_nothing() -> None:
    heard = Heard(LAG_S)
    heard.fold_ahead(200.0)
    heard.fold_ahead(100.0)
    assert not heard.can_hear([fix(150.0)])


def test_an_epoch_of_another_day_is_left_out_ahead_as_well() -> None:
    wrong, right = [fix(0.0), fix(1.0)], [fix(1e9 + second) for second in range(60)]
    heard = Heard(LAG_S)
    heard.hear([*wrong, *right])
    heard.fold_ahead(1e9 + 60.0)
    assert heard.can_hear(right[-1:])
    assert not heard.can_hear(right[:1])
    assert not heard.misdated()
    assert len(heard) == len(wrong) + len(right)
    assert BatchSmoother().smooth(heard) == BatchSmoother().smooth([*wrong, *right])


def test_an_epoch_of_another_day_that_was_folded_is_found_out() -> None:
    wrong = [fix(-2.0 * LONGEST_S)]
    right = [fix(float(t)) for t in range(20)]
    heard = Heard(LAG_S)
    heard.hear(wrong)
    heard.fold_ahead(-2.0 * LONGEST_S + 2.0 * LAG_S)
    assert not heard.misdated()
    heard.hear(right)
    assert heard.misdated()
    anew = Heard(LAG_S)
    anew.hear([*wrong, *right])
    assert not anew.misdated()
    assert BatchSmoother().smooth(anew) == BatchSmoother().smooth(right)


def test_from_a_unit_without_a_clock_that_came_first_nothing_goes_on() -> None:
    """It counts from when it was switched on: half a century is no tick."""
    heard, right = Heard(LAG_S), [fix(1e9 + second) for second in range(60)]
    heard.hear([fix(float(second)) for second in range(30)])
    heard.fold_ahead(30.0)
    heard.hear(right)
    heard.fold_ahead(right[-1].t)
    assert heard.can_hear(right)
    assert heard.misdated()


def test_what_was_left_out_and_belongs_to_the_incident_is_found_out() -> None:
    """Readings are a day apart, and so none is a day from the middle one."""
    heard = Heard(LAG_S)
    heard.hear([fix(0.0), fix(0.6 * LONGEST_S), fix(1.2 * LONGEST_S)])
    heard.fold_ahead(1.2 * LONGEST_S)
    assert heard.misdated()


def fix(t: float) -> Position:
    return Position(t=t, node="ff1", position_m=(0.0, 0.0, 0.0), sigma_m=(1.0, 1.0, 1.0))
