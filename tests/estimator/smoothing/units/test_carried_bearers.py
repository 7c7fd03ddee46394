"""When a unit has told that it stood."""

import numpy as np

from estimator.fusion.memory.ledger import ASSUMED, COLUMNS, GIVEN, UNSEEN
from estimator.graph.dense import Array
from estimator.smoothing.units.carried_bearers import LONG_S, Standstill, standstills


def steps(east_m: list[float]) -> Array:
    """A step each second."""
    rows = np.zeros((len(east_m), len(COLUMNS["steps"])))
    rows[:, 0], rows[:, 2] = np.arange(1.0, len(east_m) + 1.0), np.arange(len(east_m))
    rows[:, 3], rows[:, GIVEN] = east_m, ASSUMED
    return rows


def test_a_standstill_lasts_from_the_last_step_to_the_next() -> None:
    told = steps([0.7] * 4 + [0.01] * 8 + [0.6] * 3)
    assert list(standstills(told, 0.0)) == [Standstill(4.0, 12.0)]


def test_a_jolt_while_he_is_carried_is_no_step() -> None:
    told = steps([0.01] * 4 + [0.3, -0.2] + [0.01] * 4)
    assert list(standstills(told, 0.0)) == [Standstill(0.0, 10.0)]


def test_who_goes_a_little_stands_before_and_after() -> None:
    told = steps([0.01] * 8 + [0.3] * 3 + [0.01] * 8)
    assert list(standstills(told, 0.0)) == [Standstill(0.0, 8.0), Standstill(11.0, 19.0)]


def test_a_halt_is_no_standstill() -> None:
    assert not list(standstills(steps([0.7] + [0.01] * int(LONG_S) + [0.7]), 0.0))


def test_a_standstill_that_is_long_over_is_not_asked_about() -> None:
    told = steps([0.01] * 10 + [0.7] * 5)
    assert not list(standstills(told, 10.0))
    assert list(standstills(told, 9.0)) == [Standstill(0.0, 10.0)]


def test_who_tells_nothing_does_not_stand() -> None:
    told = steps([0.0] * 10)
    told[:, GIVEN] = UNSEEN
    assert not list(standstills(told, 0.0))


def test_a_step_that_was_found_wrong_interrupts_no_standstill() -> None:
    told = steps([0.01] * 10)
    slip = told[4:5].copy()
    slip[:, 2] = slip[:, 0]
    assert list(standstills(np.vstack([told[:5], slip, told[5:]]), 0.0)) == [Standstill(0.0, 10.0)]
