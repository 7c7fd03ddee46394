"""A slip is told from a wall before an anchor, and at the step that slipped."""

import pytest

from estimator.smoothing.learning.slips import withdraw
from tests.estimator.smoothing.learning.test_wrong_steps import AT_S, said, slips_of, walk
from tests.estimator.smoothing.windows import fused


def test_a_wall_before_one_anchor_is_no_stumble() -> None:
    texts, _ = said(walk(too_long_m={"east": 1.0}))
    assert texts == []


@pytest.mark.parametrize("seed", range(1, 4))
def test_a_stumble_of_which_one_anchor_tells_most_is_found(seed: int) -> None:
    """What walls take of its ranges is asked: else, that anchor left out, two of them would stay unfound."""
    texts, _ = said(walk((0.0, -1.2), seed=seed))
    assert len(texts) == 1


@pytest.mark.parametrize("seed", range(1, 7))
def test_a_slip_is_told_at_the_step_that_slipped_and_not_at_one_beside_it(seed: int) -> None:
    """Told by keyframes, which stand two seconds apart, five of them would be the step before."""
    state = fused(walk((1.0, 0.0), seed=seed))
    withdraw(state)
    (slip,) = slips_of(state)
    assert slip.t == pytest.approx(AT_S - 0.5, abs=0.5)
