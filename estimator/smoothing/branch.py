"""A node that lies elsewhere begins anew there (estimation.md, point 9), until more is known."""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fusion.state import FusionState
from estimator.graph.dense import Array
from estimator.smoothing.moved import Moved


def branch(state: FusionState, moved: Moved) -> None:
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
    state.nodes[moved.name] = replace(node, mode="undecided", index=number)
    state.sightings[moved.name] = moved.readings
    state.tried.pop(moved.name, None)
    text = f"{moved.name} lies elsewhere than it did: it was kicked or carried"
    state.say("node_moved", state.newest_t, moved.name, text)


def reunite(state: FusionState) -> None:
    """Take back that readings put standing nodes elsewhere: whoever knows more is to judge it again.

    What was dropped anew stays so. Nodes stand where they were said to lie at first.

    Args:
        state: the fusion, changed in place.
    """
    homes = _homes(state)
    moved = [number for number, home in enumerate(homes) if home != number]
    if not moved:
        return
    stands, pairs = state.ledger.table("stands"), state.ledger.table("pairs")
    for number in moved:
        pairs = renumber(pairs, number, homes[number], -math.inf)
    state.ledger.replace("pairs", pairs)
    state.ledger.replace("stands", stands[~np.isin(stands[:, 1], moved)])
    for name, node in list(state.nodes.items()):
        if node.index not in moved:
            continue
        home, mode = homes[node.index], node.mode
        if mode == "static":
            state.graph.delete_nodes([node.position])
        if mode in ("static", "undecided"):
            lay = stands[stands[:, 1] == home][0]
            state.graph.add_node(node.position, lay[2:5], lay[5:8])
            mode = "static"
        state.nodes[name] = replace(node, index=home, mode=mode)
        state.sightings.pop(name, None)


def _homes(state: FusionState) -> list[int]:
    """Of each number in the ledger that under which its node was introduced, or dropped, at last before."""
    dropped = set(state.ledger.table("drops")[:, 1].astype(int).tolist())
    homes: list[int] = []
    newest: dict[str, int] = {}
    for number, name in enumerate(state.owners):
        if number in dropped or name not in newest:
            newest[name] = number
        homes.append(newest[name])
    return homes


def renumber(pairs: Array, old: int, new: int, since_t: float) -> Array:
    """The ledger's pairs with a node's new number from an epoch on."""
    later = pairs[:, 0] >= since_t
    changed: Array = pairs.copy()
    for column in (2, 3):
        changed[later & (pairs[:, column] == old), column] = new
    return changed
