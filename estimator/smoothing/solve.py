"""Gauss-Newton over a window: readings, motion and priors at once, robust, until it rests."""

from typing import NamedTuple

import numpy as np

from estimator.fusion.prior import Key, Prior
from estimator.graph.dense import Array, Indices
from estimator.graph.kernels import scatter_rows
from estimator.graph.robust import Weighted, weigh
from estimator.smoothing.chain import Chain
from estimator.smoothing.layout import Layout, Walk
from estimator.smoothing.priors import own_priors
from estimator.smoothing.rows import RSSI, Linearised, Rows
from estimator.smoothing.walks import STATES, Motion, free_motions, unit_motion

ACCEPTED = 1e-3
"""Rise of the negative log likelihood that counts as rounding."""
RESTING = 0.005
SLACK_DB_PER_M = 4.0
"""What a metre makes of a signal's power a few metres away."""
SHARES = (1.0, 0.4, 0.1)
LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e3
FIRST_ESTIMATES = True
WIDE = 1e-8
"""Information of a block that nothing is known of beforehand: 10 km."""


class Solved(NamedTuple):
    """A solved window.

    Attributes:
        x: the estimate, flat: keyframes, then the border.
        chain: its normal equations at the estimate, not yet solved.
        linear: its rows at the estimate.
        weighted: how each row was weighed.
        motions: the walks' motion there.
        cost: negative log likelihood up to a constant.
    """

    x: Array
    chain: Chain
    linear: Linearised
    weighted: Weighted
    motions: list[Motion]
    cost: float


