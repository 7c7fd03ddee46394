"""Readings made into the least-squares problem of their window, as the smoothed view makes them."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag

from estimator.fusion.prior import Prior
from estimator.fusion.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.smoothing.chain import Chain
from estimator.smoothing.extent import spacing_s
from estimator.smoothing.layout import Layout
from estimator.smoothing.rows import Rows
from estimator.smoothing.solve import Problem, Solved
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import online_pass


def fused(readings: Sequence[AnyReading]) -> FusionState:
    """What the online pass leaves of an incident."""
    return online_pass(sorted(readings, key=lambda r: r.t), TrackerSettings())


def problem_of(state: FusionState, since_t: float | None = None, prior: Prior | None = None) -> Problem:
    """The window from `since_t` on; None: the whole incident."""
    begins = state.ledger.table("begins")
    first = float(begins[:, 0].min()) if since_t is None else since_t
    layout = Layout(state, first, spacing_s(state), prior)
    rows = Rows(layout, -math.inf if since_t is None else since_t)
    rows.learn(state.noise)
    return Problem(layout, rows, prior)


def at_rest(problem: Problem, x: Array, rest: float = 1e-11, share: float = 0.5) -> Solved:
    """The solution, iterated until nothing at all moves any more.

    Args:
        problem: of the window.
        x: where to start, flat.
        rest: no number moves by more.
        share: of each Gauss-Newton step that is taken: heights that ranges tell swing to and fro with more.
    """
    for _ in range(200):
        linear, motions = problem.linearise(x), problem.motions(x)
        problem.rows.widen(x, linear.jacobian)
        steps, fixed = problem.assemble(x, linear, problem.weigh(linear.residual), motions).solve()
        step = np.concatenate([steps.ravel(), fixed])
        x = x + share * step
        if np.abs(step).max() < rest * (1.0 + np.abs(x).max()):
            return problem.solve(x, iterations=0)
    raise AssertionError("the window does not come to rest")


def dense(chain: Chain) -> tuple[Array, Array]:
    """A chain that is not solved yet as one matrix and its gradient."""
    length, width, border = chain.border.shape
    size = length * width
    whole = np.zeros((size + border, size + border))
    for j in range(length):
        own = slice(j * width, (j + 1) * width)
        whole[own, own] = chain.diagonal[j]
        whole[own, size:] = chain.border[j]
        whole[size:, own] = chain.border[j].T
        if j + 1 < length:
            after = slice((j + 1) * width, (j + 2) * width)
            link = block_diag(*chain.link[j])
            whole[after, own], whole[own, after] = link, link.T
    whole[size:, size:] = chain.corner
    return whole, np.concatenate([chain.gradient.ravel(), chain.corner_gradient])
