"""Every reading of the window as rows of numbers, and their linearisation at any estimate."""

from collections.abc import Sequence
from copy import copy
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.entering.technologies import UNTOLD_POWER
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.memory.ledger import BEARING, ECHO, GYRO_BIAS, RANGE, RSSI
from estimator.fusion.readings import echoes
from estimator.graph.dense import Array
from estimator.graph.kernels import Integers
from estimator.measurements.bearing import wrap
from estimator.smoothing.keyframes.ends import FREE, UNIT, Ends, nodes_of, place_ends
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.numbers import Numbers
from estimator.smoothing.readings.arranged import NOISES, Arranged, arrange, scattered, sigmas
from estimator.smoothing.readings.chosen import choose, kept
from estimator.smoothing.readings.encounters import candidates
from estimator.smoothing.readings.linear import Readings, add_unsure, apart, jacobians, residuals, stretch
from estimator.smoothing.readings.obstructed import excess
from estimator.smoothing.readings.partial import partial
from estimator.smoothing.readings.rarer import once_a_second

PER_ROW = ("t", "slab", "sigma", "shift", "noise", "nominal", "source", "alike", "turns", "_told", "_alone")
"""What there is one of for each row."""


class Linearised(NamedTuple):
    """Rows at an estimate.

    Attributes:
        jacobian: derivatives, m × 14.
        residual: z − h(x) − shift, m.
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
        shift: what they are thought to be too long by, m.
        noise: outliers, shift and spread of each, m × 3.
        nominal: claimed or assumed standard deviation, m.
        source: number of the technology, m; −1: none.
        alike: how many readings of its link share an error, as each counts, m.
        turns: which of them are gyro biases that standing units tell, m.
        pairs: the ledger's rows of the pairs, as they stand in front.
        singles: those of the singles.
        drops: those of the drops.
        floors: which pairs are held to go through a floor, m; None: those that do at each estimate.
    """

    floors: NDArray[np.bool_] | None = None

    def __init__(self, layout: Layout, since_t: float) -> None:
        self._layout, self._nodes = layout, nodes_of(layout)
        self._pairs(layout, since_t)
        self._singles(layout, since_t)
        self._drops(layout, since_t)
        ends = (end.stood for end in (self._a, self._b, self._on, self._by, self._crumb))
        rows = arrange(self.pairs, self.singles, self.drops, self._slab, self._extra, *ends)
        self._rows: Arranged = rows
        self.t, self.slab, self.columns, self.noise, self.nominal, self.source, self.alike = rows
        rssi = np.flatnonzero(self.pairs[:, 1] == RSSI)
        self._strongest = np.zeros(len(self.pairs), dtype=bool)
        heard = self.pairs[rssi]
        self._strongest[rssi] = candidates(heard[:, 0], heard[:, 9], heard[:, 4])
        own = slice(len(self.pairs), len(self.pairs) + len(self.singles))
        self.turns: NDArray[np.bool_] = np.zeros(len(self.nominal), dtype=bool)
        self.turns[own] = self.singles[:, 2] == GYRO_BIAS
        self.shift: Array = np.zeros(len(self.nominal))
        self.sigma: Array = self.nominal.copy()
        self._told: Array = self.nominal
        self._alone: Array = self.nominal
        self._usual_noise: Array = self.noise
        self._white, self._common = self.nominal**2, np.zeros(len(self.nominal))
        self._unsure_m2 = self._a.unsure_m2, self._b.unsure_m2, self._on.unsure_m2, self._by.unsure_m2
        size = layout.length * layout.width
        self._bearings = np.flatnonzero(self.pairs[:, 1] >= BEARING)
        self._readings = Readings(
            kind=self.pairs[:, 1].astype(np.int64),
            value=self.pairs[:, 4].copy(),
            constant=self.pairs[:, 7].copy(),
            extra=np.where(self._extra >= 0, size + self._extra - layout.width, 0),
            a=self._a.table,
            b=self._b.table,
            axis=self.singles[:, 2].astype(np.int64),
            told=self.singles[:, 3].copy(),
            on=self._on.table,
            by=self._by.table,
            crumb=self._crumb.table,
        )

    def _pairs(self, layout: Layout, since_t: float) -> None:
        pairs = layout.state.ledger.table("pairs")
        pairs = kept(pairs, pairs[:, 0] >= since_t)
        numbers = pairs[:, 2:4].astype(np.int64)
        unitless = self._nodes.kind[numbers] != UNIT
        nearest = unitless[:, 0] & unitless[:, 1]
        a, b = (Ends(layout, numbers[:, i], pairs[:, 0], nearest, self._nodes) for i in (0, 1))
        technology = np.full((BEARING, len(layout.state.sources)), -1, dtype=np.int64)
        for (kind, source), start in layout.technologies.items():
            technology[RANGE if kind == "range" else RSSI, source] = layout.width + start
        nodes = layout.state.nodes
        outside = [nodes[name].role in physics.OUTSIDE_ROLES for name in layout.state.owners]
        found = choose(pairs, a.stood, b.stood, technology, np.array(outside, dtype=bool))
        a.take(found.chosen)
        b.take(found.chosen)
        self._a, self._b = a, b
        self.pairs: Array = kept(pairs, found.chosen)
        self._extra, self._slab = kept(found.extra, found.chosen), kept(found.slab, found.chosen)
        self._inside = kept(found.inside, found.chosen)

    def _singles(self, layout: Layout, since_t: float) -> None:
        singles = layout.state.ledger.table("singles")
        singles = singles[singles[:, 0] >= since_t]
        nothing = np.zeros(len(singles), dtype=bool)
        on = Ends(layout, singles[:, 1].astype(np.int64), singles[:, 0], nothing, self._nodes)
        chosen = on.usable & (on.columns[:, 0] >= 0)
        on.take(chosen)
        self.singles: Array = singles[chosen]
        self._on = on

    def _drops(self, layout: Layout, since_t: float) -> None:
        drops = layout.state.ledger.table("drops")
        drops = drops[drops[:, 0] >= since_t]
        nothing = np.zeros(len(drops), dtype=bool)
        by = Ends(layout, drops[:, 2].astype(np.int64), drops[:, 0], nothing, self._nodes)
        crumb = Ends(layout, drops[:, 1].astype(np.int64), drops[:, 0], nothing, self._nodes)
        chosen = by.usable & crumb.usable
        by.take(chosen)
        crumb.take(chosen)
        self.drops: Array = drops[chosen]
        self._by, self._crumb = by, crumb

    def of(self, numbers: Sequence[int]) -> NDArray[np.bool_]:
        """Which of them tell of some walks, or of what these have dropped, m.

        Args:
            numbers: the nodes' in the ledger.
        """
        table = self._layout.state.ledger.table("drops")
        named = np.zeros(len(self._layout.state.owners) + 1, dtype=np.bool_)
        named[list(numbers)] = True
        named[table[named[table[:, 2].astype(np.intp)], 1].astype(np.intp)] = True
        pairs, drops = self.pairs[:, 2:4].astype(np.intp), self.drops[:, 1:3].astype(np.intp)
        singles = named[self.singles[:, 1].astype(np.intp)]
        return np.concatenate([named[pairs].any(axis=1), singles, np.repeat(named[drops].any(axis=1), 3)])

    def part(self, numbers: Numbers, x: Array, chosen: NDArray[np.bool_]) -> Self:
        """Some of them, as readings of a part of the window; nothing is to be learned of their noise.

        Args:
            numbers: of the part.
            x: the window's estimate, flat: what moves and is not in the part is held where it is.
            chosen: which rows, m; all three of a drop, or none.
        """
        m, n = len(self.pairs), len(self.singles)
        pairs, singles, drops = chosen[:m], chosen[m : m + n], chosen[m + n :: 3]
        unsure = zip(self._unsure_m2, (pairs, pairs, singles, drops), strict=True)
        other, columns = copy(self), self.columns[chosen]
        for name in PER_ROW:
            setattr(other, name, getattr(self, name)[chosen])
        other.columns = np.where(columns >= 0, numbers.column[columns], -1)
        other.pairs, other.singles, other.drops = self.pairs[pairs], self.singles[singles], self.drops[drops]
        vars(other).update(
            floors=None if self.floors is None else self.floors[pairs],
            _inside=self._inside[pairs],
            _strongest=self._strongest[pairs],
            _unsure_m2=tuple(each[some] for each, some in unsure),
            _readings=partial(self._readings, numbers, x, pairs, singles, drops),
            _bearings=np.flatnonzero(other.pairs[:, 1] >= BEARING),
        )
        return other

    def learn(self, noise: dict[str, LearnedNoise]) -> None:
        """Give each reading the noise that has been learned of its technology and its link."""
        names = self._layout.state.sources
        known = [(noise.get(name, LearnedNoise()), name.startswith(UNTOLD_POWER)) for name in names]
        told = [
            (one.factor, one.shared, one.outliers(NOISES[RSSI if power else RANGE, 0].item()))
            for one, power in known
        ]
        learned = np.array(told).reshape(-1, 3)
        white, common, outliers = scattered(learned, self._rows, self._readings.kind, self._inside)
        self.noise[:, 0] = outliers
        self._usual_noise = self.noise.copy()
        echoes.tell(self.noise, self.pairs[:, ECHO], self.alike)
        self._white, self._common = white, common
        self._tell(white, common)

    def obstruct(self, x: Array) -> None:
        """Tell by how ranges scatter on their links what they are too long by: see `obstructed`.

        Args:
            x: an estimate, flat, in which no node that was moved is thought to be where it was.
        """
        m = len(self.pairs)
        self.shift = np.zeros(len(self.nominal))
        off = residuals(self._readings, x)
        among = self._inside & (self.pairs[:, 1] == RANGE) & ~self.through(x)
        white, common = self._white.copy(), self._common.copy()
        for source in np.unique(self.source[:m][among]):
            at = np.flatnonzero(among & (self.source[:m] == source))
            found = excess(self.pairs[at, 9].astype(np.int64), self.alike[at], off[at])
            self.shift[at] = found.mean_m
            white[at] += found.scatter_m2
            common[at] += found.doubt_m2
        self._tell(white, common)

    def _tell(self, white: Array, common: Array) -> None:
        self._told, self._alone = sigmas(white, common, self._rows), np.sqrt(white + common)
        self.sigma = self._told.copy()

    def rarer(self) -> tuple[Integers, Self]:
        """The pairs that there would be had each link been read once a second, and the rows as noisy as then.

        However many share an error, what is asked of each is asked of as many; and a range that jumps is an
        outlier like others: it may be no echo, but a node that was moved.
        """
        m = len(self.pairs)
        chosen, alike = once_a_second(self.t[:m], self.pairs[:, 9].astype(np.int64), self.alike[:m])
        other = copy(self)
        other.alike = np.concatenate([alike, self.alike[m:]])
        other.noise = self._usual_noise
        told = sigmas(self._white, self._common, self._rows._replace(alike=other.alike))
        other.sigma = np.sqrt(np.maximum(self.sigma**2 - self._told**2, 0.0) + told**2)
        return chosen, other

    def widen(self, x: Array, jacobian: Array) -> None:
        """What the estimate says of each reading's noise.

        Through a floor it is worth little, and an encounter is sharp; a reading between two keyframes has the
        noise of the unit's own way as well.

        Args:
            x: the estimate, flat.
            jacobian: of the rows, m × 14, by which the noise of a place becomes one of the reading.
        """
        self.sigma = self._told.copy()
        through = self.through(x) if self.floors is None else self.floors
        stretch(self._readings, x, through, self._strongest, self.alike, self._alone, self.sigma)
        add_unsure(jacobian, *self._unsure_m2, self.sigma)

    def through(self, x: Array) -> NDArray[np.bool_]:
        """Which pairs go through a floor at an estimate, flat, m."""
        return np.asarray(self._inside & (np.abs(apart(self._readings, x)[:, 2]) > physics.FLOOR_M))

    def places(self, x: Array) -> tuple[Array, Array]:
        """Where both ends of each pair are at an estimate, m × 3 each (m)."""
        return place_ends(self._readings.a, x).place, place_ends(self._readings.b, x).place

    @property
    def standing(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Whether each end of each pair stands, m each."""
        a, b = self._readings.a.kind, self._readings.b.kind
        return np.asarray((a != FREE) & (a != UNIT)), np.asarray((b != FREE) & (b != UNIT))

    @property
    def held(self) -> NDArray[np.bool_]:
        """Whether both ends of each pair have a PDR unit, or stand: no velocity takes them anywhere, m."""
        return np.asarray((self._readings.a.kind != FREE) & (self._readings.b.kind != FREE))

    def by_units(self, source: int) -> bool:
        """Whether nodes with a PDR unit take part in the readings of a technology."""
        mine = self.pairs[:, 6] == source
        a, b = self._readings.a.kind, self._readings.b.kind
        return bool((((a == UNIT) | (b == UNIT)) & mine).any())

    def linearise(self, x: Array) -> Linearised:
        """Residuals and derivatives at an estimate x, flat."""
        return Linearised(self.jacobian(x), self.residual(x))

    def residual(self, x: Array) -> Array:
        """Residuals z − h(x) − shift at an estimate x, flat."""
        found = residuals(self._readings, x) - self.shift
        if len(self._bearings):
            found[self._bearings] = wrap(found[self._bearings])
        return found

    def jacobian(self, x: Array) -> Array:
        """Derivatives at an estimate x, flat, m × 14."""
        return jacobians(self._readings, x)

    @property
    def readings(self) -> Readings:
        """All that their residuals follow from, as numbers."""
        return self._readings
