"""Units that report raw samples: their displacements are summed up here, and fused as those of any unit."""

import numpy as np

from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.displacements import set_aside
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.navigation import navigate
from estimator.inertial.samples import Samples
from estimator.inertial.saturation import remark
from estimator.measurements.node import MOVING_ROLES


def displacements_of(state: FusionState, piece: Samples) -> list[InertialDisplacement]:
    """What samples make, in order of epoch; they count as the one reading that they are of.

    Args:
        state: the fusion: takes where the boot's navigation has got to.
        piece: the samples.
    """
    node = state.node_of(piece.node, "responder", piece.t)
    if node.role not in MOVING_ROLES or node.mode == "retired":
        text = f"{node.node} is a {node.mode} {node.role}: its inertial samples are set aside"
        state.say("conflict", piece.t, node.node, text, once=f"imu of {node.node}")
        state.count("not_fused", int(piece.last))
        return []
    if node.mode == "unit" and not node.raw and node.changed is None:
        set_aside(state, node.node, piece.t)
        state.count("not_fused", int(piece.last))
        return []
    done = navigate(state.navigations.get(node.node), piece, node.heading_rad or 0.0)
    state.navigations[node.node] = done.navigation
    if done.turned_rad2 > 0.0 and node.mode == "unit":
        _turn(state, node.node, done.turned_rad2)
    if done.text is not None:
        state.say(
            "not_fused", piece.t, node.node, f"{node.node}: {done.text}", once=f"{node.node} {done.text}"
        )
    of_clock, of_range = done.navigation.clock.remark, remark(done.navigation.boot.clipped)
    for what, said in (("clock", of_clock), ("range", of_range)):
        if said is not None:
            state.say("conflict", piece.t, node.node, f"{node.node}: {said}", once=f"{what} of {node.node}")
    state.count("fused" if done.taken else "not_fused", int(piece.last))
    return done.displacements


def _turn(state: FusionState, name: str, variance_rad2: float) -> None:
    """A boot may have turned unseen since its newest displacement: samples are missing."""
    node = state.nodes[name]
    row = np.array([[state.graph.starts[node.unit]]])
    noise = np.array([[[variance_rad2]]])
    state.graph.advance(row, state.graph.reference[row], np.ones((1, 1, 1)), noise)
    step = (0.0, 0.0, 0.0, 0.0, 0.0, variance_rad2, 0.0, 0.0, 1.0)
    state.ledger.add("steps", node.pose_t, node.index, node.pose_t, *step)
