"""The smoothed solution against GTSAM's batch optimum on the same factors.

The noise of a motion depends on the estimate: GTSAM gets it frozen at the solution that it is compared with.
"""

from collections import defaultdict
from collections.abc import Callable
from functools import partial
from typing import Any

import gtsam
import numpy as np
import pytest

from estimator.fusion.memory.prior import SIZES
from estimator.graph.dense import Array, Indices
from estimator.measurements import AnyReading
from estimator.simulate import late_gateway, paper_a
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from tests.estimator.smoothing.windows import fused, in_the_open, problem_of
from tests.estimator.walks import two_responders

NO_OUTLIERS = 1e-200
AGAIN = 10
"""Solutions from the one before: each weighs the readings anew by where it starts from."""
AT_REST = 1e-9


class Blocks:
    """The unknowns as GTSAM's variables: six of a walk and keyframe, three of what stands, of a loss one.

    What a place takes of all powers is one as well; the window finds it by the others.
    """

    def __init__(self, problem: Problem, start: Array) -> None:
        layout, self.size = problem.layout, len(start)
        self.problem, self.start = problem, np.append(start, np.zeros(len(problem.rows.shadows.slab)))
        size = layout.length * layout.width
        self.columns: list[Indices] = []
        self.key_of = np.full(len(self.start), -1)
        for i, walk in enumerate(layout.walks):
            for k in range(walk.first, walk.last + 1):
                self._add(k * layout.width + STATES * i + np.arange(STATES))
        for first in layout.stands.values():
            self._add(size + first + np.arange(3))
        for (kind, _), first in layout.technologies.items():
            self._add(size + first + np.arange(SIZES[kind]))
        for loss in layout.lost.values():
            self._add(size + loss.column + np.arange(1))
        for shadow in range(self.size, len(self.start)):
            self._add(np.array([shadow]))
        self.move(self.start)

    def _add(self, columns: Indices) -> None:
        self.key_of[columns] = len(self.columns)
        self.columns.append(columns)

    def values(self) -> Any:
        found = gtsam.Values()
        for key, columns in enumerate(self.columns):
            found.insert(key, self.start[columns])
        return found

    def flat(self, values: Any) -> Array:
        x = self.start.copy()
        for key, columns in enumerate(self.columns):
            x[columns] = values.atVector(key)
        return x

    def factor(
        self, keys: list[int], sigmas: Any, error: Callable[[], Array], slopes: Callable[[], Array]
    ) -> Any:
        """A factor of errors, m, and derivatives by the columns of its keys, m × n, at `self.at`."""
        columns = [self.columns[key] for key in keys]
        ends = np.cumsum([len(c) for c in columns])

        def called(_this: Any, values: Any, jacobians: Any) -> Array:
            if any((values.atVector(k) != self.at[c]).any() for k, c in zip(keys, columns, strict=True)):
                self.move(self.flat(values))
            if jacobians is not None:
                for i, block in enumerate(np.split(slopes(), ends[:-1], axis=1)):
                    jacobians[i] = np.asfortranarray(block)
            return error()

        return gtsam.CustomFactor(sigmas, keys, called)

    def move(self, x: Array) -> None:
        """Linearise all at once: what a factor says depends on its own keys only."""
        self.at, known = x, x[: self.size]
        self.linear, self.motions = self.problem.linearise(known), self.problem.motions(known)
        self.residual = in_the_open(self.problem.rows, self.linear.residual)
        off = self.of_shadow() >= 0
        self.residual[off] -= x[self.of_shadow()[off]]

    def of_shadow(self) -> Indices:
        """Where what a place takes of each row is among the unknowns; −1: nothing is."""
        shadows = self.problem.rows.shadows
        of = np.append(shadows.of, np.arange(len(shadows.slab)))
        return np.where(of >= 0, self.size + of, -1)


def motion_factors(blocks: Blocks, frozen: Array) -> list[Any]:
    problem = blocks.problem
    layout = problem.layout
    found = []
    for i, (walk, at) in enumerate(zip(layout.walks, problem.motions(frozen), strict=True)):
        for step, noise in enumerate(at.noise):
            first = (walk.first + step) * layout.width + STATES * i
            keys = [int(blocks.key_of[first]), int(blocks.key_of[first + layout.width])]

            def error(i: int = i, step: int = step) -> Array:
                return np.asarray(blocks.motions[i].residual[step])

            def slopes(i: int = i, step: int = step) -> Array:
                return np.hstack([-blocks.motions[i].transition[step], np.eye(STATES)])

            found.append(blocks.factor(keys, gtsam.noiseModel.Gaussian.Covariance(noise), error, slopes))
    return found


