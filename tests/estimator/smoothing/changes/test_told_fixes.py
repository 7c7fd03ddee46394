"""Fixes that are off or late by more than is usual, among other causes."""

import math

import numpy as np
import pytest

from estimator.fusion.learned.receivers import LATE, OFFSET, Receiver
from estimator.fusion.memory.state import FusionState
from estimator.smoothing.changes.told_fixes import ToldFixes, doubt_fixes, misled

RECEIVER = "receiver of uav 0"


def off(odds: float, by_m: float = 3.0) -> ToldFixes:
    """Fixes that may be off to the east."""
    off_m = np.array([by_m, 0.0])
    return ToldFixes(RECEIVER, OFFSET, odds, off_m, np.diag([4.0, 1.0]), 0.5 * off_m, np.full(2, 0.3))


def late(odds: float, by_s: float = 1.0, sigma_s: float = 0.1) -> ToldFixes:
    """Fixes that are late."""
    late_s = np.array([by_s])
    return ToldFixes(RECEIVER, LATE, odds, 1.2 * late_s, np.array([[1.0]]), late_s, np.full(1, sigma_s))


def doubted(found: list[ToldFixes], others: dict[str, float]) -> Receiver:
    """What is doubted of the receiver."""
    state = FusionState()
    state.receivers[RECEIVER] = Receiver("uav", (0.7, 0.7, 1.0, 0.2), 1.4)
    doubt_fixes(state, found, others)
    return state.receivers[RECEIVER]


def test_that_fixes_are_off_is_doubted_as_far_as_it_is_likely() -> None:
    rarely = math.log(0.02 / 0.98)
    ((own, moment),) = doubted([off(rarely)], {}).doubts
    assert own == OFFSET
    assert moment == pytest.approx(0.02 * np.diag([4.0, 1.0]), rel=1e-6)


def test_what_explains_as_much_shares_the_doubt() -> None:
    alone = doubted([off(9.0)], {}).doubts
    both = doubted([off(9.0), late(9.0)], {"a delay": 9.0}).doubts
    assert [one.own for one in alone] == [OFFSET]
    assert [one.own for one in both] == [OFFSET, LATE]
    assert alone[0].moment == pytest.approx(np.diag([4.0, 1.0]), rel=0.01)
    assert both[0].moment == pytest.approx(np.diag([4.0, 1.0]) / 3.0, rel=0.01)
    assert both[1].moment[0, 0] == pytest.approx(1.0 / 3.0, rel=0.01)


@pytest.mark.parametrize(
    ("found", "others"),
    [
        ([off(5.0)], {}),
        ([off(9.0), late(7.0, by_s=0.2)], {}),
        ([late(-1.0)], {"a delay": 0.0}),
        ([late(9.0, sigma_s=0.3)], {}),
        ([off(9.0, by_m=0.5)], {}),
        ([late(9.0, by_s=0.3)], {}),
        ([], {}),
    ],
)
def test_nothing_is_said_that_does_not_stand_out(found: list[ToldFixes], others: dict[str, float]) -> None:
    assert misled(found, others) is None


def test_what_stands_out_is_said() -> None:
    for found in (late(-0.5), off(9.0)):
        told = misled([found, off(-2.0)], {"a delay": -3.0})
        assert told is found
