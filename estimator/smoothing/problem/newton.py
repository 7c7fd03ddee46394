"""Newton's method on a window: robust, with shares of steps and Marquardt's damping, until it rests."""

from functools import partial

import numpy as np

from estimator.graph.dense import Array
from estimator.graph.robust import Weighted
from estimator.smoothing.problem.objective import Objective
from estimator.smoothing.problem.search_direction import Direction, NewtonStep, conjugate_step
from estimator.smoothing.problem.solution import Solution, Trial
from estimator.smoothing.readings.linearised import Linearised

ACCEPTED = 1e-3
"""Rise of the negative log likelihood that counts as rounding."""
RESTING = 0.001
NEAR = 1.0
"""A step that gains less in log likelihood was near enough for negative curvature to mean something."""
LEAST_SHARE, FARTHEST = 0.1, 4.0
"""Shares of a step between which the cost is looked for at its lowest."""
CLOSE = 0.3
"""A step is good enough where the lowest cost is within this share of it."""
NOWHERE = 1e9
"""No place, angle or speed is a larger number: coordinates end at a hundred kilometres."""
LEAST_DAMPING = 1e-3
UPHILL = 2
"""So many steps in a row that lead uphill, and the search is stuck: first-estimate Jacobians are not the
slope of the cost, and shorter steps have gained nothing that counts (decision 0132)."""
METRES_OFF = (3.0, 1.0, 0.3, 0.1)
"""Slacks for a start that may be metres off, or bent by as much (m)."""


class Problem(Objective):
    """The least-squares problem of a window, which can be solved."""

    def solve(
        self,
        x: Array,
        slacks_m: tuple[float, ...] = (),
        iterations: int = 20,
        resting: float = RESTING,
        kinked: Array | None = None,
    ) -> Solution:
        """Newton's method with the positive part of the curvature, until a step promises too little.

        Args:
            x: where to start, flat.
            slacks_m: how far off the start may be, step by step, so that good readings are not taken for
                outliers.
            iterations: at most so many steps.
            resting: promised gain in log likelihood ε at which it ends: no number with standard deviation σ
                is then farther than √(2 ε) σ from where its step leads.
            kinked: another estimate, flat: where readings differ by it, each is as unsure at the start as
                that; None: it is as good as can be.

        Returns:
            A solution that costs no more than the start.
        """
        search = _Search(self, x, resting)
        begun = search.here.cost
        doubt = None if kinked is None else (self.rows.residual(kinked) - search.here.residual) ** 2
        for iteration in range(iterations):
            slack_m = slacks_m[iteration] if iteration < len(slacks_m) else 0.0
            if not search.advance(slack_m, doubt if iteration == 0 else None):
                break
        if slacks_m and search.here.cost > begun + ACCEPTED:
            # Whole steps, uphill or not, have led it away.
            return self.solve(x, (), iterations, resting)
        return search.solution()


class _Search:
    """The search for the best estimate, and how far it has come.

    Args:
        objective: of the window; its rows are told what the start says of their noise.
        x: where to start, flat.
        resting: see `Problem.solve`.

    Attributes:
        here: the estimate.
    """

    def __init__(self, objective: Objective, x: Array, resting: float) -> None:
        jacobian = objective.jacobian(x)
        objective.rows.widen(x, jacobian)
        self.here = objective.at(x)
        self._objective, self._resting = objective, resting
        self._linear = Linearised(self.here.residual, lambda: jacobian)
        self._damping, self._near, self._rests, self._uphill = 0.0, False, False, 0
        self._before: tuple[NewtonStep, Array] | None = None

    def advance(self, slack_m: float, doubt: Array | None) -> bool:
        """Go a step, or damp the next one where this one leads uphill; False: no further one helps.

        Args:
            slack_m: how far off the estimate may be: then the whole step is gone, uphill or not.
            doubt: variance of each reading by where the search has started, m.
        """
        weighted = self._objective.weigh(self.here.residual, slack_m, doubt)
        newton = self._newton_step(weighted, self._near and slack_m == 0.0)
        direction = Direction(newton.step, newton.promised)
        if self._before:
            direction = conjugate_step(newton, *self._before)
        led = self.here.x + direction.step
        if not np.abs(led).max(initial=0.0) < NOWHERE:
            # Readings contradict each other beyond all measure: no step helps.
            return False
        there = self._objective.at(led)
        if slack_m == 0.0:
            if newton.promised > self._resting:
                there = self._lowest_along(direction, there)
            if not there.cost <= self.here.cost + ACCEPTED:
                # The parabola reaches farther than it holds: shorter steps, and more along the slope.
                self._damping, self._before = max(10.0 * self._damping, LEAST_DAMPING), None
                self._uphill += 1
                return self._uphill < UPHILL
        self._uphill = 0
        self._before = None if slack_m > 0.0 or self._damping > 0.0 else (newton, direction.step)
        self._near = self.here.cost - there.cost < NEAR
        self.here = there
        self._linear = Linearised(there.residual, partial(self._objective.jacobian, there.x))
        promised_little = newton.promised < self._resting and self._damping <= LEAST_DAMPING
        self._rests = slack_m == 0.0 and promised_little
        self._damping = 0.1 * self._damping if self._damping > LEAST_DAMPING else 0.0
        return not self._rests

    def solution(self) -> Solution:
        """Where it has led, with the normal equations there."""
        objective, here, linear = self._objective, self.here, self._linear
        weighted = objective.weigh(here.residual)
        assemble = partial(objective.assemble, here.x, linear, weighted, here.motions)
        ends = self._rests, self._uphill == UPHILL
        return Solution(here.x, linear, weighted, here.motions, here.cost, *ends, assemble)

    def _newton_step(self, weighted: Weighted, near: bool) -> NewtonStep:
        """A Newton step.

        Args:
            weighted: how the rows are weighed.
            near: it is near the optimum: negative curvature counts, as long as the whole stays positive.
        """
        objective, here = self._objective, self.here
        for signed in (True, False) if near else (False,):
            chain = objective.assemble(here.x, self._linear, weighted, here.motions)
            objective.add_curvature(chain, here.x, weighted, signed)
            slope = chain.slope()
            chain.damp(self._damping)
            try:
                steps, fixed = chain.solve(mend=not signed)
            except ValueError:
                if not signed:
                    raise
                continue
            break
        return NewtonStep(np.concatenate([steps.ravel(), fixed]), slope, chain.promised)

    def _lowest_along(self, direction: Direction, there: Trial) -> Trial:
        """The lower one of a step's end and of where the cost is likely to be lowest along it.

        The parabola through the cost here, its slope and the cost there tells where.
        """
        promised, gained = direction.promised, self.here.cost - there.cost
        share = promised / max(2.0 * promised - gained, promised / FARTHEST)
        if abs(share - 1.0) > CLOSE:
            other = self._objective.at(self.here.x + max(share, LEAST_SHARE) * direction.step)
            return min(there, other, key=lambda trial: trial.cost)
        return there
