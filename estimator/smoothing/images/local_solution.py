"""The solution of a window that an estimate leads to, as long as it may be one."""

from estimator.fusion import physics
from estimator.graph.dense import Array
from estimator.smoothing.images.earlier_images import ITERATIONS
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

SOON = 4
"""Iterations after which an estimate is given up that is hopeless."""
HOPELESS = 50.0
"""What it costs more then, in log likelihood, than a solution that is known."""


def local_solution(
    problem: Problem, x: Array, slacks_m: tuple[float, ...], known: Solution
) -> Solution | None:
    """The solution that an estimate leads to; None where there is none, or none that may be.

    Args:
        problem: of the window.
        x: the estimate, flat.
        slacks_m: how far off it may be at first, see `Problem.solve`.
        known: a solution.
    """
    try:
        there = problem.solve(x, slacks_m, len(slacks_m) + SOON)
        if there.cost > known.cost + HOPELESS:
            return None
        if not (there.rests or there.stuck):
            there = problem.solve(there.x, iterations=ITERATIONS)
    except ValueError:
        # It hangs in the air there.
        return None
    return there if is_law(problem.layout, there.x) or not is_law(problem.layout, known.x) else None


def is_law(layout: Layout, x: Array) -> bool:
    """Whether powers fall with the distance in an estimate, flat, as those of radios do.

    By a law that is nearly flat, everybody's way may lead past on top of the radios that seem strong just
    then: it fits better than the true one.
    """
    size = layout.length * layout.width
    starts = [size + start for (kind, _), start in layout.technologies.items() if kind == "rssi"]
    return all(float(x[start + 1]) > physics.RSSI_EXPONENT_LEAST for start in starts)
