"""The smoothed view: the whole incident solved again with everything known now.

Gauss-Newton over keyframes a second apart of every moving node, with the same residuals, noises and motion
as the online tracker; the normal equations are a chain with a border (`estimator.smoothing.chain`).
"""

import math
from collections.abc import Sequence

import numpy as np

from estimator.estimate import TrackPoint
from estimator.fusion.introduce import tuple_of, upper_triangle
from estimator.fusion.order import entry, key
from estimator.fusion.rows import Rows
from estimator.fusion.tick import names_of
from estimator.graph.dense import Array
from estimator.graph.robust import Weighted, weigh
from estimator.graph.variable import Variable
from estimator.measurements import AnyReading
from estimator.smoothing.chain import Chain
from estimator.smoothing.pace import online_pass
from estimator.smoothing.problem import STATES, Problem
from estimator.smoothing.readings import Offsets, Readings, Where
from estimator.smoothing.walks import motion_of
from estimator.trackers.base import TrackerSettings

SLACK_M = (3.0, 1.0, 0.3)
"""How far off the start may be, step by step, so that good readings are not taken for outliers."""
ITERATIONS = 15
REST_M = 0.02
LONGEST_S = 86_400.0
"""No incident lasts longer: a reading farther than a day from the others has a wrong epoch."""
HALVINGS = 5