class Problem:
    """The least-squares problem of a window.

    Attributes:
        layout: its unknowns.
        rows: its readings.
        prior: what is known from before; None: nothing is.
    """

    def __init__(self, layout: Layout, rows: Rows, prior: Prior | None) -> None:
        self.layout, self.rows, self.prior = layout, rows, prior
        known = () if prior is None else prior.keys
        self._at, self._mean, self._information = own_priors(layout, known)
        if prior is not None:
            self._prior_at = np.concatenate(
                [self._columns(key) for key in prior.keys] or [np.zeros(0, dtype=np.intp)]
            ).astype(np.intp)
            kept = self._prior_at >= 0
            self._prior_kept = np.flatnonzero(kept)

    def _columns(self, key: Key) -> Indices:
        """Flat columns of a prior's block; −1 where it is no longer there."""
        layout, (kind, number) = self.layout, key
        size = layout.length * layout.width
        if kind == "walk":
            start = layout.column_of.get(number)
            return np.full(STATES, -1) if start is None else np.arange(start, start + STATES)
        if kind == "stand":
            start = layout.stands.get(number)
            return np.full(3, -1) if start is None else size + np.arange(start, start + 3)
        start = layout.technologies.get(key)
        return np.full(2, -1) if start is None else size + np.arange(start, start + 2)

    def motions(self, x: Array) -> list[Motion]:
        """Each walk's motion at an estimate."""
        layout = self.layout
        keyframes = x[: layout.length * layout.width].reshape(layout.length, layout.width)
        found = []
        for i, walk in enumerate(layout.walks):
            alive = slice(walk.first, walk.last + 1)
            times = layout.times[alive, i]
            states = keyframes[alive, STATES * i : STATES * (i + 1)]
            durations = np.diff(times)
            if walk.way is None:
                found.append(free_motions(walk.node.role, durations, states))
            else:
                found.append(unit_motion(walk.way.between(times[:-1], times[1:]), durations, states))
        return found

    def cost(self, x: Array, residual: Array, motions: list[Motion]) -> float:
        """Negative log likelihood up to a constant: mixtures of the readings, motion, priors."""
        rows = self.rows
        outliers, shift, spread = rows.noise.T
        good = rows.sigma**2
        bad = good + spread**2
        from_good = np.log1p(-outliers) - 0.5 * (np.log(good) + residual**2 / good)
        from_bad = np.log(outliers) - 0.5 * (np.log(bad) + (residual - shift) ** 2 / bad)
        total = -float(np.logaddexp(from_good, from_bad).sum())
        for motion in motions:
            if len(motion.noise):
                solved = np.linalg.solve(motion.noise, motion.residual[:, :, None])[:, :, 0]
                total += 0.5 * float((motion.residual * solved).sum())
        total += 0.5 * float((self._information * (x[self._at] - self._mean) ** 2).sum())
        if self.prior is not None:
            moved = self._prior_moved(x)
            total += float(0.5 * moved @ (self.prior.matrix @ moved) - self.prior.vector @ moved)
        return total

    def linearise(self, x: Array) -> Linearised:
        """The rows at an estimate, with first-estimate Jacobians (estimation.md, point 6).

        What the prior was linearised at, it stays linearised at: where new derivatives by the same numbers
        were taken elsewhere, their sum would know what nobody has measured, as where north is.
        """
        linear = self.rows.linearise(x)
        if self.prior is None or not FIRST_ESTIMATES:
            return linear
        first = x.copy()
        lasting = self._prior_at >= self.layout.length * self.layout.width
        first[self._prior_at[lasting]] = self.prior.reference[lasting]
        return Linearised(self.rows.linearise(first).jacobian, linear.residual)

    def _prior_moved(self, x: Array) -> Array:
        assert self.prior is not None  # noqa: S101 - asked for with a prior only
        moved = np.zeros(len(self._prior_at))
        kept = self._prior_kept
        moved[kept] = x[self._prior_at[kept]] - self.prior.reference[kept]
        return moved

    def weigh(self, residual: Array, slack_m: float = 0.0) -> Weighted:
        """E-step of the readings' noise."""
        outliers, shift, spread = self.rows.noise.T
        powers = np.zeros(len(residual), dtype=bool)
        powers[: len(self.rows.pairs)] = self.rows.pairs[:, 1] == RSSI
        predicted = np.where(powers, (SLACK_DB_PER_M * slack_m) ** 2, slack_m**2)
        return weigh(residual, self.rows.sigma, predicted, outliers, shift, spread)

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
        width = layout.width
        chain = Chain(length, width, layout.border)
        size = layout.length * width
        for i, (walk, motion) in enumerate(zip(layout.walks, motions, strict=True)):
            self._add_motion(chain, slice(STATES * i, STATES * (i + 1)), walk, motion)
        moving = self._at < size
        at, pull = self._at[moving], self._information * (self._mean - x[self._at])
        if width:
            slab, column = at // width, at % width
            inside = slab < length
            slab, column = slab[inside], column[inside]
            chain.diagonal[slab, column, column] += self._information[moving][inside]
            chain.gradient[slab, column] += pull[moving][inside]
        rest = self._at[~moving] - size
        chain.corner[rest, rest] += self._information[~moving]
        chain.corner_gradient[rest] += pull[~moving]
        if self.prior is not None:
            self._add_prior(chain, x)
        information, slabs = weighted.information, rows.slab
        if until is not None:
            information = np.where(rows.t < layout.grid[until], information, 0.0)
            slabs = np.minimum(slabs, until)
        scatter_rows(
            slabs,
            rows.columns,
            linear.jacobian,
            information,
            weighted.residual,
            chain.diagonal,
            chain.border,
            chain.corner,
            chain.gradient,
            chain.corner_gradient,
        )
        return chain

    def _add_motion(self, chain: Chain, own: slice, walk: Walk, motion: Motion) -> None:
        length = len(chain.diagonal)
        chain.diagonal[: walk.first, own, own] = np.eye(STATES)
        chain.diagonal[walk.last + 1 :, own, own] = np.eye(STATES)
        count = min(walk.last, length - 1) - walk.first
        if count <= 0:
            return
        information = np.linalg.inv(motion.noise[:count])
        information = 0.5 * (information + information.transpose(0, 2, 1))
        transition, residual = motion.transition[:count], motion.residual[:count]
        pulled = np.matmul(transition.transpose(0, 2, 1), information)
        before = slice(walk.first, walk.first + count)
        after = slice(walk.first + 1, walk.first + count + 1)
        chain.diagonal[before, own, own] += np.matmul(pulled, transition)
        chain.diagonal[after, own, own] += information
        chain.link[before, own, own] = -pulled.transpose(0, 2, 1)
        chain.gradient[before, own] += np.einsum("kij,kj->ki", pulled, residual)
        chain.gradient[after, own] -= np.einsum("kij,kj->ki", information, residual)

    def _add_prior(self, chain: Chain, x: Array) -> None:
        assert self.prior is not None  # noqa: S101 - asked for with a prior only
        size = self.layout.length * self.layout.width
        kept = self._prior_kept
        at = self._prior_at[kept]
        matrix = self.prior.matrix[np.ix_(kept, kept)]
        vector = (self.prior.vector - self.prior.matrix @ self._prior_moved(x))[kept]
        moving = at < size
        own, rest = at[moving], at[~moving] - size
        chain.diagonal[0][np.ix_(own, own)] += matrix[np.ix_(moving, moving)]
        chain.border[0][np.ix_(own, rest)] += matrix[np.ix_(moving, ~moving)]
        chain.corner[np.ix_(rest, rest)] += matrix[np.ix_(~moving, ~moving)]
        chain.gradient[0][own] += vector[moving]
        chain.corner_gradient[rest] += vector[~moving]

    def solve(
        self, x: Array, slacks_m: tuple[float, ...] = (), iterations: int = 20, resting: float = RESTING
    ) -> Solved:
        """Gauss-Newton with halved steps, until no position moves any more.

        Args:
            x: where to start, flat.
            slacks_m: how far off the start may be, step by step, so that good readings are not taken for
                outliers.
            iterations: at most so many steps.
            resting: gain in log likelihood below which nothing is to be had any more.
        """
        linear, motions = self.linearise(x), self.motions(x)
        self.rows.widen(x, linear.jacobian)
        cost = self.cost(x, linear.residual, motions)
        damping = 0.0
        for iteration in range(iterations):
            slack = slacks_m[iteration] if iteration < len(slacks_m) else 0.0
            chain = self.assemble(x, linear, self.weigh(linear.residual, slack), motions)
            chain.damp(damping)
            steps, fixed = chain.solve()
            step = np.concatenate([steps.ravel(), fixed])
            for share in (1.0,) if slack > 0.0 else SHARES:
                there = x + share * step
                after, then = self.linearise(there), self.motions(there)
                reached = self.cost(there, after.residual, then)
                if slack > 0.0 or reached <= cost + ACCEPTED:
                    break
            if slack == 0.0 and reached > cost + ACCEPTED:
                # The parabola reaches farther than it holds: shorter steps, and more along the slope.
                damping = max(10.0 * damping, LEAST_DAMPING)
                if damping > MOST_DAMPING:
                    break
                continue
            gained, cost = cost - reached, reached
            x, linear, motions = there, after, then
            if slack == 0.0 and gained < resting and share == 1.0 and damping <= LEAST_DAMPING:
                break
            damping = 0.1 * damping if damping > LEAST_DAMPING else 0.0
        weighted = self.weigh(linear.residual)
        return Solved(x, self.assemble(x, linear, weighted, motions), linear, weighted, motions, cost)
