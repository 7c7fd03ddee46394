"""How likely readings are with ways that nobody measured, whatever these ways are.

What costs least says only how well the best way fits. Among powers and ranges that scatter there always are
heights that fit better than none, and detours, and the more people walk for the longer, the better they fit.
So what is compared is the likelihood of the readings over all ways, log p(z) by Laplace's method (MacKay
1992): of as many ways as are free, few fit.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from estimator.graph.dense import Array
from estimator.smoothing.keyframes.walks import misfit
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.held_heights import UP


class MarginalCost(NamedTuple):
    """What a solution costs over all that it might have been instead, up to a constant.

    Attributes:
        all: −log p(z) of all readings.
        each: its share by the readings of each walk; one between two walks counts for both.
    """

    all: float
    each: Array


def marginal_cost(problem: Problem, solved: Solution, free: Sequence[int] = (UP,)) -> MarginalCost:
    """What a solution costs over all that it might have been instead.

    It is to be compared with others of the same readings and keyframes, whose steps are as noisy but for some
    numbers of a state.

    Args:
        problem: of a window.
        solved: its solution, whose chain is eliminated here.
        free: these numbers: heights.
    """
    rows, walks = problem.rows, problem.layout.walks
    solved.chain.reduce()
    walked, border = solved.chain.log_determinants()
    costs, own = problem.costs(solved.linear.residual), np.zeros(len(walks))
    for i, (walk, motion) in enumerate(zip(walks, solved.motions, strict=True)):
        own[i] = costs[rows.of([walk.number])].sum() + misfit(motion)
        if walk.way is not None:
            walked[i] += sum(np.log(motion.noise[:, c, c]).sum() for c in free)
    return MarginalCost(solved.cost + 0.5 * (border + float(walked.sum())), own + 0.5 * walked)
