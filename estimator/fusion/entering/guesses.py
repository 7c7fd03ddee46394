"""Who was guessed to stand, from the first reading that named it, and turns out to be something else."""

import math

from msgspec.structs import replace

from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.measurements.node import MOVING_ROLES


def is_guessed_to_stand(node: NodeState) -> bool:
    """Whether readings alone say that a node stands, no introduction and no drop."""
    guessed = not node.named and math.isinf(node.introduced_t)
    return guessed and node.role not in MOVING_ROLES and node.mode in ("undecided", "static")


def forget_place(state: FusionState, known: NodeState, moves: bool) -> None:
    """Forget where readings have put what was guessed to stand.

    Args:
        state: the fusion, changed in place.
        known: the node; it is undecided afterwards, under a number of its own.
        moves: it walks, so it was nowhere: what was measured of it tells of no place.
    """
    if known.mode == "static":
        state.graph.delete_nodes([known.position])
    if moves:
        pairs, singles = state.ledger.table("pairs"), state.ledger.table("singles")
        state.ledger.replace("pairs", pairs[(pairs[:, 2:4] != known.index).all(axis=1)])
        state.ledger.replace("singles", singles[singles[:, 1] != known.index])
        state.due = True
    for kept in (state.sightings, state.tried, state.mistold):
        kept.pop(known.node, None)
    number = state.number(known.node)
    state.nodes[known.node] = replace(known, mode="undecided", index=number, otherwise=())
