"""Whether most ranges agree with another way: half of those of a name that two radios answer to never do."""

import numpy as np

from estimator.fusion.memory.ledger import RANGE
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

MOST = 0.75


def ranges_agree(problem: Problem, solved: Solution, number: int, since_t: float) -> bool:
    """Whether most ranges of a walk's radio are good ones; where there are none nothing disagrees.

    Args:
        problem: of a window.
        solved: its solution.
        number: of the walk's node.
        since_t: only those that are later (s).
    """
    pairs = problem.rows.pairs
    mine = (pairs[:, 1] == RANGE) & (pairs[:, 0] > since_t) & (pairs[:, 2:4] == number).any(axis=1)
    return not mine.any() or bool(np.mean(solved.weighted.good[: len(pairs)][mine]) > MOST)
