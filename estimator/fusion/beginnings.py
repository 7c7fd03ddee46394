"""Where an undecided node is: every place that its sightings allow, and whether one is clearly the best.

A range-only node starts as a ring, and after a straight path as two mirror images (estimation.md, point 7).
It enters the graph only once the second mode is clearly worse; the window is then solved again with all its
sightings, each used once.
"""

import math
from typing import Literal, NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.introduce import NO_PRIOR_SIGMA_M, place
from estimator.fusion.ledger import RANGE
from estimator.fusion.modes import Mode, Sought, costs_of, find_modes, short_costs
from estimator.fusion.nodes import NodeState
from estimator.fusion.pairs import path_loss_states, technology_states
from estimator.fusion.sightings import Sightings, of_node
from estimator.fusion.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.node import MOVING_ROLES
from estimator.measurements.range import predict_range
from estimator.measurements.rssi import predict_rssi


class Chosen(NamedTuple):
    """A decided beginning: the mode, and the height prior that it was found with (m)."""

    mode: Mode
    up_m: float
    up_sigma_m: float


def decide(state: FusionState, sightings_s: float = physics.SIGHTINGS_S) -> None:
    """Try undecided nodes that have been seen anew, and begin those whose position is decided.

    Args:
        state: the fusion, changed in place.
        sightings_s: how old sightings of a standing node may be (s).
    """
    covariance: Array | None = None
    for name, seen in list(state.sightings.items()):
        node = state.nodes[name]
        if node.mode != "undecided":
            del state.sightings[name]
            continue
        tried = state.tried.get(name, 0)
        if seen < max(physics.SIGHTINGS_MIN, min(tried + 10, 1.2 * tried)):
            continue
        state.tried[name] = seen
        moving = node.role in MOVING_ROLES
        kept_s = physics.MOVING_SIGHTINGS_S if moving else sightings_s
        sightings = of_node(state, node, state.newest_t - kept_s)
        if sightings is None or len(sightings.t) < physics.SIGHTINGS_MIN:
            continue
        owner = state.sources[sightings.source]
        ranged = sightings.kind == RANGE
        states = technology_states(state, owner) if ranged else path_loss_states(state, owner)
        if covariance is None or len(covariance) != state.graph.size:
            covariance = state.graph.covariance()
        rows = state.graph.rows(states)
        chosen = _choose(state, node, sightings, state.graph.value(states).copy(), covariance[rows, rows])
        if chosen is not None:
            _begin(state, node, sightings, chosen)
            covariance = None


def _choose(
    state: FusionState, node: NodeState, seen: Sightings, extra: Array, extra_covariance: Array
) -> Chosen | None:
    sigma = seen.sigma * state.learned(state.sources[seen.source]).factor
    if seen.kind == RANGE:
        sigma = np.hypot(sigma, seen.spread)
    up_sigma = physics.UNDECIDED_UP_SIGMA_M
    if node.role in MOVING_ROLES:
        up_sigma = physics.UNDECIDED_MOVING_UP_SIGMA_M
    kind: Literal["range", "rssi"] = "range" if seen.kind == RANGE else "rssi"
    sought = Sought(
        kind=kind,
        points=seen.points,
        value=seen.value,
        sigma=sigma,
        up_m=float(seen.points[:, 2].mean()),
        up_sigma_m=up_sigma,
        extra=extra,
        extra_covariance=extra_covariance,
    )
    modes = find_modes(sought)
    if not modes or modes[0].sigma_m > physics.DECIDED_SIGMA_M[kind]:
        return None
    told = (
        sought,
        seen.alike,
        state.learned(state.sources[seen.source]).outliers(physics.NOISES[seen.kind][0]),
    )
    if not _clear(modes, [_odd_cost(mode, *told) for mode in modes]):
        return None
    return Chosen(modes[0], sought.up_m, up_sigma)


def _clear(modes: list[Mode], odd: list[float]) -> bool:
    """Whether the best of some modes is clearly better than all others, by both of their costs."""
    apart = min((mode.cost for mode in modes[1:]), default=math.inf) - modes[0].cost
    return min(apart, min(odd[1:], default=math.inf) - odd[0]) >= physics.MODE_MARGIN


def _odd_cost(mode: Mode, sought: Sought, alike: Array, outliers: float) -> float:
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
    predict, usual = (predict_range, physics.RANGE_NOISE) if ranged else (predict_rssi, physics.RSSI_NOISE)
    there, extra = np.tile(mode.position_m, (m, 1)), (np.full(m, one) for one in mode.extra)
    residual = sought.value - predict(sought.points, there, *extra).predicted
    noise = np.tile((outliers, usual.shift, usual.spread), (m, 1))
    costs = costs_of(residual, sought.sigma, noise, np.full(m, ranged), alike)
    if ranged:
        costs += short_costs(residual, sought.sigma)
    off, up = mode.extra - sought.extra, (mode.position_m[2] - sought.up_m) / sought.up_sigma_m
    return float(costs.sum() + 0.5 * (off @ np.linalg.solve(sought.extra_covariance, off) + up**2))


def _begin(state: FusionState, node: NodeState, seen: Sightings, chosen: Chosen) -> None:
    mode = chosen.mode
    t = float(seen.t.max())
    state.due = True
    if node.role in MOVING_ROLES:
        # The sightings of the last seconds stand in the mode's own covariance; they are not used again.
        place(state, node, t, mode.position_m, (mode.sigma_m, mode.sigma_m, mode.up_sigma_m))
        return
    wide = (NO_PRIOR_SIGMA_M, NO_PRIOR_SIGMA_M, chosen.up_sigma_m)
    place(state, node, t, (float(mode.position_m[0]), float(mode.position_m[1]), chosen.up_m), wide)
    state.count("fused", len(seen.t))
