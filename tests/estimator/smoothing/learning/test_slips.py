"""Slips that are taken back."""

from estimator.smoothing.learning.slips import Slip, widen_steps, withdraw
from tests.estimator.smoothing.learning.test_wrong_steps import SECONDS, walk
from tests.estimator.smoothing.windows import fused


def test_slips_that_are_taken_back_leave_the_steps_as_they_were_reported() -> None:
    state = fused(walk(slipped=(1.0, 0.5)))
    withdraw(state)
    reported = state.ledger.table("steps").copy()
    widen_steps(state, [Slip(1, 20.0, (1.0, 0.0)), Slip(1, 60.0, (0.0, 1.0))])
    assert len(state.ledger.table("steps")) == len(reported) + 2
    withdraw(state)
    assert (state.ledger.table("steps") == reported).all()
    assert len(reported) == SECONDS
