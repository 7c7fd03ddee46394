"""Every reading of the window as rows of numbers, and their linearisation at any estimate."""

from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property
from typing import Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.memory.ledger import BEARING, ECHO, RANGE, RSSI, UNTOLD_POWER
from estimator.fusion.readings import echoes
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array, Indices
from estimator.graph.parallel import in_shares
from estimator.graph.shared_errors import SharedErrors
from estimator.measurements.bearing import wrap
from estimator.smoothing.keyframes.ends import FREE, UNIT, faced, place_ends
from estimator.smoothing.keyframes.ground import ground_of
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.unknowns import Unknowns
from estimator.smoothing.readings.between_reports import widened
from estimator.smoothing.readings.bodies import ahead_in
from estimator.smoothing.readings.fix_speeds import fix_speeds
from estimator.smoothing.readings.linearisation import (
    Readings,
    add_reckoning_noise,
    jacobians,
    residuals,
    scale_sigmas,
    separations,
)
from estimator.smoothing.readings.obstructed import Excess, excess_of
from estimator.smoothing.readings.partial import partial
from estimator.smoothing.readings.shadows import Shadows, shadows_of, take_shadows, with_shadows
from estimator.smoothing.readings.sharing import powers_sharing
from estimator.smoothing.readings.stacked import NOISES, StackedReadings, scattered, sigmas
from estimator.smoothing.readings.thinning import once_a_second
from estimator.smoothing.readings.window_readings import LedgerRows, technologies_of, window_readings

PER_ROW = ("t", "slab", "sigma", "shift", "noise", "nominal", "source", "alike", "turns", "told", "_alone")
"""What there is one of for each row."""

T = TypeVar("T")


