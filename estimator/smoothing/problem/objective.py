"""What the best estimate of a window makes least: misfits of readings and of motion, and what was known."""

from copy import copy
from functools import cached_property, partial
from typing import Self

import numpy as np
from numpy.typing import NDArray

from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.prior import Prior
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import Weighted, mixture_cost, prior_cost, total_cost
from estimator.graph.shared_errors import SharedErrors
from estimator.smoothing.chain.chain import Chain
from estimator.smoothing.chain.strand import Strand, WalkMotion
from estimator.smoothing.keyframes.ends import faced
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.motions import Motions
from estimator.smoothing.keyframes.priors import own_priors
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.keyframes.walks import Motion, misfit
from estimator.smoothing.problem.held_quadratic import HeldQuadratic
from estimator.smoothing.problem.loss_walks import LossWalks
from estimator.smoothing.problem.marginal_prior import MarginalPrior
from estimator.smoothing.problem.solution import Trial
from estimator.smoothing.problem.sparsity import Sparsity
from estimator.smoothing.readings.curvature import BentPairs, NormalMatrix, Numbers, add_curvature
from estimator.smoothing.readings.linearised import Linearised
from estimator.smoothing.readings.rows import Rows
from estimator.smoothing.readings.weights import weigh_readings


class Objective:
    """What the best estimate of a window makes least: its negative log likelihood.

    What ranges lose to anchors is held at first: see `with_losses`.

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
        self.lost = LossWalks(layout, known, (RANGE,))
        self.going = Motions(layout)
        self._carried = None if prior is None else MarginalPrior(layout, prior)
        self.left_out: Integers = np.zeros(0, dtype=np.int64)
        self.aside: HeldQuadratic | None = None

    def without(self, left_out: Integers) -> Self:
        """The same problem without some of its rows; the rows themselves are shared."""
        other = copy(self)
        other.left_out = left_out
        return other

    def with_units(self, layout: Layout) -> Self:
        """The same rows, whose units are as noisy as another layout of the same unknowns has them."""
        other = type(self)(layout, self.rows, self.prior)
        vars(other)["coupled"] = self.coupled
        return other

    def with_rows(self, rows: Rows) -> Self:
        """The same problem with its rows told otherwise how noisy they are, or what they are too long by."""
        other = copy(self)
        other.rows = rows
        return other

    def with_losses(self) -> Self:
        """The same problem, which asks what ranges lose to anchors as well."""
        other = copy(self)
        other.lost = LossWalks(self.layout, () if self.prior is None else self.prior.keys)
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
            lost=self.lost.part(numbers.layout),
            _mean=self._mean[at >= 0],
            _information=self._information[at >= 0],
            _carried=None if self._carried is None else self._carried.part(numbers, x),
        )
        return other

    @cached_property
    def coupled(self) -> Sparsity:
        """How its unknowns hang together."""
        return Sparsity(self.layout, self.rows, self._at, self._carried, self.lost.columns)

    def motions(self, x: Array) -> list[Motion]:
        """Each walk's motion at an estimate."""
        return self.going.motions(x)

    def costs(self, residual: Array) -> Array:
        """Negative log likelihood of each reading up to a constant, by the residuals, m."""
        rows, noise, found = self.rows, self.rows.noise.T, np.empty(len(residual))

        def tell(first: int, last: int) -> None:
            own = slice(first, last)
            found[own] = mixture_cost(residual[own], rows.sigma[own], *noise[:, own])

        rows.in_shares(tell)
        return found

    def cost(self, x: Array, residual: Array, motions: list[Motion]) -> float:
        """Negative log likelihood up to a constant: mixtures of the readings, motion, priors."""
        total: float = total_cost(self.left_out, self.costs(residual))
        total += prior_cost(x, self._at, self._mean, self._information)
        total += self.lost.cost(x)
        for motion in motions:
            total += misfit(motion)
        if self._carried is not None:
            total += self._carried.cost(x)
        if self.aside is not None:
            total += self.aside.cost(x[self.layout.length * self.layout.width :])
        return total

    def at(self, x: Array) -> Trial:
        """Residuals, motions and cost at an estimate, flat."""
        residual, motions = self.rows.residual(x), self.motions(x)
        return Trial(x, residual, motions, self.cost(x, residual, motions))

    def linearise(self, x: Array) -> Linearised:
        """The rows at an estimate, with first-estimate Jacobians (decision 0006).

        Where the prior was linearised, turned as the map has been since: where new derivatives by the same
        numbers were taken elsewhere, their sum would know what nobody has measured, as where north is.
        """
        return Linearised(self.rows.residual(x), partial(self.jacobian, x))

    @property
    def pivot_m(self) -> Array:
        """What the map is turned about, east and north, 2 (m)."""
        return self._carried.pivot_m if self._carried else np.array(self.layout.state.base_place()[:2])

    def first(self, x: Array) -> Array:
        """Where rows are linearised at an estimate, flat."""
        return x if self._carried is None else self._carried.first(x)

    def jacobian(self, x: Array) -> Array:
        """First-estimate Jacobians of the rows at an estimate, flat, m × c; see `linearise`."""
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
        off, ones, jacobian = self._mean - x[self._at], np.ones((len(self._at), 1)), linear.jacobian
        pulls = self.lost.weighed(x)

        def add(
            strand: Strand, priors: Indices, readings: Indices, shadows: SharedErrors, losses: Indices
        ) -> None:
            strand.add(known, priors, ones, certain, off)
            strand.add(self.coupled.losses, losses, self.lost.jacobian, pulls.information, pulls.residual)
            strand.add(placed, readings, jacobian, information, weighted.residual)
            strand.share(shadows, placed, jacobian, information, weighted.residual)

        chain.each(add, known.parts, placed.parts, self.coupled.shadows, self.coupled.losses.parts)
        return chain

    def add_curvature(self, chain: Chain, x: Array, weighted: Weighted, signed: bool) -> None:
        """Add the curvature of distances to the normal equations: for the step, not for the covariance.

        Args:
            chain: takes it.
            x: the estimate, flat.
            weighted: how the rows are weighed.
            signed: negative curvature too; see `curvature.add_curvature`.
        """
        readings, placed = self.rows.readings, self.coupled.rows
        estimate = faced(x, readings.headings)  # once for all strands
        bent = BentPairs(readings.kind, readings.extra, readings.a, readings.b)
        weight, numbers = weighted.information * weighted.residual, Numbers(placed.slab, placed.columns)

        def add(strand: Strand, part: Indices) -> None:
            if len(part):
                matrix = NormalMatrix(strand.diagonal, strand.wide, strand.corner[None])
                add_curvature(bent, part, estimate, weight, signed, numbers, matrix)

        chain.each(add, self.coupled.pairs)
