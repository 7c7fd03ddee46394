"""What would shrink a node's uncertainty most: a new breadcrumb, or a UAV at another place.

Each candidate is an edge that does not exist yet. What it would take away follows from the joint covariance
as it is now: Σ' = Σ − Σ h (hᵀ Σ h + R)⁻¹ hᵀ Σ (operation 1 of paper A, eq. 11, in covariance form).
"""

from typing import NamedTuple

import numpy as np

from estimator.evidence import Advice, Suggestion
from estimator.fusion import physics
from estimator.fusion.entering.introduce import tuple_of
from estimator.fusion.memory.ledger import RANGE, UNTOLD_POWER
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.report import covariance_of
from estimator.graph.dense import Array

SUGGESTIONS_MAX = 5
LEAST_GAIN = 0.01
READINGS = 3.0
"""Independent readings that a new link gives soon: the others share their error."""
RANGE_REACH_M, RSSI_REACH_M = 40.0, 25.0
UAV_UP_M, UAV_AWAY_M, UAV_SIGMA_M, UAV_PLACES = 10.0, 10.0, 0.5, 16


class Link(NamedTuple):
    """What the node measures with: variance of a distance (m²) at a distance (m), and how far it reaches."""

    ranged: bool
    sigma: float
    exponent: float
    reach_m: float

    def variance_m2(self, distance_m: float) -> float:
        """Variance of the distance that its readings will tell soon (m²)."""
        sigma = self.sigma if self.ranged else self.sigma * distance_m * np.log(10.0) / (10.0 * self.exponent)
        return float(max(sigma, physics.SIGMA_FLOOR_M) ** 2 / READINGS)


def advise(state: FusionState, name: str) -> Advice | None:
    """What would help a node most.

    Args:
        state: the fusion as it is now.
        name: the node.

    Returns:
        None where its position is not decided, or known exactly.

    Raises:
        KeyError: there is no such node.
    """
    node = state.nodes[name]
    if not node.decided or node.mode == "fixed":
        return None
    covariance = covariance_of(state)
    rows = state.graph.rows(node.position)
    here = state.graph.value(node.position)
    now = float(np.trace(covariance[rows, rows][:2, :2]))
    link = _link(state, node)
    found: list[Suggestion] = []
    for other in state.nodes.values():
        if other.node == name or not other.moving or other.role != "responder":
            continue
        away = here - state.graph.value(other.position)
        distance = float(np.linalg.norm(away))
        if 0.5 < distance <= link.reach_m:
            along = away / distance
            drop = float((along**2) @ (np.array(physics.DROP_SIGMA_M) ** 2))
            edge = np.zeros(state.graph.size)
            edge[rows], edge[state.graph.rows(other.position)] = along, -along
            left = _left(covariance, edge, rows, link.variance_m2(distance) + drop)
            place = tuple_of(state.graph.value(other.position))
            found.append(_suggestion("drop", other.node, place, now, left))
    uav = Link(True, physics.RANGE_SIGMA_M["uwb"], 2.0, np.inf)
    for place_m in _uav_places(state):
        away = here - place_m
        distance = float(np.linalg.norm(away))
        edge = np.zeros(state.graph.size)
        edge[rows] = away / max(distance, 0.5)
        left = _left(covariance, edge, rows, uav.variance_m2(distance) + UAV_SIGMA_M**2)
        found.append(_suggestion("uav", None, tuple_of(place_m), now, left))
    drops = sorted((s for s in found if s.action == "drop"), key=lambda s: -s.gain)[:SUGGESTIONS_MAX]
    flights = sorted((s for s in found if s.action == "uav"), key=lambda s: -s.gain)[:2]
    best = sorted((s for s in (*drops, *flights) if s.gain >= LEAST_GAIN), key=lambda s: -s.gain)
    return Advice(node=name, t=node.t, sigma_m=float(np.sqrt(now)), suggestions=best[:SUGGESTIONS_MAX])


def _link(state: FusionState, node: NodeState) -> Link:
    """What the node measures with: ranges if it has any, else signal strength."""
    pairs = state.ledger.table("pairs")
    mine = pairs[((pairs[:, 2] == node.index) | (pairs[:, 3] == node.index)) & (pairs[:, 1] == RANGE)]
    if len(mine):
        source = state.sources[int(mine[-1, 6])]
        sigma = float(mine[-1, 5]) * state.learned(source).factor
        return Link(True, sigma, 2.0, RANGE_REACH_M)
    sigma = physics.RSSI_SIGMA_DB * state.learned(UNTOLD_POWER).factor
    return Link(False, sigma, physics.RSSI_EXPONENT, RSSI_REACH_M)


def _left(covariance: Array, edge: Array, rows: slice, variance_m2: float) -> float:
    """Sum of the horizontal variances after a new edge (m²)."""
    pulled = covariance @ edge
    taken = float((pulled[rows][:2] ** 2).sum()) / (float(edge @ pulled) + variance_m2)
    return float(np.trace(covariance[rows, rows][:2, :2])) - taken


def _uav_places(state: FusionState) -> Array:
    """Places round all that is known but UAVs, as far outside as these keep from a wall, m × 3 (m)."""
    known = np.array([state.place(n) for n in state.nodes.values() if n.decided and n.role != "uav"])
    if not len(known):
        return known.reshape(0, 3)
    middle = known.mean(axis=0)
    radius = float(np.linalg.norm(known[:, :2] - middle[:2], axis=1).max()) + UAV_AWAY_M
    angles = np.arange(UAV_PLACES) * (2.0 * np.pi / UAV_PLACES)
    up = np.full(UAV_PLACES, float(known[:, 2].max()) + UAV_UP_M)
    ring = [middle[0] + radius * np.cos(angles), middle[1] + radius * np.sin(angles), up]
    return np.column_stack(ring)


def _suggestion(
    action: str, by: str | None, place: tuple[float, float, float], now: float, left: float
) -> Suggestion:
    gain = float(np.clip(1.0 - left / now, 0.0, 1.0)) if now > 0.0 else 0.0
    return Suggestion(
        action="drop" if action == "drop" else "uav",
        by=by,
        position_m=place,
        sigma_m=float(np.sqrt(max(left, 0.0))),
        gain=gain,
    )
