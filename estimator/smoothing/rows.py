"""Every reading of the window as rows of numbers, and their linearisation at any estimate."""

from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.noise import LearnedNoise
from estimator.graph.dense import Array
from estimator.graph.kernels import Integers
from estimator.measurements.bearing import predict_bearing, wrap
from estimator.measurements.range import PairJacobian, predict_range
from estimator.measurements.rssi import predict_rssi
from estimator.smoothing.encounters import candidates, near_dbm
from estimator.smoothing.ends import UNIT, Ends, kinds_of
from estimator.smoothing.layout import Layout
from estimator.smoothing.walks import STATES

RANGE, RSSI, BEARING, BODY_BEARING = range(4)
DROP = len(physics.NOISES) - 1
NOISES = np.array(physics.NOISES)
ANY = 14
"""Numbers that one row depends on at most: two ends of six, two of a technology."""


class Linearised(NamedTuple):
    """Rows at an estimate.

    Attributes:
        jacobian: derivatives, m × 14.
        residual: z − h(x), m.
    """

    jacobian: Array
    residual: Array


class Rows:
    """The readings of a window: pairs, then singles, then drops (three rows each).

    Attributes:
        t: epoch of each row, m (s).
        slab: keyframe of each row, m.
        columns: what each depends on, m × 14, as `graph.kernels.scatter_rows` takes it.
        sigma: standard deviation of the good noise, m.
        noise: outliers, shift and spread of each, m × 3.
        nominal: claimed or assumed standard deviation, m.
        source: number of the technology, m; −1: none.
        link: number of the link, m; −1: none.
        kept: how much of the error of the link's reading before still holds, m.
        pairs: the ledger's rows of the pairs, as they stand in front.
        singles: those of the singles.
        drops: those of the drops.
    """

    def __init__(self, layout: Layout, since_t: float, until_t: float) -> None:
        self._layout = layout
        self._pairs(layout, since_t, until_t)
        self._singles(layout, since_t, until_t)
        self._drops(layout, since_t, until_t)
        m, n, d = len(self.pairs), len(self.singles), len(self.drops)
        self.slab: Integers = np.concatenate([self._slab, self._on.slab, np.repeat(self._by.slab, 3)])
        self.columns: Integers = np.full((m + n + 3 * d, ANY), -1, dtype=np.int64)
        self.columns[:m, :6], self.columns[:m, 6:12] = self._a.columns, self._b.columns
        self.columns[:m, 12:] = self._extra
        self.columns[m : m + n, :6] = self._on.columns
        drops = self.columns[m + n :].reshape(d, 3, ANY)
        drops[:, :, :6], drops[:, :, 6:12] = self._by.columns[:, None], self._crumb.columns[:, None]
        # An end that does not move depends on three numbers, and those in the border may be another row's.
        kinds = np.concatenate([self.pairs[:, 1], self.singles[:, 5], np.full(3 * d, DROP)]).astype(np.int64)
        self.noise: Array = NOISES[kinds]
        self.nominal: Array = np.concatenate(
            [self.pairs[:, 5], self.singles[:, 4], np.tile(physics.DROP_SIGMA_M, d)]
        )
        rest = n + 3 * d
        self.source = np.concatenate([self.pairs[:, 6], np.full(rest, -1.0)]).astype(np.int64)
        self.source[:m][self.pairs[:, 1] >= BEARING] = -1
        self.link = np.concatenate([self.pairs[:, 9], np.full(rest, -1.0)]).astype(np.int64)
        self.alike: Array = np.concatenate([self.pairs[:, 8], np.ones(rest)])
        rssi = np.flatnonzero(self.pairs[:, 1] == RSSI)
        self._strongest = np.zeros(len(self.pairs), dtype=bool)
        heard = self.pairs[rssi]
        self._strongest[rssi] = candidates(heard[:, 0], heard[:, 9], heard[:, 4])
        self.sigma: Array = self.nominal.copy()
        self._told: Array = self.sigma
        self.t: Array = np.concatenate([self.pairs[:, 0], self.singles[:, 0], np.repeat(self.drops[:, 0], 3)])

    def _pairs(self, layout: Layout, since_t: float, until_t: float) -> None:
        pairs = layout.state.ledger.table("pairs")
        pairs = pairs[(pairs[:, 0] >= since_t) & (pairs[:, 0] <= until_t)]
        numbers = pairs[:, 2:4].astype(np.int64)
        unit = (kinds_of(layout, numbers[:, 0]) == UNIT) | (kinds_of(layout, numbers[:, 1]) == UNIT)
        a, b = (Ends(layout, numbers[:, i], pairs[:, 0], ~unit) for i in (0, 1))
        extra = np.full((len(pairs), 2), -1, dtype=np.int64)
        for (kind, source), start in layout.technologies.items():
            mine = (pairs[:, 1] == (RANGE if kind == "range" else RSSI)) & (pairs[:, 6] == source)
            extra[mine] = layout.width + start + np.arange(2)
        known = (extra[:, 0] >= 0) | (pairs[:, 1] >= BEARING)
        same = (a.slab == b.slab) | ~a.moving | ~b.moving
        held = (a.columns[:, 0] >= 0) | (b.columns[:, 0] >= 0)
        chosen = a.usable & b.usable & known & same & held
        a.take(chosen)
        b.take(chosen)
        self.pairs: Array = pairs[chosen]
        self._a, self._b, self._extra = a, b, extra[chosen]
        self._slab = np.where(a.moving, a.slab, b.slab)

    def _singles(self, layout: Layout, since_t: float, until_t: float) -> None:
        singles = layout.state.ledger.table("singles")
        singles = singles[(singles[:, 0] >= since_t) & (singles[:, 0] <= until_t)]
        nothing = np.zeros(len(singles), dtype=bool)
        on = Ends(layout, singles[:, 1].astype(np.int64), singles[:, 0], nothing)
        chosen = on.usable & (on.columns[:, 0] >= 0)
        on.take(chosen)
        self.singles: Array = singles[chosen]
        self._on = on

    def _drops(self, layout: Layout, since_t: float, until_t: float) -> None:
        drops = layout.state.ledger.table("drops")
        drops = drops[(drops[:, 0] >= since_t) & (drops[:, 0] <= until_t)]
        nothing = np.zeros(len(drops), dtype=bool)
        by = Ends(layout, drops[:, 2].astype(np.int64), drops[:, 0], nothing)
        crumb = Ends(layout, drops[:, 1].astype(np.int64), drops[:, 0], nothing)
        chosen = by.usable & crumb.usable
        by.take(chosen)
        crumb.take(chosen)
        self.drops: Array = drops[chosen]
        self._by, self._crumb = by, crumb

    def learn(self, noise: dict[str, LearnedNoise]) -> None:
        """Give each reading the noise that has been learned of its technology and its link."""
        factor, shared = np.ones(len(self.nominal)), np.zeros(len(self.nominal))
        for number, name in enumerate(self._layout.state.sources):
            mine = self.source == number
            learned = noise.get(name, LearnedNoise())
            factor[mine], shared[mine] = learned.factor, learned.shared
            if mine.any():
                self.noise[mine, 0] = learned.outliers(
                    float(NOISES[RSSI if name.startswith("rssi ") else RANGE][0])
                )
        total = (self.nominal * factor) ** 2
        common = shared * total
        white = total - common
        before, now = white + (self.alike - 1.0) * common, white + self.alike * common
        single = np.maximum(np.sqrt(before * now / white), physics.SIGMA_FLOOR_M)
        self._told = np.where(self.source >= 0, single, self.nominal)
        self.sigma = self._told.copy()

    def widen(self, x: Array, jacobian: Array) -> None:
        """What the estimate says of each reading's noise.

        An encounter is sharp; a reading between two keyframes has the noise of the unit's own way as well.

        Args:
            x: the estimate, flat.
            jacobian: of the rows, m × 14, by which the noise of a place becomes one of the reading.
        """
        self.sigma = self._told.copy()
        m, n = len(self.pairs), len(self.singles)
        self._sharpen(x)
        for columns, ends in ((slice(0, 3), self._a), (slice(6, 9), self._b)):
            self._add(slice(0, m), jacobian[:m, columns], ends.unsure_m2)
        self._add(slice(m, m + n), jacobian[m : m + n, :3], self._on.unsure_m2)
        drops = np.repeat(self._by.unsure_m2, 3, axis=0)
        self._add(slice(m + n, len(self.sigma)), jacobian[m + n :, :3], drops)

    def _sharpen(self, x: Array) -> None:
        at = np.flatnonzero(self._strongest)
        if not len(at):
            return
        width, size = self._layout.width, self._layout.length * self._layout.width
        a, _ = self._a.place(x, width)
        b, _ = self._b.place(x, width)
        extra = x[size + self._extra[at] - width]
        near = near_dbm(extra[:, 0] + self.pairs[at, 7], extra[:, 1])
        close = np.linalg.norm(a[at] - b[at], axis=1) <= physics.ENCOUNTER_M
        self.sigma[at[close & (self.pairs[at, 4] >= near)]] = physics.NEAR_SIGMA_DB

    def _add(self, rows: slice, by_place: Array, unsure_m2: Array) -> None:
        self.sigma[rows] = np.sqrt(self.sigma[rows] ** 2 + (by_place**2 * unsure_m2).sum(axis=1))

    def places(self, x: Array) -> tuple[Array, Array]:
        """Where both ends of each pair are at an estimate, m × 3 each (m)."""
        width = self._layout.width
        return self._a.place(x, width)[0], self._b.place(x, width)[0]

    def by_units(self, source: int) -> bool:
        """Whether nodes with a PDR unit take part in the readings of a technology."""
        mine = self.pairs[:, 6] == source
        return bool(((self._a.unit | self._b.unit) & mine).any())

    def linearise(self, x: Array) -> Linearised:
        """Residuals and derivatives at an estimate x, flat."""
        width, total = self._layout.width, len(self.slab)
        m, n = len(self.pairs), len(self.singles)
        jacobian, residual = np.zeros((total, ANY)), np.zeros(total)
        self._linearise_pairs(x, jacobian[:m], residual[:m])
        place, by_own = self._on.place(x, width)
        axis = self.singles[:, 2].astype(np.int64)
        own = np.where(self._on.columns >= 0, x[self._on.flat(width)], 0.0)
        placed = axis < 3
        rows = np.arange(n)
        predicted = np.where(placed, place[rows, np.minimum(axis, 2)], own[rows, axis])
        residual[m : m + n] = self.singles[:, 3] - predicted
        straight = np.zeros((n, STATES))
        straight[rows, axis] = 1.0
        jacobian[m : m + n, :6] = np.where(placed[:, None], by_own[rows, np.minimum(axis, 2)], straight)
        by, by_bearer = self._by.place(x, width)
        crumb, by_crumb = self._crumb.place(x, width)
        residual[m + n :] = (by - crumb).ravel()
        jacobian[m + n :, :6] = -by_bearer.reshape(-1, 6)
        jacobian[m + n :, 6:12] = by_crumb.reshape(-1, 6)
        return Linearised(jacobian, residual)

    def _linearise_pairs(self, x: Array, jacobian: Array, residual: Array) -> None:
        width, size = self._layout.width, self._layout.length * self._layout.width
        a, by_a = self._a.place(x, width)
        b, by_b = self._b.place(x, width)
        extra = np.where(self._extra >= 0, x[np.maximum(size + self._extra - width, 0)], 0.0)
        kinds, constant = self.pairs[:, 1], self.pairs[:, 7]
        for kind in (RANGE, RSSI, BEARING, BODY_BEARING):
            mine = kinds == kind
            if not mine.any():
                continue
            own = extra[mine]
            got = self._predicted(kind, a[mine], b[mine], own, constant[mine], x, mine)
            off = self.pairs[mine, 4] - got.predicted
            residual[mine] = wrap(off) if kind >= BEARING else off
            jacobian[mine, :6] = np.einsum("mi,mij->mj", got.by_a, by_a[mine])
            jacobian[mine, 6:12] = np.einsum("mi,mij->mj", got.by_b, by_b[mine])
            if kind < BEARING:
                jacobian[mine, 12:] = got.by_extra
            elif kind == BODY_BEARING:
                rows = np.flatnonzero(mine)[self._a.unit[mine]]
                jacobian[rows, 3] += got.by_extra[self._a.unit[mine], 0]

    def _predicted(
        self, kind: int, a: Array, b: Array, extra: Array, constant: Array, x: Array, mine: Array
    ) -> PairJacobian:
        if kind == RANGE:
            return predict_range(a, b, extra[:, 0], extra[:, 1])
        if kind == RSSI:
            return predict_rssi(a, b, extra[:, 0] + constant, extra[:, 1])
        heading = constant.copy() if kind == BODY_BEARING else np.zeros(len(a))
        if kind == BODY_BEARING:
            unit = self._a.unit[mine]
            heading[unit] += x[self._a.flat(self._layout.width)[mine][unit, 3]]
        return predict_bearing(a, b, heading)
