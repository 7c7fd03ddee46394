"""Nodes leave: they have gone out, burned, or are lost for good."""

from msgspec.structs import replace

from estimator.estimate import NodeEstimate
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.measurements.retire import Retire


def retire(state: FusionState, reading: Retire, last: NodeEstimate | None) -> None:
    """Take in a `retire` reading: the node is marginalised, and its last estimate stays to be shown.

    Args:
        state: the fusion, changed in place.
        reading: the reading.
        last: what is shown of the node, with all that is doubted; None: nobody knows of it.
    """
    node = state.node_of(reading.node, "responder", reading.t)
    if node.mode != "retired":
        _marginalise(state, node, reading.t, last)
        state.count("fused")
        return
    if state.called.pop(node.node, None) is None:
        state.say("conflict", reading.t, node.node, f"{node.node} is retired already")
    state.count("not_fused")


def _marginalise(state: FusionState, node: NodeState, t: float, last: NodeEstimate | None) -> None:
    """Marginalise a node for good (operation 3)."""
    state.sightings.pop(node.node, None)
    if node.mode == "fixed":
        state.nodes[node.node] = replace(node, mode="retired", t=max(t, node.t), covariance_m2=(0.0,) * 6)
        return
    place_m, covariance_m2 = None, None
    if last is not None and node.decided:
        place_m, covariance_m2 = last.position_m, last.covariance_m2
        owned = [v for v in (node.position, node.velocity, node.unit) if v in state.graph]
        state.graph.delete_nodes(owned)
    state.nodes[node.node] = replace(
        node, mode="retired", t=max(t, node.t), place_m=place_m, covariance_m2=covariance_m2, trail=()
    )
