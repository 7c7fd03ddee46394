"""A node that lies elsewhere begins anew there (decision 0022), until more is known."""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fusion.entering.introduce import NO_PRIOR_SIGMA_M
from estimator.fusion.memory.ledger import ECHO
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.node import MOVING_ROLES
from estimator.smoothing.changes.relocation import MovedNode


def branch(state: FusionState, moved: MovedNode) -> None:
    """Let a moved node begin anew with what was measured to it since.

    It is undecided until that decides it: from a straight way two places explain the same ranges.

    Args:
        state: the fusion, changed in place.
        moved: the node, and since when it lies elsewhere.
    """
    node = state.nodes[moved.name]
    number = state.number(moved.name)
    pairs = state.ledger.table("pairs")
    state.ledger.replace("pairs", renumber(pairs, node.index, number, moved.since_t))
    state.graph.delete_nodes([node.position])
    state.nodes[moved.name] = replace(
        node, mode="undecided", index=number, otherwise=(), place_told_t=moved.since_t
    )
    state.sightings[moved.name] = moved.readings
    state.tried.pop(moved.name, None)
    text = f"{moved.name} lies elsewhere than it did: it was kicked or carried"
    state.say("node_moved", state.newest_t, moved.name, text)


def reunite(state: FusionState) -> bool:
    """Take back where readings have put standing nodes last: whoever knows more may judge it otherwise.

    What was dropped, placed or fixed there stays, and so does what was kicked before that.

    Args:
        state: the fusion, changed in place; these nodes stand where they stood before.

    Returns:
        Whether there were any.
    """
    told = {*state.ledger.table("drops")[:, 1].tolist(), *state.ledger.table("singles")[:, 1].tolist()}
    taken = False
    for name, node in list(state.nodes.items()):
        stands = state.ledger.table("stands")
        lay = stands[np.isin(stands[:, 1], _before(state, node))]
        lies = stands[stands[:, 1] == node.index]
        placed = (lies[:, 5] < NO_PRIOR_SIGMA_M).any() or node.index in told
        if node.mode not in ("static", "undecided") or node.role in MOVING_ROLES or placed or not len(lay):
            continue
        home = int(lay[0, 1])
        pairs = renumber(state.ledger.table("pairs"), node.index, home, -math.inf)
        state.ledger.replace("pairs", pairs)
        state.ledger.replace("stands", stands[stands[:, 1] != node.index])
        if node.mode == "static":
            state.graph.delete_nodes([node.position])
        state.graph.add_node(node.position, lay[0, 2:5], lay[0, 5:8])
        state.nodes[name] = replace(node, index=home, mode="static", otherwise=())
        state.sightings.pop(name, None)
        taken = True
    return taken


def _before(state: FusionState, node: NodeState) -> list[int]:
    """The number that a node had before the one that it has: none, or one."""
    return [number for number in range(node.index) if state.owners[number] == node.node][-1:]


def renumber(pairs: Array, old: int, new: int, since_t: float) -> Array:
    """The ledger's pairs with a node's new number from an epoch on: what jumped then was no echo."""
    later = pairs[:, 0] >= since_t
    changed: Array = pairs.copy()
    for column in (2, 3):
        mine = later & (pairs[:, column] == old)
        changed[mine, column], changed[mine, ECHO] = new, 0.0
    return changed