def row_factors(blocks: Blocks) -> list[Any]:
    """The readings, those of the same variables in one factor."""
    layout, rows = blocks.problem.layout, blocks.problem.rows
    size = layout.length * layout.width
    inside = rows.columns < layout.width
    flat = np.where(
        inside, rows.slab[:, None] * layout.width + rows.columns, size + rows.columns - layout.width
    )
    flat[rows.columns < 0] = -1
    flat = np.column_stack([flat, blocks.of_shadow()])
    alike: dict[tuple[int, ...], list[int]] = defaultdict(list)
    for row, columns in enumerate(flat):
        alike[tuple(np.unique(blocks.key_of[columns[columns >= 0]]).tolist())].append(row)
    found = []
    for keys, members in alike.items():
        chosen = np.array(members)
        own = np.concatenate([blocks.columns[key] for key in keys])
        belongs = (flat[chosen][:, :, None] == own).astype(np.float64)

        def error(chosen: Indices = chosen) -> Array:
            return -blocks.residual[chosen]

        def slopes(chosen: Indices = chosen, belongs: Array = belongs) -> Array:
            by = np.column_stack([blocks.linear.jacobian[chosen], np.ones(len(chosen))])
            return np.asarray(np.einsum("mc,mcn->mn", by, belongs))

        sigmas = gtsam.noiseModel.Diagonal.Sigmas(rows.sigma[chosen])
        found.append(blocks.factor(list(keys), sigmas, error, slopes))
    return found


def prior_factors(blocks: Blocks) -> list[Any]:
    problem = blocks.problem
    by_column = dict(
        zip(problem._at.tolist(), zip(problem._mean, problem._information, strict=True), strict=True)
    )
    found = []
    for key, columns in enumerate(blocks.columns):
        if int(columns[0]) in by_column:
            mean, information = np.array([by_column[c] for c in columns.tolist()]).T
            found.append(
                gtsam.PriorFactorVector(key, mean, gtsam.noiseModel.Diagonal.Precisions(information))
            )
    return found


def loss_factors(blocks: Blocks) -> list[Any]:
    """What is known of losses: of each what it is more than others."""
    lost, found = blocks.problem.lost, []
    for columns, signs, sigma, gains in zip(
        lost.columns, lost.jacobian, lost.noise[0], lost.gains, strict=True
    ):
        keys = blocks.key_of[lost.size + columns[columns >= 0]].tolist()

        def error(columns: Indices = columns, signs: Array = signs, gains: bool = gains) -> Array:
            more = float(signs @ blocks.at[lost.size + columns])
            return np.array([max(more, 0.0) if gains else more])

        def slopes(columns: Indices = columns, signs: Array = signs, gains: bool = gains) -> Array:
            counts = not gains or signs @ blocks.at[lost.size + columns] > 0.0
            return np.asarray(signs[columns >= 0][None] * counts)

        noise = gtsam.noiseModel.Isotropic.Sigma(1, float(sigma))
        found.append(blocks.factor(keys, noise, error, slopes))
    return found


def optimum(problem: Problem, start: Array, frozen: Array) -> Array:
    """GTSAM's optimum, flat."""
    blocks = Blocks(problem, start)
    graph = gtsam.NonlinearFactorGraph()
    told = row_factors(blocks) + prior_factors(blocks) + loss_factors(blocks)
    for factor in motion_factors(blocks, frozen) + told:
        graph.add(factor)
    settings = gtsam.LevenbergMarquardtParams()
    settings.setRelativeErrorTol(1e-12)
    settings.setAbsoluteErrorTol(1e-12)
    optimizer = gtsam.LevenbergMarquardtOptimizer(graph, blocks.values(), settings)
    values = optimizer.optimize()
    return blocks.flat(values)[: blocks.size]


def paper_a_walk() -> list[AnyReading]:
    return [r for r in paper_a.build(1).readings if r.t <= 120.0]


def ranges_to_unknown_beacons() -> list[AnyReading]:
    return two_responders(40)


def misfit(problem: Problem, x: Array) -> float:
    """The cost but for its constant: half the sum of squares."""
    linear = problem.linearise(x)
    constant = float(
        np.log(problem.rows.sigma).sum() + np.log(problem.lost.noise[0][~problem.lost.gains]).sum()
    )
    return problem.cost(x, linear.residual, problem.motions(x)) - constant


def powers_among_walls() -> list[AnyReading]:
    return [r for r in late_gateway.build(1).readings if r.t <= 60.0]


@pytest.fixture(scope="module", params=[paper_a_walk, ranges_to_unknown_beacons, powers_among_walls])
def problem(request: pytest.FixtureRequest) -> Problem:
    found = problem_of(fused(request.param()))
    found.rows.noise[:, 0] = found.lost.noise[1] = NO_OUTLIERS
    return found


def test_the_smoothed_solution_costs_no_more_than_gtsams_optimum(problem: Problem) -> None:
    start = problem.layout.start()
    ours = problem.solve(start, METRES_OFF)
    theirs = optimum(problem, start, ours.x)
    assert misfit(problem, ours.x) <= 1.001 * misfit(problem, theirs)


def test_what_places_take_of_powers_is_among_what_is_compared() -> None:
    assert len(problem_of(fused(powers_among_walls())).rows.shadows.slab) > 10


def test_solved_until_it_rests_everything_is_where_gtsam_puts_it(problem: Problem) -> None:
    """Beside a radio powers have an edge, and optima on both sides of it: GTSAM's better one counts."""
    layout, start = problem.layout, problem.layout.start()
    begun = problem.solve(start, METRES_OFF)
    ours = begun
    for _ in range(AGAIN):
        ours = problem.solve(ours.x, resting=AT_REST)
    theirs = min((optimum(problem, x, ours.x) for x in (start, begun.x)), key=partial(misfit, problem))
    size = layout.length * layout.width
    off = np.abs(ours.x - theirs)
    stands = size + max(layout.stands.values()) + 3
    assert off[:size].reshape(-1, STATES)[:, :3].max() < 0.01
    assert off[size:stands].max() < 0.01
