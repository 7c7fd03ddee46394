"""Newton steps over a window: readings, motion and priors at once, robust, until it rests."""

from copy import copy
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.memory.prior import Prior
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import Weighted, prior_cost, total_cost
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.chain.strand import Strand, WalkMotion
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.motions import Motions
from estimator.smoothing.keyframes.priors import own_priors
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.keyframes.walks import Motion, misfit
from estimator.smoothing.problem.held_quadratic import HeldQuadratic
from estimator.smoothing.problem.marginal_prior import MarginalPrior
from estimator.smoothing.problem.search_direction import NewtonStep, conjugate_step
from estimator.smoothing.problem.solution import Solution, Trial
from estimator.smoothing.problem.sparsity import Sparsity
from estimator.smoothing.readings.curvature import add_curvature
from estimator.smoothing.readings.rows import Linearised, Rows
from estimator.smoothing.readings.weights import weigh_readings

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
LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e3


class Problem:
    """The least-squares problem of a window.

    Attributes:
        layout: its unknowns.
        rows: its readings.
        prior: what is known from before; None: nothing is.
        going: how its walks go.
        left_out: rows that do not count.
        aside: what readings say of the border that are not looked at; None: all of them are.
    """

    def __init__(self, layout: Layout, rows: Rows, prior: Prior | None) -> None:
        self.layout, self.rows, self.prior = layout, rows, prior
        known = () if prior is None else prior.keys
        self._at, self._mean, self._information = own_priors(layout, known)
        self.going = Motions(layout)
        self._carried = None if prior is None else MarginalPrior(layout, prior)
        self.left_out: Integers = np.zeros(0, dtype=np.int64)
        self.aside: HeldQuadratic | None = None

    def without(self, left_out: Integers) -> Self:
        """The same problem without some of its rows; the rows themselves are shared."""
        other = copy(self)
        other.left_out = left_out
        return other

    def part(self, numbers: Unknowns, x: Array, chosen: NDArray[np.bool_], left: HeldQuadratic) -> Self:
        """Some walks by themselves up to some keyframe, with all others held where they are.

        Args:
            numbers: of the part.
            x: the estimate, flat, in which the others are held.
            chosen: rows that it has; no others depend on what moves in it.
            left: what others say of the border.
        """
        other, at = copy(self), numbers.place[self._at]
        vars(other).pop("coupled", None)
        other.layout, other.going = numbers.layout, self.going.part(numbers)
        other.rows, other.aside = self.rows.part(numbers, x, chosen), left
        vars(other).update(
            _at=at[at >= 0],
            _mean=self._mean[at >= 0],
            _information=self._information[at >= 0],
            _carried=None if self._carried is None else self._carried.part(numbers, x),
        )
        return other

    @cached_property
    def coupled(self) -> Sparsity:
        """How its unknowns hang together."""
        return Sparsity(self.layout, self.rows, self._at, self._carried)

    def motions(self, x: Array) -> list[Motion]:
        """Each walk's motion at an estimate."""
        return self.going.motions(x)

    def cost(self, x: Array, residual: Array, motions: list[Motion]) -> float:
        """Negative log likelihood up to a constant: mixtures of the readings, motion, priors."""
        rows = self.rows
        total: float = total_cost(self.left_out, residual, rows.sigma, *rows.noise.T)
        total += prior_cost(x, self._at, self._mean, self._information)
        for motion in motions:
            total += misfit(motion)
        if self._carried is not None:
            total += self._carried.cost(x)
        if self.aside is not None:
            total += self.aside.cost(x[self.layout.length * self.layout.width :])
        return total

    def linearise(self, x: Array) -> Linearised:
        """The rows at an estimate, with first-estimate Jacobians (decision 0006).

        Where the prior was linearised, turned as the map has been since: where new derivatives by the same
        numbers were taken elsewhere, their sum would know what nobody has measured, as where north is.
        """
        return Linearised(self._jacobian(x), self.rows.residual(x))

    @property
    def pivot_m(self) -> Array:
        """What the map is turned about, east and north, 2 (m)."""
        return self._carried.pivot_m if self._carried else np.array(self.layout.state.base_place()[:2])

    def first(self, x: Array) -> Array:
        """Where rows are linearised at an estimate, flat."""
        return x if self._carried is None else self._carried.first(x)

    def _jacobian(self, x: Array) -> Array:
        return self.rows.jacobian(self.first(x))

    def weigh(self, residual: Array, slack_m: float = 0.0, doubt: Array | None = None) -> Weighted:
        """E-step of the readings' noise, as large as the estimate may be off; see `weigh_readings`."""
        weighted = weigh_readings(self.rows, residual, slack_m, doubt)
        weighted.information[self.left_out] = 0.0
        return weighted

    def assemble(
        self,
        x: Array,
        linear: Linearised,
        weighted: Weighted,
        motions: list[Motion],
        until: int | None = None,
    ) -> Chain:
        """The normal equations at an estimate.

        Args:
            x: the estimate, flat.
            linear: the rows there.
            weighted: how they are weighed.
            motions: the walks' motion there.
            until: leave out what refers to anything after this keyframe, and itself but for the way to it.
        """
        layout, rows = self.layout, self.rows
        length = layout.length if until is None else until + 1
        chain = Chain(length, layout.width, self.coupled.groups.each, layout.state.ledger.complete)
        ways: list[list[WalkMotion]] = [[] for _ in chain.strands]
        for i, (walk, motion) in enumerate(zip(layout.walks, motions, strict=True)):
            group, block = self.coupled.groups.home(i)
            ways[group].append(WalkMotion(block, walk.first, walk.last, motion))
        chain.each(Strand.add_motions, ways)
        if self._carried is not None:
            self._carried.add(chain, self.coupled.shared, x)
        if self.aside is not None:
            self.aside.add(chain, x[layout.length * layout.width :])
        placed, information = self.coupled.rows, weighted.information
        known, certain = self.coupled.priors, self._information
        if until is not None:
            information = np.where(rows.t < layout.grid[until], information, 0.0)
            certain = np.where(known.slab <= until, certain, 0.0)
            placed = placed._replace(slab=np.minimum(placed.slab, until))
            known = known._replace(slab=np.minimum(known.slab, until))
        off, ones = self._mean - x[self._at], np.ones((len(self._at), 1))

        def add(strand: Strand, priors: Indices, readings: Indices) -> None:
            strand.add(known, priors, ones, certain, off)
            strand.add(placed, readings, linear.jacobian, information, weighted.residual)

        chain.each(add, known.parts, placed.parts)
        return chain

    def _step(
        self,
        x: Array,
        linear: Linearised,
        weighted: Weighted,
        motions: list[Motion],
        damping: float,
        near: bool,
    ) -> NewtonStep:
        """A Newton step.

        Args:
            x: the estimate, flat.
            linear: the rows there.
            weighted: how they are weighed.
            motions: the walks' motion there.
            damping: see `Chain.damp`.
            near: it is near the optimum: negative curvature counts, as long as the whole stays positive.
        """
        for signed in (True, False) if near else (False,):
            chain = self.assemble(x, linear, weighted, motions)
            self.add_curvature(chain, x, weighted, signed)
            slope = chain.slope()
            chain.damp(damping)
            try:
                steps, fixed = chain.solve(mend=not signed)
            except ValueError:
                if not signed:
                    raise
                continue
            break
        return NewtonStep(np.concatenate([steps.ravel(), fixed]), slope, chain.promised)

    def add_curvature(self, chain: Chain, x: Array, weighted: Weighted, signed: bool) -> None:
        """Add the curvature of distances to the normal equations: for the step, not for the covariance.

        Args:
            chain: takes it.
            x: the estimate, flat.
            weighted: how the rows are weighed.
            signed: negative curvature too; see `curvature.add_curvature`.
        """
        rows, placed = self.rows, self.coupled.rows
        told = x, weighted.information, weighted.residual, signed, placed.slab, placed.columns

        def add(strand: Strand, part: Indices) -> None:
            if len(part):
                add_curvature(rows.readings, part, *told, strand.diagonal, strand.wide, strand.corner)

        chain.each(add, self.coupled.pairs)

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
        """
        linear, motions = self.linearise(x), self.motions(x)
        self.rows.widen(x, linear.jacobian)
        cost = self.cost(x, linear.residual, motions)
        doubt = None if kinked is None else (self.rows.residual(kinked) - linear.residual) ** 2
        damping, near, rests = 0.0, False, False
        before: tuple[NewtonStep, Array] | None = None
        for iteration in range(iterations):
            slack = slacks_m[iteration] if iteration < len(slacks_m) else 0.0
            weighted = self.weigh(linear.residual, slack, doubt if iteration == 0 else None)
            newton = self._step(x, linear, weighted, motions, damping, near and slack == 0.0)
            step, promised = conjugate_step(newton, *before) if before else (newton.step, newton.promised)
            led = x + step
            if not np.abs(led).max(initial=0.0) < NOWHERE:
                # Readings contradict each other beyond all measure: no step helps.
                break
            there = self.at(led)
            if slack == 0.0 and newton.promised > resting:
                # The parabola through the cost here, its slope and the cost there: where it is lowest.
                share = promised / max(2.0 * promised - (cost - there.cost), promised / FARTHEST)
                if abs(share - 1.0) > CLOSE:
                    there = min(there, self.at(x + max(share, LEAST_SHARE) * step), key=lambda p: p.cost)
            if slack == 0.0 and not there.cost <= cost + ACCEPTED:
                # The parabola reaches farther than it holds: shorter steps, and more along the slope.
                damping, before = max(10.0 * damping, LEAST_DAMPING), None
                if damping > MOST_DAMPING:
                    break
                continue
            before = None if slack > 0.0 or damping > 0.0 else (newton, step)
            near = cost - there.cost < NEAR
            x, motions, cost = there.x, there.motions, there.cost
            linear = Linearised(self._jacobian(x), there.residual)
            rests = slack == 0.0 and newton.promised < resting and damping <= LEAST_DAMPING
            if rests:
                break
            damping = 0.1 * damping if damping > LEAST_DAMPING else 0.0
        weighted = self.weigh(linear.residual)
        chain = self.assemble(x, linear, weighted, motions)
        return Solution(x, chain, linear, weighted, motions, cost, rests)

    def at(self, x: Array) -> Trial:
        """Residuals, motions and cost at an estimate, flat."""
        residual, motions = self.rows.residual(x), self.motions(x)
        return Trial(x, residual, motions, self.cost(x, residual, motions))
