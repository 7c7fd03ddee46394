"""Who hears and ranges whom: readings between moving and lying radios in a building."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.measurements import Range, Rssi
from estimator.simulate.base import FloatArray, TrueTrack
from estimator.simulate.radio import PathLoss, Uwb

Crossings = Callable[[FloatArray, FloatArray], FloatArray]
"""How many walls (or floors) lie between points, n × 3 each (m) → n."""
NEAREST = 2


def no_obstacles(a_m: FloatArray, b_m: FloatArray) -> FloatArray:
    """A plane without walls and floors."""
    del b_m
    return np.zeros(len(a_m))


@dataclass(frozen=True, slots=True)
class Radio:
    """A radio on its true way.

    Attributes:
        truth: where it is.
        on_s: it sends from then on (s).
        off_s: and until then (s).
        silent_s: except from the first to the second (s).
    """

    truth: TrueTrack
    on_s: float = 0.0
    off_s: float = np.inf
    silent_s: tuple[float, float] = (np.inf, np.inf)

    def alive(self, t_s: FloatArray) -> NDArray[np.bool_]:
        """Whether it sends at epochs `t_s`, n."""
        silent = (t_s >= self.silent_s[0]) & (t_s < self.silent_s[1])
        alive: NDArray[np.bool_] = (t_s >= self.on_s) & (t_s < self.off_s) & ~silent
        return alive


@dataclass(frozen=True, slots=True)
class Site:
    """What stands between radios."""

    walls: Crossings = no_obstacles
    floors: Crossings = no_obstacles


Link = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]


def rssi_readings(
    node: str,
    radios: Mapping[str, Radio],
    t_s: FloatArray,
    loss: PathLoss,
    site: Site,
    rng: np.random.Generator,
    strongest: int = 4,
    lost_p: float = 0.3,
) -> list[Rssi]:
    """What `node` hears at epochs `t_s`: of all other radios the `strongest`, less those lost.

    Args:
        node: who hears.
        radios: everyone, `node` included.
        t_s: when it listens, n (s).
        loss: how power falls off.
        site: what stands between.
        rng: where noise comes from.
        strongest: it reports at most so many a time.
        lost_p: probability that a packet is lost.
    """

    def link(distance_m: FloatArray, walls: FloatArray, floors: FloatArray) -> FloatArray:
        dbm = loss.heard_dbm(distance_m, walls, floors, rng)
        return np.where(rng.random(len(dbm)) < lost_p, np.nan, dbm)

    names, heard = _over_links(node, radios, t_s, link, site, loss.range_m)
    rank = np.argsort(np.argsort(np.where(np.isnan(heard), np.inf, -heard), axis=0), axis=0)
    return [
        Rssi(t=round(float(t_s[epoch]), 3), a=node, b=names[row], dbm=round(float(heard[row, epoch]), 1))
        for epoch, row in np.argwhere((~np.isnan(heard) & (rank < strongest)).T)
    ]


def range_readings(
    node: str,
    radios: Mapping[str, Radio],
    t_s: FloatArray,
    uwb: Uwb,
    site: Site,
    rng: np.random.Generator,
) -> list[Range]:
    """UWB ranges of `node` at epochs `t_s` to the `NEAREST` radios that answer; arguments as above."""
    names, ranged = _over_links(
        node, radios, t_s, lambda d, walls, floors: uwb.ranged_m(d, walls, floors, rng), site, uwb.range_m
    )
    rank = np.argsort(np.argsort(np.where(np.isnan(ranged), np.inf, ranged), axis=0), axis=0)
    return [
        Range(
            t=round(float(t_s[epoch]), 3),
            a=node,
            b=names[row],
            range_m=round(float(ranged[row, epoch]), 3),
            technology="uwb",
        )
        for epoch, row in np.argwhere((~np.isnan(ranged) & (rank < NEAREST)).T)
    ]


def _over_links(
    node: str, radios: Mapping[str, Radio], t_s: FloatArray, link: Link, site: Site, range_m: float
) -> tuple[list[str], FloatArray]:
    """The other radios' names, and what `link` gives for each at each epoch, NaN where one is dead or far."""
    names = [name for name in radios if name != node]
    values = np.full((max(len(names), 1), len(t_s)), np.nan)
    a_all, a_alive = radios[node].truth.at(t_s), radios[node].alive(t_s)
    for row, name in enumerate(names):
        b_all = radios[name].truth.at(t_s)
        distance = np.linalg.norm(b_all - a_all, axis=1)
        possible = a_alive & radios[name].alive(t_s) & (distance <= min(range_m, 60.0))
        if possible.any():
            a, b = a_all[possible], b_all[possible]
            values[row, possible] = link(distance[possible], site.walls(a, b), site.floors(a, b))
    return names, values
