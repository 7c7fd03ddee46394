"""The ranges of a window that clocks, units and names are asked by."""

import numpy as np

from estimator.fusion.memory.ledger import RANGE
from estimator.smoothing.changes.recent_ranges import RANGES, RecentRanges
from tests.estimator.smoothing.windows import fused, problem_of
from tests.estimator.walks import two_responders


def test_of_nobody_anything_is_told_by_fewer_ranges_than_tell_of_one_radio() -> None:
    problem = problem_of(fused(two_responders(40)))
    solved, pairs = problem.solve(problem.layout.start()), problem.rows.pairs
    ranges = np.flatnonzero(pairs[:, 1] == RANGE)

    problem.rows.pairs = pairs[: ranges[RANGES - 1] + 1]
    assert RecentRanges(problem, solved).enough

    problem.rows.pairs = pairs[: ranges[RANGES - 1]]
    assert not RecentRanges(problem, solved).enough
