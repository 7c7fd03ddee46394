"""What walls around a bearer take of all powers that he hears, for as long as he stays there.

Who is behind a wall hears all radios beyond it too weakly. Taken for errors of each link by itself, powers
would tell how far off all of them are together far better than they do (decision 0122). So each bearer has
a number for each keyframe; it is found anew wherever rows are looked at, and no unknown of the window.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.entering.technologies import REACH
from estimator.fusion.memory.ledger import RSSI
from estimator.fusion.memory.state import FusionState
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array, Indices
from estimator.graph.robust import weigh_one
from estimator.graph.scatter import END
from estimator.graph.shared_errors import SharedErrors, sharing
from estimator.smoothing.keyframes.displacement_sums import LENGTH
from estimator.smoothing.keyframes.ends import UNIT
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.readings.sharing import sharing_counts
from estimator.smoothing.readings.stacked import StackedReadings

LEAST_DB2 = 0.25
"""What shares less than half a dB is not asked."""
SEARCHED, FOUND_DB = 4, 0.01
"""So often at most a shadow is found anew by how likely its powers are to be outliers by then; it is found
where that changes it by less, for each time changes it ten times less than the one before."""


class Shadows(NamedTuple):
    """The shadows of a window.

    Attributes:
        of: which one each of m rows lies in, m; −1: none.
        alike: how many keyframes share each.
        slab: the keyframe of each.
        bearer: its number in the ledger.
    """

    of: Integers
    alike: Array
    slab: Integers
    bearer: Integers

    def among(self, chosen: Indices) -> SharedErrors:
        """The shadows in which some readings lie, ascending; their own rows are below all readings."""
        return sharing(self.of, chosen[chosen < len(self.of)], len(self.of))

    def some(self, chosen: NDArray[np.bool_]) -> tuple["Shadows", NDArray[np.bool_]]:
        """Those in which some of m rows lie, and which of them that is."""
        of = self.of[chosen]
        kept = np.zeros(len(self.slab), dtype=np.bool_)
        kept[of[of >= 0]] = True
        anew = np.append(np.cumsum(kept) - 1, -1)  # the last of them for those that lie in none
        return Shadows(anew[of], self.alike[kept], self.slab[kept], self.bearer[kept]), kept

    def divided(self, common: Array) -> tuple[Array, Array]:
        """What each link keeps of the variance that its powers share, m, and the sigma of each shadow (dB).

        Args:
            common: that variance, m.
        """
        at = np.flatnonzero(self.of >= 0)
        of, taken, left = self.of[at], physics.PLACE_SHARED * common[at], common.copy()
        left[at] -= taken
        count = np.bincount(of, minlength=len(self.slab))
        mean = np.bincount(of, taken, len(self.slab)) / np.maximum(count, 1)
        return left, np.sqrt(np.maximum(mean * self.alike, physics.SIGMA_FLOOR_M**2))


def shadows_of(
    layout: Layout, rows: StackedReadings, pairs: Array, ends: tuple[Integers, Integers]
) -> Shadows:
    """The shadows in which the powers of a window are heard.

    Args:
        layout: of the window.
        rows: its readings, m.
        pairs: the ledger's rows of the pairs among them, which stand in front, k × 11.
        ends: what kind of node each end of these is.
    """
    walks, of = max(len(layout.walks), 1), np.full(len(rows.t), -1)
    asked = (pairs[:, 1] == RSSI) & _shared(layout.state)[rows.source[: len(pairs)]]
    # What is lost on the way to an anchor is asked already (decision 0123).
    asked &= (layout.losses.radio[pairs[:, 2:4].astype(np.intp)] < 0).all(axis=1)
    among = np.flatnonzero(asked)
    units = [ends[end][among] == UNIT for end in range(2)]
    # Who hears, if he has a unit: what is told is told at his place.
    bearer = np.where(units[0], rows.columns[among, 0], rows.columns[among, END]) // STATES
    heard = among[units[0] | units[1]]
    each, place = np.unique(rows.slab[heard] * walks + bearer[units[0] | units[1]], return_inverse=True)
    of[heard] = place
    slab, walk = each // walks, each % walks
    numbers = np.array([one.number for one in layout.walks], dtype=np.int64)
    return Shadows(of, _alike(layout, slab, walk), slab, numbers[walk])


def _shared(state: FusionState) -> NDArray[np.bool_]:
    """Of which sources a place takes enough to be asked, sources + 1; the last one is none."""
    found = np.zeros(len(state.sources) + 1, dtype=np.bool_)
    for i, name in enumerate(state.sources):
        known = state.learned(name)
        taken = physics.PLACE_SHARED * known.shared * (known.factor * physics.RSSI_SIGMA_DB) ** 2
        found[i] = name != REACH and taken > LEAST_DB2
    return found


def _alike(layout: Layout, slab: Integers, walk: Integers) -> Array:
    """How many keyframes share each shadow, itself included, as its bearer walks on (decision 0033)."""
    found = np.ones(len(slab))
    for i in np.unique(walk).tolist():
        mine = np.flatnonzero(walk == i)
        t, way = layout.times[slab[mine], i], layout.walks[i].way
        if way is None or len(mine) < 2:
            continue
        gone_m = way.between(t[:-1], t[1:])[:, LENGTH]
        kept = np.exp(-gone_m / physics.SHARED_M - np.diff(t) / physics.SHARED_S)
        found[mine] = sharing_counts(kept)
    return found


def with_shadows(rows: StackedReadings, t: Array, shadows: Shadows) -> StackedReadings:
    """Readings, and below them one row for each shadow: that beforehand nothing is taken.

    Args:
        rows: the readings, m.
        t: epochs of keyframes (s).
        shadows: theirs.
    """
    count = len(shadows.slab)
    if not count:
        return rows
    ones, none = np.ones(count), np.full(count, -1)
    nothing = np.full((count, rows.columns.shape[1]), -1)
    usual = np.tile([0.0, 0.0, 1.0], (count, 1))
    return StackedReadings(
        t=np.append(rows.t, t[shadows.slab]),
        slab=np.append(rows.slab, shadows.slab),
        columns=np.concatenate([rows.columns, nothing]),
        noise=np.concatenate([rows.noise, usual]),
        nominal=np.append(rows.nominal, ones),
        source=np.append(rows.source, none),
        alike=np.append(rows.alike, ones),
        sharing=np.append(rows.sharing, np.zeros(count)),
    )


@njit(cache=True, error_model="numpy")
def take_shadows(shared: SharedErrors, sigma: Array, noise: Array, residual: Array) -> None:
    """Find what each place takes by what is left of its powers, and take it off them, in place.

    Args:
        shared: which rows lie in each shadow.
        sigma: standard deviation of the good noise of all rows, m.
        noise: outliers, shift and spread of each, m × 3.
        residual: z − h(x) − shift, m; changed.
    """
    for one in range(len(shared.own)):
        own, taken = shared.own[one], 0.0
        certain = 1.0 / sigma[own] ** 2
        for _ in range(SEARCHED):
            weight, pull, before = certain, 0.0, taken
            for at in range(shared.ends[one], shared.ends[one + 1]):
                row = shared.rows[at]
                outliers, shift, spread = noise[row]
                known, off, _ = weigh_one(residual[row] - taken, sigma[row], 0.0, outliers, shift, spread)
                weight += known
                pull += known * (off + taken)
            taken = pull / weight
            if abs(taken - before) < FOUND_DB:
                break
        for at in range(shared.ends[one], shared.ends[one + 1]):
            residual[shared.rows[at]] -= taken
        residual[own] = -taken
