"""Nodes leave: they have gone out, burned, or are lost for good."""

from msgspec.structs import replace

from estimator.fusion.entering.introduce import tuple_of, upper_triangle
from estimator.fusion.entering.separated_unit import elsewhere_m2
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.heading_arcs import loose_headings, swung_m2
from estimator.measurements.retire import Retire


def retire(state: FusionState, reading: Retire) -> None:
    """Take in a `retire` reading: the node is marginalised, and its last estimate stays to be shown."""
    node = state.node_of(reading.node, "responder", reading.t)
    if node.mode != "retired":
        _marginalise(state, node, reading.t)
        state.count("fused")
        return
    if state.called.pop(node.node, None) is None:
        state.say("conflict", reading.t, node.node, f"{node.node} is retired already")
    state.count("not_fused")


def _marginalise(state: FusionState, node: NodeState, t: float) -> None:
    """Marginalise a node for good (operation 3); its last estimate stays to be shown."""
    state.sightings.pop(node.node, None)
    if node.mode == "fixed":
        state.nodes[node.node] = replace(node, mode="retired", t=max(t, node.t), covariance_m2=(0.0,) * 6)
        return
    place_m, covariance_m2 = None, None
    if node.decided:
        place_m = tuple_of(state.graph.value(node.position))
        rows = state.graph.rows(node.position)
        doubt = elsewhere_m2(node, state.graph.value(node.position)[:2])
        covariance = state.graph.covariance()
        own = covariance[rows, rows] + doubt
        loose = loose_headings(state, covariance)
        own += swung_m2(covariance[None, rows, loose], covariance[loose, loose])[0]
        own[2, 2] = max(own[2, 2], node.doubt_up_m2)
        covariance_m2 = upper_triangle(own)
        owned = [v for v in (node.position, node.velocity, node.unit) if v in state.graph]
        state.graph.delete_nodes(owned)
    state.nodes[node.node] = replace(
        node, mode="retired", t=max(t, node.t), place_m=place_m, covariance_m2=covariance_m2, trail=()
    )