class BatchSmoother:
    """Solves a whole incident; see `estimator.trackers.base.Smoother`."""

    def __init__(self, settings: TrackerSettings | None = None) -> None:
        self.settings = settings or TrackerSettings()

    def smooth(self, readings: Sequence[AnyReading]) -> dict[str, list[TrackPoint]]:
        """Every node's track, a point at each whole second from its first to its last reading.

        Nodes whose position is never decided have no track.
        """
        ordered = [e.reading for e in sorted((entry(r) for r in readings), key=key)]
        if ordered:
            middle = ordered[len(ordered) // 2].t
            ordered = [r for r in ordered if abs(r.t - middle) < LONGEST_S]
        pace = online_pass(ordered, self.settings.origin_wgs84)
        problem = Problem(pace, ordered)
        held = Readings(problem, ordered)
        chain, x = _solve(problem, held)
        return _tracks(problem, ordered, chain, x)


def _solve(problem: Problem, held: Readings) -> tuple[Chain, Array]:
    x = problem.x.copy()
    for iteration in range(ITERATIONS):
        slack = SLACK_M[iteration] if iteration < len(SLACK_M) else 0.0
        rows = held.linearise(x)
        weighted = _weigh(held, rows, slack)
        chain = _assemble(problem, rows, weighted, x)
        steps, fixed = chain.solve()
        step = np.concatenate([steps.ravel(), fixed])
        if slack == 0.0:
            before = _cost(problem, held, x)
            for _ in range(HALVINGS):
                if _cost(problem, held, x + step) <= before + 1e-3:
                    break
                step = 0.5 * step
        x = x + step
        if slack == 0.0 and np.abs(step).max(initial=0.0) < REST_M:
            break
    return chain, x


def _weigh(held: Readings, rows: Rows, slack: float) -> Weighted:
    predicted = np.where(held.metric, slack**2, 0.0)
    return weigh(rows.residual, held.sigma, predicted, held.outliers, held.shift, held.spread)


def _cost(problem: Problem, held: Readings, x: Array) -> float:
    """Negative log likelihood up to a constant: mixtures of the readings, and the motion."""
    residual = held.linearise(x).residual
    good = held.sigma**2
    bad = good + held.spread**2
    from_good = np.log1p(-held.outliers) - 0.5 * (np.log(good) + residual**2 / good)
    from_bad = np.log(held.outliers) - 0.5 * (np.log(bad) + (residual - held.shift) ** 2 / bad)
    total = -float(np.logaddexp(from_good, from_bad).sum())
    for column, walk in enumerate(problem.walks):
        motion = motion_of(walk, problem.epochs[walk.first : walk.last + 1], _states(problem, column, x))
        total += 0.5 * float(np.einsum("ki,kij,kj->", motion.residual, motion.information, motion.residual))
    return total


def _states(problem: Problem, index: int, x: Array) -> Array:
    """States of one walk at its keyframes, (k + 1) × 6."""
    walk = problem.walks[index]
    keyframes = x[: len(problem.epochs) * problem.width].reshape(len(problem.epochs), -1)
    return keyframes[walk.first : walk.last + 1, STATES * index : STATES * (index + 1)]


def _assemble(problem: Problem, rows: Rows, weighted: Weighted, x: Array) -> Chain:
    length, width = len(problem.epochs), problem.width
    chain = Chain(length, width, problem.border)
    chain.diagonal[:, range(width), range(width)] = 1.0
    for index, walk in enumerate(problem.walks):
        own = slice(STATES * index, STATES * (index + 1))
        chain.diagonal[walk.first : walk.last + 1, own, own] = 0.0
        motion = motion_of(walk, problem.epochs[walk.first : walk.last + 1], _states(problem, index, x))
        pulled = np.matmul(motion.transition.transpose(0, 2, 1), motion.information)
        chain.diagonal[walk.first : walk.last, own, own] += np.matmul(pulled, motion.transition)
        chain.diagonal[walk.first + 1 : walk.last + 1, own, own] += motion.information
        chain.link[walk.first : walk.last, own, own] = -pulled.transpose(0, 2, 1)
        chain.gradient[walk.first : walk.last, own] += np.einsum("kij,kj->ki", pulled, motion.residual)
        against = np.einsum("kij,kj->ki", motion.information, motion.residual)
        chain.gradient[walk.first + 1 : walk.last + 1, own] -= against
    _scatter(chain, rows, weighted, length * width)
    return chain


def _scatter(chain: Chain, rows: Rows, weighted: Weighted, border: int) -> None:
    """Add HᵀP⁻¹H and HᵀP⁻¹r of all rows; columns below `border` belong to keyframes."""
    width, lasting = chain.diagonal.shape[1], chain.corner.shape[0]
    pulls = rows.jacobian * (weighted.information * weighted.residual)[:, None]
    used = rows.jacobian != 0.0
    moving = used & (rows.columns < border)
    resting = used & (rows.columns >= border)
    np.add.at(chain.gradient.reshape(-1), rows.columns[moving], pulls[moving])
    np.add.at(chain.corner_gradient, rows.columns[resting] - border, pulls[resting])
    for a in range(rows.columns.shape[1]):
        for b in range(rows.columns.shape[1]):
            value = rows.jacobian[:, a] * rows.jacobian[:, b] * weighted.information
            at, to = rows.columns[:, a], rows.columns[:, b]
            both = moving[:, a] & moving[:, b]
            flat = (at[both] * width) + to[both] % width
            np.add.at(chain.diagonal.reshape(-1), flat, value[both])
            mixed = moving[:, a] & resting[:, b]
            np.add.at(chain.border.reshape(-1), at[mixed] * lasting + to[mixed] - border, value[mixed])
            fixed = resting[:, a] & resting[:, b]
            np.add.at(
                chain.corner.reshape(-1), (at[fixed] - border) * lasting + to[fixed] - border, value[fixed]
            )


def _tracks(
    problem: Problem, readings: Sequence[AnyReading], chain: Chain, x: Array
) -> dict[str, list[TrackPoint]]:
    keyframes, lasting = chain.covariances()
    lifetimes = _lifetimes(readings)
    tracks: dict[str, list[TrackPoint]] = {}
    for index, walk in enumerate(problem.walks):
        name = walk.node.node
        first, last = lifetimes[name]
        seconds = np.arange(math.ceil(first), math.floor(last) + 1, dtype=np.float64)
        at = np.searchsorted(problem.epochs, seconds, side="right") - 1
        alive = (at >= walk.first) & (at <= walk.last)
        at, seconds = at[alive], seconds[alive]
        ends = [
            Where(Variable("position", name, float(k)), (0.0, 0.0, 0.0), index, float(t))
            for k, t in zip(at.tolist(), seconds.tolist(), strict=True)
        ]
        columns = at[:, None] * problem.width + STATES * index + np.arange(3)
        places = x[columns] + Offsets(problem, ends).at(x)
        own = slice(STATES * index, STATES * index + 3)
        tracks[name] = [
            TrackPoint(t=t, position_m=tuple_of(p), covariance_m2=upper_triangle(keyframes[k][own, own]))
            for t, p, k in zip(seconds.tolist(), places, at.tolist(), strict=True)
        ]
    border = len(problem.epochs) * problem.width
    for name, blocks in problem.standing.items():
        first, last = lifetimes[name]
        points = []
        for second in range(math.ceil(first), math.floor(last) + 1):
            since = [v for epoch, v in blocks if epoch <= second]
            if since:
                start = problem.starts[since[-1]]
                rows = slice(start - border, start - border + 3)
                covariance = upper_triangle(lasting[rows, rows])
                place = tuple_of(x[start : start + 3])
                points.append(TrackPoint(t=float(second), position_m=place, covariance_m2=covariance))
        tracks[name] = points
    for node in problem.pace.state.nodes.values():
        if node.role == "base" and node.place_m is not None:
            first, last = lifetimes[node.node]
            tracks[node.node] = [
                TrackPoint(t=float(second), position_m=node.place_m, covariance_m2=(0.0,) * 6)
                for second in range(math.ceil(first), math.floor(last) + 1)
            ]
    return {name: points for name, points in tracks.items() if points}


def _lifetimes(readings: Sequence[AnyReading]) -> dict[str, tuple[float, float]]:
    """First and last epoch of each node's readings."""
    lifetimes: dict[str, tuple[float, float]] = {}
    for reading in readings:
        for name in names_of(reading):
            first, last = lifetimes.get(name, (reading.t, reading.t))
            lifetimes[name] = min(first, reading.t), max(last, reading.t)
    return lifetimes
