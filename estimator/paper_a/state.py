"""Everything that paper A's system remembers, what it says of its readings, and what leaves it."""

import numpy as np
from msgspec.structs import replace

from estimator.estimate import Covariance6, NodeEstimate, Notice, NoticeCode, Relative, Vector3
from estimator.graph.dense import Array
from estimator.graph.variable import Variable
from estimator.inertial.progress import Navigation
from estimator.measurements.node import Role
from estimator.paper_a.network import Network
from estimator.paper_a.node import GraphNode


class PaperAState:
    """The network, its nodes, counts and notices.

    Attributes:
        network: L and b.
        nodes: every node ever introduced, in order of introduction.
        navigations: of the boots whose units report raw samples, by node.
        counts: readings received, fused, not fused, dropped as outliers, too late.
        notices: not taken yet.
        said: keys of notices that are given once.
    """

    def __init__(self) -> None:
        self.network = Network()
        self.nodes: dict[str, GraphNode] = {}
        self.navigations: dict[str, Navigation] = {}
        self.counts = dict.fromkeys(("received", "fused", "not_fused", "outlier", "too_late"), 0)
        self.notices: list[Notice] = []
        self.said: dict[str, None] = {}

    def node_of(self, name: str, role: Role, t: float) -> GraphNode:
        """The node, introduced with a guessed role if no reading has named it before."""
        return self.nodes.setdefault(name, GraphNode(node=name, role=role, t=t))

    def end(self, node: GraphNode) -> Variable | Array:
        """A node as the end of an edge: its vertex, or where it stands as an anchor, 3 (m)."""
        return np.array(node.place_m) if node.mode == "anchor" else node.vertex

    def base_place(self) -> Array:
        """Where the base stands, 3 (m): the origin, unless it says otherwise."""
        anchors = (n.place_m for n in self.nodes.values() if n.mode == "anchor")
        return np.array(next(anchors, (0.0, 0.0, 0.0)))

    def fused(self, t: float, *names: str) -> None:
        """Count a reading as fused; its nodes are as new as it is."""
        self.counts["fused"] += 1
        for name in names:
            self.nodes[name] = replace(self.nodes[name], t=max(self.nodes[name].t, t))

    def refuse(self, code: NoticeCode, t: float, node: str, text: str, *, count: str = "not_fused") -> None:
        """Count a reading that is not fused, and say so, the first time in these words."""
        self.counts[count] += 1
        key = f"{node} {text}"
        if key not in self.said:
            self.said[key] = None
            self.notices.append(Notice(code=code, t=t, node=node, text=text))

    def estimates(self, covariance: Array) -> list[NodeEstimate]:
        """Every node ever introduced, in order of introduction.

        Args:
            covariance: Σ, n × n (m²).
        """
        return [self._estimate(node, covariance) for node in self.nodes.values()]

    def _estimate(self, node: GraphNode, covariance: Array) -> NodeEstimate:
        place_m, covariance_m2 = node.place_m, node.covariance_m2
        if node.mode == "vertex":
            rows = self.network.graph.rows(node.vertex)
            place_m = vector3(self.network.place(node.vertex))
            covariance_m2 = upper_triangle(covariance[rows, rows])
        return NodeEstimate(
            node=node.node,
            role=node.role,
            t=node.t,
            position_m=place_m,
            covariance_m2=covariance_m2,
            speed_mps=node.speed_mps if node.mode == "vertex" else None,
            retired=node.mode == "retired",
        )

    def relative(self, covariance: Array, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a`, cross terms included; None where either has no position.

        Args:
            covariance: Σ, n × n (m²).
            a: the one node.
            b: the other node.

        Raises:
            KeyError: a node is not known.
        """
        ends = self.nodes[a], self.nodes[b]
        if a == b or any(n.place_m is None and n.mode != "vertex" for n in ends):
            return None
        selector, total, delta = np.zeros((3, len(covariance))), np.zeros((3, 3)), np.zeros(3)
        for node, sign in zip(ends, (-1.0, 1.0), strict=True):
            if node.mode == "vertex":
                selector[:, self.network.graph.rows(node.vertex)] += sign * np.eye(3)
                delta += sign * self.network.place(node.vertex)
            else:
                delta += sign * np.array(node.place_m)
                ee, en, eu, nn, nu, uu = node.covariance_m2 or (0.0,) * 6
                total += np.array([[ee, en, eu], [en, nn, nu], [eu, nu, uu]])
        total += selector @ covariance @ selector.T
        return Relative(delta_m=vector3(delta), covariance_m2=upper_triangle(total))


def vector3(vector: Array) -> Vector3:
    """Three numbers as they leave the tracker."""
    east, north, up = vector.tolist()
    return east, north, up


def upper_triangle(matrix: Array) -> Covariance6:
    """ee, en, eu, nn, nu, uu of a 3 × 3 covariance."""
    (ee, en, eu), (_, nn, nu), (_, _, uu) = matrix.tolist()
    return ee, en, eu, nn, nu, uu
