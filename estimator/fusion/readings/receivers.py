"""Receivers: what the fixes of somebody who flies are off by, and how late they are, is a state of each."""

import math
from collections.abc import Sequence

from estimator.fusion import physics
from estimator.fusion.learned.receivers import Receiver
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.variable import Variable

OTHER = 2.0
"""Fixes that are told to be so many times as good have other corrections, and are off by others."""


def receiver_of(state: FusionState, node: NodeState, sigma_m: Sequence[float]) -> str | None:
    """Name of what tells a fix, added to the graph when it is first heard; None: nobody flies.

    Args:
        state: the fusion, changed in place.
        node: whom it is of.
        sigma_m: standard deviations of the fix, east, north, up (m): all fixes may be off by as much.
    """
    if node.role != "uav":
        return None
    told_m = math.hypot(sigma_m[0], sigma_m[1])
    own = {name: one for name, one in state.receivers.items() if one.node == node.node}
    for name, one in own.items():
        if told_m / OTHER <= one.told_m <= told_m * OTHER:
            return name
    name = f"receiver of {node.node} {len(own)}"
    east, north, up = (max(sigma, physics.SIGMA_FLOOR_M) for sigma in sigma_m)
    state.receivers[name] = one = Receiver(node.node, (east, north, up, physics.LATE_SIGMA_S), told_m)
    state.graph.add_node(Variable("receiver", name), one.mean, one.sigma)
    return name
