"""A node that lies elsewhere begins anew there (estimation.md, point 9)."""

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


def renumber(pairs: Array, old: int, new: int, since_t: float) -> Array:
    """The ledger's pairs with a node's new number from an epoch on."""
    later = pairs[:, 0] >= since_t
    changed: Array = pairs.copy()
    for column in (2, 3):
        changed[later & (pairs[:, column] == old), column] = new
    return changed
