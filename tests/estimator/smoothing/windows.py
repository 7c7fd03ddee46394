"""Readings made into the least-squares problem of their window, as the smoothed view makes them."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from scipy.linalg import block_diag

from estimator.fusion.memory.prior import Prior
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements import AnyReading
from estimator.measurements.node import Node
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.first_pass import FirstPass
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.readings.rows import Rows
from estimator.smoothing.window_extent import spacing_s


def entered(east_m: float = 0.0, north_m: float = 0.0, node: str = "ff1") -> Node:
    """A responder enters at a known place, facing where its unit says."""
    place = (east_m, north_m, 0.0)
    return Node(t=0.0, node=node, role="responder", position_m=place, sigma_m=0.05, heading_sigma_rad=0.01)


def fused(readings: Sequence[AnyReading]) -> FusionState:
    """What the first pass leaves of an incident."""
    return FirstPass().ended(sorted(readings, key=lambda r: r.t))


def problem_of(state: FusionState, since_t: float | None = None, prior: Prior | None = None) -> Problem:
    """The window from `since_t` on; None: the whole incident."""
    begins = state.ledger.table("begins")
    first = float(begins[:, 0].min()) if since_t is None else since_t
    layout = Layout(state, first, spacing_s(state), prior)
    rows = Rows(layout, -math.inf if since_t is None else since_t)
    rows.learn(state.noise)
    return Problem(layout, rows, prior)


def at_rest(problem: Problem, x: Array, rest: float = 1e-11, share: float = 0.5) -> Solution:
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
    length, width = len(chain.strands[0].diagonal), chain.width
    size = length * width
    whole = np.zeros((size + chain.lasting, size + chain.lasting))
    for strand in chain.strands:
        rest = size + strand.group.lasting
        whole[np.ix_(rest, rest)] += strand.corner
        for j in range(length):
            own = j * width + strand.group.columns
            whole[np.ix_(own, own)] = strand.diagonal[j]
            whole[np.ix_(own, rest)] = strand.border[j]
            whole[np.ix_(rest, own)] = strand.border[j].T
            if j + 1 < length and len(own):
                link = block_diag(*strand.link[j])
                whole[np.ix_(own + width, own)], whole[np.ix_(own, own + width)] = link, link.T
    return whole, chain.slope()


def in_the_open(rows: Rows, residual: Array) -> Array:
    """Residuals of rows with nothing taken off them for shadows."""
    found, shared = residual.copy(), rows.lying
    found[shared.rows] -= residual[np.repeat(shared.own, np.diff(shared.ends))]
    found[shared.own] = 0.0
    return found


def unlikelihood(problem: Problem, solved: Solution) -> float:
    """−log marginal likelihood up to a constant, at a given estimate: cost + ½ log |H| + ½ Σ log |Q|."""
    motions = problem.motions(solved.x)
    chain = problem.assemble(solved.x, solved.linear, solved.weighted, motions)
    matrix, _ = dense(chain)
    scale = 1.0 / np.sqrt(np.diagonal(matrix))
    half = float(np.log(np.diagonal(np.linalg.cholesky(matrix * scale * scale[:, None])) / scale).sum())
    cost = problem.cost(solved.x, solved.linear.residual, motions)
    return cost + half + 0.5 * sum(float(np.linalg.slogdet(m.noise)[1].sum()) for m in motions)


def difference(function: Callable[[Array], Array], x: Array, step: float = 1e-5) -> Array:
    """Central differences, outputs × inputs."""
    columns = [(function(x + step * e) - function(x - step * e)) / (2.0 * step) for e in np.eye(len(x))]
    return np.stack(columns, axis=-1)


def random_state(problem: Problem, seed: int) -> Array:
    """Somewhere about the estimate, so far off that nothing is small."""
    chance = np.random.default_rng(seed)
    layout = problem.layout
    x = layout.start()
    keyframes = x[: layout.length * layout.width].reshape(layout.length, -1, STATES)
    keyframes[:, :, :3] += chance.normal(0.0, 3.0, keyframes[:, :, :3].shape)
    keyframes[:, :, 3:] += chance.normal(0.0, 0.1, keyframes[:, :, 3:].shape)
    x[layout.length * layout.width :] += chance.normal(0.0, 0.3, layout.border)
    return x
