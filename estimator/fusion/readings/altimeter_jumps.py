"""Altimeters that jump: a fan at the door, another sensor, a door that opens; or a bearer who climbs unseen.

A step of air pressure is met by all inside at one time, and nobody's unit climbs: from then on each of their
altimeters is another one, which is off by anything. Where one alone jumps, either it or its bearer may have.
"""

from statistics import median

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.altimeter_zero import AltimeterZero
from estimator.fusion.learned.calibration import TRUSTED
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.variable import Variable

BEFORE_S, SUDDEN_S, NEWEST, LEAST = 30.0, 4.0, 3, 2
"""Readings from so long before a jump, but for the last ones before it, and so many of the newest tell by how
much: so many at least."""
ALIKE = 0.5
"""Two have jumped alike that differ by no more than this factor."""


def jump(
    state: FusionState, node: NodeState, known: AltimeterZero, since_t: float, jump_m: float
) -> NodeState:
    """Let the altimeters that have jumped be others from then on.

    Args:
        state: the fusion, changed in place: its window is to be solved again.
        node: whose altimeter has jumped.
        known: what is known of that.
        since_t: epoch of its first reading after it (s).
        jump_m: by how much it has (m).

    Returns:
        The node afterwards.
    """
    state.nodes[node.node] = replace(node, absolute=replace(node.absolute, zeroed=known))
    others = [o for o in state.nodes.values() if o.node != node.node and _alike(state, o, since_t, jump_m)]
    for one in (node.node, *(o.node for o in others)):
        another(state, one, since_t)
    if not others and node.mode == "unit":
        doubt_height(state, node, since_t, TRUSTED * jump_m**2)
    who = ", ".join([node.node, *(o.node for o in others)])
    text = f"the altimeter of {who} has jumped by {jump_m:+.1f} m: what it is off by is asked anew"
    state.say("outlier", known.t, node.node, text)
    state.due = True
    return state.nodes[node.node]


def another(state: FusionState, name: str, since_t: float) -> None:
    """Let a node's altimeter be another one from an epoch on (s), which may be off by anything."""
    node = state.nodes[name]
    known = node.absolute.zeroed
    if known.name is None:
        return
    new = new_altimeter(state, node, 2.0 * physics.HEIGHT_OFF_M)
    singles = state.ledger.table("singles").copy()
    mine = (singles[:, 6] == state.source(known.name)) & (singles[:, 0] >= since_t)
    singles[mine, 6] = state.source(new)
    state.ledger.replace("singles", singles)
    known = replace(known, name=new, odd=(), recent=())
    state.nodes[name] = replace(node, absolute=replace(node.absolute, zeroed=known))


def new_altimeter(state: FusionState, node: NodeState, sigma_m: float) -> str:
    """Name of one more altimeter, added to the graph.

    Args:
        state: the fusion, changed in place.
        node: who carries it.
        sigma_m: standard deviation of what it is off by, beforehand (m).
    """
    name = f"altimeter of {node.node} {len(state.altimeters)}"
    state.altimeters[name] = sigma_m
    state.graph.add_node(Variable("altimeter", name), (0.0,), (sigma_m,))
    return name


def _alike(state: FusionState, other: NodeState, since_t: float, jump_m: float) -> bool:
    """Whether another altimeter has jumped by the same at the same time, and no unit has told of a climb."""
    known = other.absolute.zeroed
    if known.name is None or not other.decided:
        return False
    climbs = other.mode == "unit" and not other.level
    if climbs and not known.odd:
        return False
    singles = state.ledger.table("singles")
    mine = singles[singles[:, 6] == state.source(known.name)]
    before = mine[(mine[:, 0] >= since_t - BEFORE_S) & (mine[:, 0] < since_t - SUDDEN_S), 3].tolist()
    after = mine[mine[:, 0] >= since_t, 3].tolist()[-NEWEST:]
    if min(len(before), len(after)) < LEAST:
        return False
    moved_m = median(after) - median(before)
    if climbs:
        moved_m = median(off_m for _, off_m in known.odd)
    return bool(ALIKE < moved_m / jump_m < 1.0 / ALIKE)


def doubt_height(state: FusionState, node: NodeState, since_t: float, doubt_m2: float) -> None:
    """Add to the variance of a node's height at an epoch (s): it may be he who has moved (m²)."""
    rows = np.array([state.graph.starts[node.position] + np.arange(3)])
    noise = np.diag([0.0, 0.0, doubt_m2]) + 1e-9 * np.eye(3)
    state.graph.advance(rows, state.graph.reference[rows], np.eye(3)[None], noise[None])
    steps = state.ledger.table("steps")
    told = steps[(steps[:, 1] == node.index) & (steps[:, 0] <= since_t), 0]
    t = float(told.max()) if len(told) else node.pose_t
    step = (0.0, 0.0, 0.0, 0.0, doubt_m2, 0.0, 0.0, 0.0, 1.0)
    state.ledger.add("steps", t, node.index, t, *step)