class Rows:
    """The readings of a window: pairs, then singles, then drops (three rows each), then their shadows.

    Attributes:
        t: epoch of each row, m (s).
        slab: keyframe of each row, m.
        columns: what each depends on, m × c, as `graph.scatter.scatter_rows` takes it: two ends of six, three
            of a technology, and what is lost, where anything is.
        sigma: standard deviation of the good noise, m.
        told: the same by technology and link alone, wherever both ends are, m.
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
        self._layout, ledger = layout, layout.state.ledger
        told = LedgerRows(ledger.table("pairs"), ledger.table("singles"), ledger.table("drops"))
        nodes = layout.state.nodes
        outside = [nodes[name].role in physics.OUTSIDE_ROLES for name in layout.state.owners]
        ground = ground_of(layout)
        known = technologies_of(layout), layout.losses, np.array(outside, dtype=bool), layout.headings()
        found = window_readings(told, since_t, ground, *known)
        self._rows: StackedReadings = found.rows
        self.pairs, self.singles, self.drops = found.told
        kinds = found.readings.a.kind, found.readings.b.kind
        self.shadows: Shadows = shadows_of(layout, found.rows, self.pairs, kinds)
        rows = with_shadows(found.rows, layout.grid, self.shadows)
        self.t, self.slab, self.columns, self.noise, self.nominal, self.source, self.alike, _ = rows
        self.turns: NDArray[np.bool_] = np.append(found.turns, np.zeros(len(self.shadows.slab), dtype=bool))
        self.shift: Array = np.zeros(len(self.nominal))
        self.sigma: Array = self.nominal.copy()
        self.told: Array = self.nominal
        self._alone, self._bearings = self.nominal, found.bearings
        self._usual_noise: Array = self.noise
        self._white, self._common = self._rows.nominal**2, np.zeros(len(self._rows.t))
        self._shadow_db = self.nominal[len(self._rows.t) :]
        self._inside, self._strongest, self._unsure_m2 = found.inside, found.strongest, widened(layout, found)
        speeds = fix_speeds(self.singles, found.readings.off[:, 1], ledger.table("poses"))
        ahead = ahead_in(layout, ground, found.readings, self.pairs, self.slab)
        self._readings = found.readings._replace(speed=speeds, ahead=ahead)

    def of(self, numbers: Sequence[int]) -> NDArray[np.bool_]:
        """Which of them tell of some walks, or of what these have dropped, m.

        Args:
            numbers: the nodes' in the ledger.
        """
        table = self._layout.state.ledger.table("drops")
        named = np.zeros(len(self._layout.state.owners) + 1, dtype=np.bool_)
        named[list(numbers)] = True
        named[table[named[table[:, 2].astype(np.intp)], 1].astype(np.intp)] = True
        one, other, single, crumb, by = self._nodes
        dropped = np.repeat(named[crumb] | named[by], 3)
        return np.concatenate([named[one] | named[other], named[single], dropped, named[self.shadows.bearer]])

    @cached_property
    def _nodes(self) -> tuple[Indices, ...]:
        """The numbers of who is at each end of the pairs, in the singles, and in the drops."""
        told = (self.pairs, 2), (self.pairs, 3), (self.singles, 1), (self.drops, 1), (self.drops, 2)
        return tuple(rows[:, column].astype(np.intp) for rows, column in told)

    def part(self, numbers: Unknowns, x: Array, chosen: NDArray[np.bool_]) -> Self:
        """Some of them, as readings of a part of the window; nothing is to be learned of their noise.

        Args:
            numbers: of the part.
            x: the window's estimate, flat: what moves and is not in the part is held where it is.
            chosen: which rows, m; all three of a drop, or none. Shadows go with what lies in them.
        """
        m, n, chosen = len(self.pairs), len(self.singles), chosen[: len(self.shadows.of)]
        pairs, singles, drops = chosen[:m], chosen[m : m + n], chosen[m + n :: 3]
        shadows, kept = self.shadows.some(chosen)
        chosen = np.append(chosen, kept)
        unsure = zip(self._unsure_m2, (pairs, pairs, singles, drops), strict=True)
        other, columns = copy(self), self.columns[chosen]
        for known in ("_nodes", "lying"):
            vars(other).pop(known, None)
        for name in PER_ROW:
            setattr(other, name, getattr(self, name)[chosen])
        other.columns = np.where(columns >= 0, numbers.column[columns], -1)
        other.pairs, other.singles, other.drops = self.pairs[pairs], self.singles[singles], self.drops[drops]
        vars(other).update(
            floors=None if self.floors is None else self.floors[pairs],
            shadows=shadows,
            _inside=self._inside[pairs],
            _strongest=self._strongest[pairs],
            _unsure_m2=tuple(each[some] for each, some in unsure),
            _readings=partial(self._readings, numbers, x, pairs, singles, drops),
            _bearings=np.flatnonzero(other.pairs[:, 1] >= BEARING),
        )
        return other

    def learn(self, noise: dict[str, LearnedNoise], *, walls: bool = True) -> None:
        """Give each reading the noise that has been learned of its technology and its link.

        Args:
            noise: of technologies, by name.
            walls: of ranges inside, `physics.WALL_M` as well, which nobody has seen.
        """
        names = self._layout.state.sources
        known = [(noise.get(name, LearnedNoise()), name.startswith(UNTOLD_POWER)) for name in names]
        told = [one.terms(NOISES[RSSI if power else RANGE, 0].item()) for one, power in known]
        learned = np.array(told).reshape(-1, 3)
        walled = self._inside if walls else np.zeros_like(self._inside)
        white, common, outliers = scattered(learned, self._rows, self._readings.kind, walled)
        common, self._shadow_db = self.shadows.divided(common)
        self.noise[: len(outliers), 0] = outliers
        self._usual_noise = self.noise.copy()
        echoes.tell(self.noise, self.pairs[:, ECHO], self.alike)
        self._white, self._common = white, common
        self.tell(white, common)

    def obstructed(self, x: Array, asked: NDArray[np.bool_]) -> tuple[Self, Excess]:
        """The same rows, less what ranges are too long by as their scatter tells; and what that is, of pairs.

        Of those of a crew to an anchor, whose lengths tell a loss, it only says how unsure each is.

        Args:
            x: an estimate, flat.
            asked: which rows may tell, m: a node that was moved makes ranges scatter as well.
        """
        other, m = copy(self), len(self.pairs)
        shared = self._readings.lost != 0.0
        among = (self._inside | shared) & (self.pairs[:, 1] == RANGE) & ~self.through(x) & asked[:m]
        steep_m = np.abs(separations(self._readings, x)[:, 2])
        link = self.pairs[:, 9].astype(np.int64)
        walls = excess_of(among, self.source[:m], link, self.alike[:m], self._read(x)[:m], steep_m)
        other.shift = np.append(np.where(shared, 0.0, walls.mean_m), np.zeros(len(self.nominal) - m))
        white, common = self._white.copy(), self._common.copy()
        white[:m] += walls.scatter_m2
        common[:m] += np.where(shared, 0.0, walls.doubt_m2)
        other.tell(white, common)
        return other, walls

    def tell(self, white: Array, common: Array) -> None:
        """Give each reading its sigma, by the variances that it has for itself and shares on its link, m."""
        self.told = np.append(sigmas(white, common, self._rows), self._shadow_db)
        self._alone = np.append(np.sqrt(white + common), self._shadow_db)
        self.sigma = self.told.copy()

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
        sharing = self._rows.sharing.copy()
        sharing[chosen] = powers_sharing(self.pairs[chosen], alike[chosen], sharing[chosen] > 0.0)
        rows = self._rows._replace(alike=other.alike[: len(sharing)], sharing=sharing)
        told = np.append(sigmas(self._white, self._common, rows), self._shadow_db)
        other.sigma = np.sqrt(np.maximum(self.sigma**2 - self.told**2, 0.0) + told**2)
        return chosen, other

    def widen(self, x: Array, jacobian: Array) -> None:
        """What the estimate says of each reading's noise.

        Through a floor it is worth little, and an encounter is sharp; a reading between two keyframes has the
        noise of the unit's own way as well.

        Args:
            x: the estimate, flat.
            jacobian: of the rows, m × c, by which the noise of a place becomes one of the reading.
        """
        self.sigma = self.told.copy()
        held = self.floors is not None
        through = self._inside if self.floors is None else self.floors
        scale_sigmas(self._readings, x, through, held, self._strongest, self.alike, self._alone, self.sigma)
        add_reckoning_noise(jacobian, *self._unsure_m2, self.sigma)

    def through(self, x: Array) -> NDArray[np.bool_]:
        """Which pairs go through a floor at an estimate, flat, m."""
        return np.asarray(self._inside & (np.abs(separations(self._readings, x)[:, 2]) > physics.FLOOR_M))

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

    def bodies(self, x: Array) -> Array:
        """What bearers' bodies are thought to do to each pair at an estimate x, flat, m (m or dB)."""
        found: Array = self._readings.ahead * x[self._readings.extra[:, 2]]
        return found

    def residual(self, x: Array) -> Array:
        """Residuals z − h(x) − shift at an estimate x, flat, less what shadows take."""
        found = self._read(x)
        found -= self.shift
        if len(self._bearings):
            found[self._bearings] = wrap(found[self._bearings])
        if len(self.shadows.slab):
            take_shadows(self.lying, self.sigma, self.noise, found)
        return found

    @cached_property
    def lying(self) -> SharedErrors:
        """Which rows lie in each shadow."""
        return self.shadows.among(np.arange(len(self.shadows.of)))

    def jacobian(self, x: Array) -> Array:
        """Derivatives at an estimate x, flat, m × c."""
        found, numbers = np.zeros(self.columns.shape), faced(x, self._readings.headings)
        self.in_shares(lambda first, last: jacobians(self._readings, numbers, first, last, found))
        return found

    def _read(self, x: Array) -> Array:
        """Residuals z − h(x) at an estimate, flat; bearings not yet wrapped."""
        found, numbers = np.zeros(len(self.nominal)), faced(x, self._readings.headings)
        self.in_shares(lambda first, last: residuals(self._readings, numbers, first, last, found))
        return found

    def in_shares(self, work: Callable[[int, int], T]) -> list[T]:
        """What some work on its rows gives, share by share: see `graph.parallel.in_shares`."""
        return in_shares(work, len(self.nominal), self._layout.state.ledger.complete)

    @property
    def readings(self) -> Readings:
        """All that their residuals follow from, as numbers."""
        return self._readings
