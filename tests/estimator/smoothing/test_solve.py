"""Where a solution may start from."""

import numpy as np

from estimator.smoothing.walks import STATES
from tests.estimator.smoothing.test_slips import walk
from tests.estimator.smoothing.windows import fused, problem_of


def test_since_an_epoch_a_unit_goes_its_own_way_and_before_it_nothing_changes() -> None:
    problem = problem_of(fused(walk()))
    layout = problem.layout
    x = layout.start()
    since = int(np.searchsorted(layout.grid, 60.0))
    kinked = x.copy()
    kinked[: layout.length * layout.width].reshape(layout.length, STATES)[since + 1 :, :2] += 5.0
    assert max(np.abs(problem.motions(kinked)[0].residual[since])) > 4.0
    reckoned = problem.reckoned(kinked, float(layout.grid[since]))
    assert np.abs(problem.motions(reckoned)[0].residual[since:]).max() < 1e-9
    before = slice(0, (since + 1) * layout.width)
    assert np.array_equal(reckoned[before], x[before])
    border = slice(layout.length * layout.width, None)
    assert np.array_equal(reckoned[border], x[border])
