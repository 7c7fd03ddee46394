"""What paper A's system keeps of each node beside its vertex."""

from typing import Literal

import msgspec

from estimator.estimate import Covariance6, Vector3
from estimator.graph.variable import Variable
from estimator.measurements.node import MOVING_ROLES, Role

Mode = Literal["undecided", "anchor", "vertex", "retired"]
"""undecided: no position; anchor: connected to the ground without resistance (the base); vertex: in the
graph; retired: deleted for good."""


class GraphNode(msgspec.Struct, frozen=True, kw_only=True, array_like=True):
    """One node.

    Attributes:
        node: the node.
        role: what it is.
        named: its role was told by a `node` reading, not guessed from the first reading that named it.
        mode: how its position is held.
        t: epoch of its newest reading that was fused, Unix seconds.
        state_t: timestamp of its vertex, where it moves.
        reckons: displacements of its own have come, so it moves by nothing else.
        way_m: length of the way that its displacements tell of.
        place_m: its position where it is an anchor or retired.
        covariance_m2: of `place_m`.
        speed_mps: horizontal speed by its newest displacement.
    """

    node: str
    role: Role
    named: bool = False
    mode: Mode = "undecided"
    t: float
    state_t: float | None = None
    reckons: bool = False
    way_m: float = 0.0
    place_m: Vector3 | None = None
    covariance_m2: Covariance6 | None = None
    speed_mps: float | None = None

    @property
    def moves(self) -> bool:
        """Whether it is a mobile node."""
        return self.role in MOVING_ROLES

    @property
    def vertex(self) -> Variable:
        """Its vertex: by node and timestamp where it moves, else by node alone (section IV-E)."""
        return Variable("position", self.node, self.state_t)
