"""Where a node stood a moment ago, from where its block is now."""

import math

from estimator.estimate import Vector3
from estimator.fusion.nodes import NodeState
from estimator.fusion.state import FusionState

NOWHERE = (0.0, 0.0, 0.0)
Marks = tuple[tuple[float, float, float, float], ...]


class Way:
    """The last seconds of a decided node, as the state holds them: its trail, turned and scaled.

    Attributes:
        start: first row of the node's block; −1: it is fixed.
        up_m: height of that block (m); 0 where it is fixed.
    """

    __slots__ = ("_cosine", "_marks", "_pose_t", "_rest", "_sine", "_stretch", "_velocity", "start", "up_m")

    def __init__(self, state: FusionState, node: NodeState) -> None:
        graph = state.graph
        fixed = node.mode == "fixed" and node.place_m is not None
        self.start = -1 if fixed else graph.starts[node.position]
        self._rest: Vector3 = node.place_m if fixed and node.place_m is not None else NOWHERE
        self.up_m = 0.0 if fixed else float(graph.reference[self.start + 2])
        self._pose_t = node.pose_t
        self._velocity: Vector3 | None = None
        self._marks: Marks = ()
        if node.mode == "free":
            east, north, up = graph.value(node.velocity).tolist()
            self._velocity = east, north, up
        elif node.mode == "unit" and len(node.trail) > 1:
            self._marks = node.trail
            psi, _, scale = graph.value(node.unit).tolist()
            self._cosine, self._sine, self._stretch = math.cos(psi), math.sin(psi), 1.0 + scale

    def offset(self, t: float) -> Vector3:
        """Where the node stood at `t` from its block, or, fixed, where it stands (m)."""
        if self._velocity is not None:
            since = t - self._pose_t
            east, north, up = self._velocity
            return east * since, north * since, up * since
        if not self._marks or t >= self._pose_t:
            return self._rest
        e, n, u = between(self._marks, t)
        _, last_e, last_n, last_u = self._marks[-1]
        e, n = (e - last_e) * self._stretch, (n - last_n) * self._stretch
        return self._cosine * e - self._sine * n, self._sine * e + self._cosine * n, u - last_u


def between(marks: Marks, t: float) -> Vector3:
    """Displacement at `t` on straight lines between a trail's marks, held beyond its ends (m)."""
    after = len(marks)
    while after > 0 and marks[after - 1][0] > t:
        after -= 1
    if after in (0, len(marks)):
        _, e, n, u = marks[after - 1 if after else 0]
        return e, n, u
    from_t, e, n, u = marks[after - 1]
    to_t, to_e, to_n, to_u = marks[after]
    share = (t - from_t) / (to_t - from_t)
    return e + share * (to_e - e), n + share * (to_n - n), u + share * (to_u - u)
