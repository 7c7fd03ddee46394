"""Readings to a node whose position is not decided yet, and where they were made from."""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.node import MOVING_ROLES

DRIFT = 0.02
"""Share of a way by which the places along it are unsure against each other, by dead reckoning."""
UNSURE_M = 0.1
FREE_M = 1.0


class Sightings(NamedTuple):
    """Ranges or RSSI to one node.

    Attributes:
        kind: `RANGE` or `RSSI`, as in the ledger.
        source: number of their technology.
        t: epochs, m (s).
        points: where from, m × 3 (m).
        spread: how unsure each place is against the newest one, m (m).
        value: ranges (m) or powers less what was sent (dBm), m.
        sigma: claimed or assumed standard deviations, m.
        alike: how many readings of its link share an error, as each counts, m.
        link: numbers of their links, m.
    """

    kind: int
    source: int
    t: Array
    points: Array
    spread: Array
    value: Array
    sigma: Array
    alike: Array
    link: Array


def heard_between(state: FusionState, node: NodeState) -> tuple[float, float]:
    """Epochs of the first and the last range or signal of a node that the ledger holds (s).

    Without any, the first is at plus, the last at minus infinity.
    """
    pairs = state.ledger.table("pairs")
    own = (pairs[:, 1] <= RSSI) & ((pairs[:, 2] == node.index) | (pairs[:, 3] == node.index))
    return float(pairs[own, 0].min(initial=np.inf)), float(pairs[own, 0].max(initial=-np.inf))


def of_node(
    state: FusionState, node: NodeState, since_t: float, by: Collection[int] | None = None
) -> Sightings | None:
    """The sightings of a node by the technology that saw it most, ranges first; None where there are none.

    Args:
        state: the fusion.
        node: the node.
        since_t: older ones do not count (s).
        by: numbers of the nodes whose sightings count; None: all.
    """
    pairs = state.ledger.table("pairs")
    pairs = pairs[(pairs[:, 1] <= RSSI) & (pairs[:, 0] >= since_t)]
    mine = pairs[(pairs[:, 2] == node.index) | (pairs[:, 3] == node.index)]
    if by is not None:
        mine = mine[np.isin(mine[:, 2:4], list(by)).any(axis=1)]
    ranged = mine[:, 1] == RANGE
    if ranged.any():
        mine = mine[ranged]
    if not len(mine):
        return None
    sources, counts = np.unique(mine[:, 6], return_counts=True)
    mine = mine[mine[:, 6] == sources[np.argmax(counts)]]
    others = np.where(mine[:, 2] == node.index, mine[:, 3], mine[:, 2]).astype(np.intp)
    points, spread = np.zeros((len(mine), 3)), np.zeros(len(mine))
    known = np.zeros(len(mine), dtype=bool)
    for number in np.unique(others).tolist():
        seen = others == number
        found = _places(state, state.nodes[state.owners[number]], number, mine[seen, 0], since_t)
        if found is not None:
            points[seen], spread[seen] = found
            known[seen] = True
    if not known.any():
        return None
    mine = mine[known]
    return Sightings(
        int(mine[0, 1]),
        int(mine[0, 6]),
        mine[:, 0],
        points[known],
        spread[known],
        mine[:, 4] - mine[:, 7],
        mine[:, 5],
        mine[:, 8],
        mine[:, 9],
    )


def _places(
    state: FusionState, other: NodeState, number: int, t: Array, since_t: float
) -> tuple[Array, Array] | None:
    """Where another node was at epochs `t`, and how unsure that is against where it is, or was at last."""
    if other.index != number or not (other.decided or other.place_m is not None):
        return None
    if other.role not in MOVING_ROLES:
        return np.tile(state.place(other), (len(t), 1)), np.zeros(len(t))
    poses = state.ledger.table("poses")
    poses = poses[(poses[:, 1] == number) & (poses[:, 0] >= since_t - 10.0)]
    now = np.concatenate([[other.pose_t], state.place(other)])
    track = np.concatenate([poses[:, [0, 3, 4, 5]], now[None]])
    track = track[np.argsort(track[:, 0], kind="stable")]
    places = np.column_stack([np.interp(t, track[:, 0], track[:, axis]) for axis in (1, 2, 3)])
    if other.unit_t is None:
        return places, np.full(len(t), FREE_M)
    steps = np.linalg.norm(np.diff(track[:, 1:], axis=0), axis=1)
    walked = np.concatenate([[0.0], np.cumsum(steps)])
    behind = walked[-1] - np.interp(t, track[:, 0], walked)
    return places, np.hypot(UNSURE_M, DRIFT * behind)
