"""The estimates that a window's solution is sought from: the likeliest of what they lead to counts."""

from collections.abc import Iterable

import numpy as np

from estimator.fusion import physics
from estimator.fusion.learned.calibration import UNTOLD, bias_sigma_m
from estimator.fusion.learned.gyros import bias_sigma_radps
from estimator.graph.dense import Array
from estimator.smoothing.images.solutions import SLACKS_M
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.priors import scale_variance
from estimator.smoothing.keyframes.walks import BIAS, SCALE, STATES
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.units.own_ways import own_ways

ITERATIONS = 8
"""Most windows rest after two or three steps. Among walls little holds a map: left after four, one was 17 m
off where it would have rested 9 m off."""
RESTING = 0.1
"""A window that gains less in log likelihood is solved again soon anyway."""
STRANGE = 2.5
"""Standard deviations from what is usual that one number of eighty is off by."""


def solved_from(problem: Problem, x: Array, solved_t: float, bent: bool) -> Solution:
    """The likeliest solution of some starts: the filter's estimate, dead reckoning, all as it usually is.

    The filter may have turned the map, of which what was solved before knows nothing: the kink between the
    two can bend everything, and turn the map further with each solution.

    A reading that has led the filter far away lies between keyframes that know nothing of it and those that
    do: it is held against a start that is as unsure as that, or it would be an outlier for ever. So is what
    was bent by readings of a node that turned out to lie elsewhere.

    Args:
        problem: of the window.
        x: where the filter has led to, flat.
        solved_t: when the window was last solved (s).
        bent: something has just been told that may have bent it all.
    """
    free = any(walk.way is None for walk in problem.layout.walks)
    slacks = SLACKS_M if free else ()
    kinked = problem.going.kinked(x, physics.TICK_S)
    solved = problem.solve(x, slacks, len(slacks) + ITERATIONS, RESTING, kinked)
    reckoned = problem.going.reckoned(x, solved_t)
    if problem.at(reckoned).cost < solved.cost:
        other = problem.solve(reckoned, slacks, len(slacks) + ITERATIONS, RESTING)
        solved = min(solved, other, key=lambda found: found.cost)
    if bent:
        straight = problem.solve(solved.x, METRES_OFF, len(METRES_OFF) + ITERATIONS, RESTING)
        solved = min(solved, straight, key=lambda found: found.cost)
    usual = as_usual(problem, solved.x)
    if usual is not None:
        other = problem.solve(usual, SLACKS_M, len(SLACKS_M) + ITERATIONS, RESTING)
        solved = min(solved, other, key=lambda found: found.cost)
    return solved


def as_usual(problem: Problem, x: Array) -> Array | None:
    """An estimate with all units and ranging radios as they usually are, flat; None: hardly one is not.

    One echo that came first, of a radio of which nobody knows yet how its ranges are scaled, has all those
    that follow look like echoes, and a crawl told too short. A gyro's bias may bend a way round the other
    side of all that is heard. Neither finds back by itself.

    Args:
        problem: of the window, which is to reach back to where everybody began.
        x: its solution, flat.
    """
    if problem.prior is not None:
        return None
    layout, there = problem.layout, x.copy()
    led = {walk.number: i for i, walk in enumerate(layout.walks) if walk.way is not None}
    usual = _usual(layout, led.values())
    at, sigma = np.array(list(usual), dtype=np.intp), np.array(list(usual.values()))
    if not (abs(x[at]) > STRANGE * sigma).any():
        return None
    there[at] = 0.0
    return own_ways(problem, there, led)


def _usual(layout: Layout, led: Iterable[int]) -> dict[int, float]:
    """Where in an estimate, flat, numbers are that are usually nil, and their standard deviations.

    Args:
        layout: of the window.
        led: indices of walks that units lead.
    """
    state, size, found = layout.state, layout.length * layout.width, dict[int, float]()
    for i in led:
        walk = layout.walks[i]
        start = walk.first * layout.width + STATES * i
        others = [other.bias_told for other in state.lives() if other.index != walk.number]
        found[start + BIAS] = bias_sigma_radps(UNTOLD, others)
        found[start + SCALE] = scale_variance(layout, i) ** 0.5
    for (kind, number), start in layout.technologies.items():
        if kind == "range":
            name = state.sources[number]
            found[size + start] = state.narrow_sigma(name)
            found[size + start + 1] = bias_sigma_m(name)
    return found
