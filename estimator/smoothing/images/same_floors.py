"""Solutions of a window are compared with the same floors between radios.

A reading through a floor is worth little, and whether it goes through one is told by heights, once for each
solution. Where nobody measures heights they are hardly more than a guess, and on a stair a decimetre decides:
two solutions that differ by nothing but tens of such guesses differ by tens in log likelihood, and that one
would be sure of.
"""

import numpy as np

from estimator.smoothing.images.earlier_images import CLEARER
from estimator.smoothing.problem.newton import RESTING, Problem
from estimator.smoothing.problem.solution import Solution


def hold_floors(problem: Problem, solved: Solution, resting: float = RESTING) -> Solution:
    """Hold the floors between radios where a solution has them, and give the solution with them there.

    Args:
        problem: of a window; its rows hold them until `Rows.floors` is None again.
        solved: its solution, with floors as they are held, or as they were where it began.
        resting: see `Problem.solve`.

    Raises:
        ValueError: it cannot be solved with them there.
    """
    rows = problem.rows
    held, rows.floors = rows.floors, rows.through(solved.x)
    if held is not None and np.array_equal(held, rows.floors):
        return solved
    rows.widen(solved.x, solved.linear.jacobian)
    moved = abs(problem.at(solved.x).cost - solved.cost) > CLEARER
    found = problem.solve(solved.x, resting=resting) if moved else solved
    if held is not None and found.cost > solved.cost - CLEARER:
        # Heights that follow from floors which follow from heights swing to and fro.
        rows.floors = held
        rows.widen(solved.x, solved.linear.jacobian)
        return solved
    return found
