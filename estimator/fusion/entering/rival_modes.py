"""Which of the places that a node's sightings allow are about as likely, the base among them."""

import math
from collections.abc import Sequence

import numpy as np

from estimator.fusion import physics
from estimator.fusion.entering.base_entry import BasePrior
from estimator.fusion.entering.modes import (
    APART_M,
    Mode,
    UndecidedNode,
    costs_of,
    mode_at,
    residuals_of,
    short_costs,
)
from estimator.fusion.entering.sightings import Sightings
from estimator.fusion.memory.ledger import RANGE
from estimator.graph.dense import Array


def with_entry(modes: Sequence[Mode], seen: Sightings, sought: UndecidedNode, entry: BasePrior) -> list[Mode]:
    """All places, the one about the base among them, best first.

    Their costs are comparable: it gains what it is likelier than anywhere else he may have gone to, and loses
    what it tells less of where he is.

    Args:
        modes: those that readings alone tell, best first, at least one.
        seen: the sightings of a node.
        sought: the same, as they are solved.
        entry: what is known of who enters at the base.
    """
    here = mode_at(sought, np.array(entry.place_m[:2]), entry.sigma_m)
    best, most_m = modes[0], entry.reach_m
    if seen.kind == RANGE:
        # A ring is no larger than its radius.
        most_m = min(most_m, farthest_m(seen, best))
    gained = entry.log_odds + math.log(area_m2(here, most_m) / area_m2(best, most_m))
    here = here._replace(cost=here.cost - gained, before=here.before - gained)
    same_m = max(APART_M, 3.0 * here.sigma_m)

    def same(mode: Mode) -> bool:
        off_m = float(np.hypot(*(mode.position_m - here.position_m)[:2]))
        return off_m + min(mode.sigma_m, most_m) < same_m

    if here.cost > best.cost and same(best):
        return list(modes)
    return sorted([here, *(mode for mode in modes if not same(mode))], key=lambda mode: mode.cost)


def area_m2(mode: Mode, most_m: float) -> float:
    """How large a place is, of where one may be at all (m²)."""
    return min(mode.sigma_m, most_m) * min(mode.across_m, most_m)


def others_of(modes: Sequence[Mode], sought: UndecidedNode, alike: Array, outliers: float) -> list[Mode]:
    """The modes beside the best one that fit about as well, by either cost.

    Args:
        modes: best first.
        sought: what was measured.
        alike: see `_odd_cost`.
        outliers: see `_odd_cost`.
    """
    best, *rest = modes
    least = _odd_cost(best, sought, alike, outliers) if rest else 0.0

    def fits(mode: Mode) -> bool:
        if mode.cost - best.cost < physics.MODE_MARGIN:
            return True
        return _odd_cost(mode, sought, alike, outliers) - least < physics.MODE_MARGIN

    return [mode for mode in rest if fits(mode)]


def _odd_cost(mode: Mode, sought: UndecidedNode, alike: Array, outliers: float) -> float:
    """What a mode costs, in log likelihood, where readings far too long, or too weak, are nothing unusual.

    By its tails a Cauchy loss would rather believe in a place from which echoes are less too long, though
    sharp ranges contradict it.

    Args:
        mode: the mode.
        sought: what was measured.
        alike: how many readings of its link share an error, as each counts, m.
        outliers: share of the readings that are.
    """
    ranged, m = sought.kind == "range", len(sought.value)
    usual = physics.RANGE_NOISE if ranged else physics.RSSI_NOISE
    residual = residuals_of(sought, mode.position_m, mode.extra)
    noise = np.tile((outliers, usual.shift, usual.spread), (m, 1))
    costs = costs_of(residual, sought.sigma, noise, np.full(m, ranged), alike)
    if ranged:
        costs += short_costs(residual, sought.sigma)
    off, up = mode.extra - sought.extra, (mode.position_m[2] - sought.up_m) / sought.up_sigma_m
    return float(
        mode.before + costs.sum() + 0.5 * (off @ np.linalg.solve(sought.extra_covariance, off) + up**2)
    )


def is_place(seen: Sightings, mode: Mode) -> bool:
    """Whether a mode is a place at all: about one radio everybody's may be anywhere on its ring.

    A covariance is linear, and would be sure of the side on which somebody is shown.
    """
    return mode.sigma_m < farthest_m(seen, mode)


def farthest_m(seen: Sightings, mode: Mode) -> float:
    """From a mode to the farthest place that was measured from (m)."""
    return float(np.hypot(*(seen.points[:, :2] - mode.position_m[:2]).T).max())
