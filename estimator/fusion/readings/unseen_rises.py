"""What becomes of heights, and of what altimeters are off by, where either has jumped.

Both are held possible, each as far as it is likely: a jump is shared between how high its bearer is and what
his altimeter is off by, and what else tells heights may shift it (decision 0127).
"""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.unseen_rise import Rise
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.variable import Variable

ANYTHING_M = 2.0 * physics.HEIGHT_OFF_M
"""What one that is another from now on may be off by."""
TOGETHER_M, SIGMAS = 3.0, 2.0
"""Who is in one lift is no farther apart, and shown no farther but for what their places are unsure by."""
STOOD_S, STOOD_M = 2.0, 0.7
"""Who stands goes no farther in twice so long, by what a unit at rest tells."""


def another(state: FusionState, name: str, since_t: float) -> None:
    """Let a node's altimeter be another one from an epoch on (s), which may be off by anything."""
    node = state.nodes[name]
    if node.absolute.zeroed.name is not None:
        _rename(state, node, since_t, new_altimeter(state, node, 0.0, ANYTHING_M))


def new_altimeter(state: FusionState, node: NodeState, off_m: float, sigma_m: float) -> str:
    """Name of one more altimeter, added to the graph.

    Args:
        state: the fusion, changed in place.
        node: who carries it.
        off_m: what it is off by, beforehand (m).
        sigma_m: standard deviation of that (m).
    """
    name = f"altimeter of {node.node} {len(state.altimeters)}"
    state.altimeters[name] = off_m, sigma_m
    state.graph.add_node(Variable("altimeter", name), (off_m,), (sigma_m,))
    return name


def share_jump(state: FusionState, node: NodeState, rise: Rise, risen_p: float) -> None:
    """Share a jump between a node's height and what its altimeter is off by.

    With variances p j² and (1 − p) j² of two numbers that add up to j, the first one is p j ± √(p (1 − p)) j:
    the moments of what is j with probability p, and else nil.

    Args:
        state: the fusion, changed in place.
        node: whose altimeter has jumped.
        rise: the jump.
        risen_p: how likely it is the node that has moved.
    """
    known, was = node.absolute.zeroed, Variable("altimeter", rise.was)
    off_m, sigma_m = 0.0, ANYTHING_M
    if risen_p > 0.0 and was in state.graph:
        row = state.graph.starts[was]
        off_m = float(state.graph.value(was)[0])
        sigma_m = math.sqrt(float(state.graph.covariance()[row, row]) + (1.0 - risen_p) * rise.up_m**2)
        if node.mode == "unit":
            level_t = max(known.level_since(), rise.since_t) if known.recent else known.t
            _let_rise(state, node, (known.before(rise.since_t), level_t), risen_p * rise.up_m**2)
    _rename(state, node, rise.since_t, new_altimeter(state, node, off_m, sigma_m), rise)


def goes_back(state: FusionState, node: NodeState, since_t: float, jump_m: float) -> bool:
    """Let a node's altimeter be the one that it was before it jumped, where that is undone now.

    Args:
        state: the fusion, changed in place.
        node: who carries it.
        since_t: epoch of the first reading after the second jump (s).
        jump_m: by how much that is (m).

    Returns:
        False: it is not undone.
    """
    before = node.absolute.zeroed.rise
    if not before.is_undone(jump_m) or Variable("altimeter", before.was) not in state.graph:
        return False
    _rename(state, node, since_t, before.was)
    return True


def doubt_companions(state: FusionState, node: NodeState, since_t: float, doubt_m2: float) -> None:
    """Let those without an altimeter who stand beside somebody be as unsure of their heights as he is.

    Args:
        state: the fusion, changed in place.
        node: who may have gone up or down.
        since_t: since when (s).
        doubt_m2: variance (m²).
    """
    for one in list(state.nodes.values()):
        beside = one.mode == "unit" and one.absolute.zeroed.name is None and are_together(state, node, one)
        if beside and has_stood(state, one, since_t):
            _let_rise(state, one, (since_t - STOOD_S, since_t + STOOD_S), doubt_m2)


def doubt_height(state: FusionState, node: NodeState, since_t: float, doubt_m2: float) -> None:
    """Add to the variance of a node's height at an epoch (s): it may be he who has moved (m²)."""
    _loosen(state, node, doubt_m2)
    steps = state.ledger.table("steps")
    told = steps[(steps[:, 1] == node.index) & (steps[:, 0] <= since_t), 0]
    t = float(told.max()) if len(told) else node.pose_t
    step = (0.0, 0.0, 0.0, 0.0, doubt_m2, 0.0, 0.0, 0.0, 1.0)
    state.ledger.add("steps", t, node.index, t, *step)


def are_together(state: FusionState, one: NodeState, other: NodeState) -> bool:
    """Whether two nodes may be at one place."""
    if any(node.position not in state.graph for node in (one, other)):
        return False
    covariance = state.graph.covariance()
    here, there = (state.graph.starts[node.position] + np.arange(2) for node in (one, other))
    apart_m = float(np.hypot(*(state.place(one) - state.place(other))[:2]))
    unsure_m2 = np.trace(covariance[np.ix_(here, here)] + covariance[np.ix_(there, there)])
    unsure_m2 -= 2.0 * np.trace(covariance[np.ix_(here, there)])
    return apart_m < TOGETHER_M + SIGMAS * math.sqrt(max(float(unsure_m2), 0.0))


def has_stood(state: FusionState, node: NodeState, since_t: float, *, lately: bool = False) -> bool:
    """Whether a node stood at an epoch (s), or, if that is asked, has gone nowhere lately.

    Who has no unit may have.

    Lifts are of steel: of who was silent in one, a step tells afterwards how far he has got in all that time.
    """
    steps = state.ledger.table("steps")
    mine = steps[steps[:, 1] == node.index]
    gone_m, newest_t = np.hypot(mine[:, 3], mine[:, 4]), mine[-1, 0] if len(mine) else since_t
    lasted_s = mine[:, 0] - mine[:, 2]
    at = (mine[:, 0] > since_t - STOOD_S) & (mine[:, 2] < since_t + STOOD_S)
    if (at & (lasted_s > 2.0 * STOOD_S) & (gone_m * 2.0 * STOOD_S < STOOD_M * lasted_s)).any():
        return True
    ends_t = (since_t + STOOD_S, newest_t) if lately else (since_t + STOOD_S,)
    for end_t in ends_t:
        begin_t = end_t - 2.0 * STOOD_S
        if float(gone_m[(mine[:, 0] > begin_t) & (mine[:, 0] <= end_t)].sum()) < STOOD_M:
            return True
    return False


def _rename(state: FusionState, node: NodeState, since_t: float, new: str, rise: Rise | None = None) -> None:
    """Let another altimeter have read what a node's, or the one before a jump, has read since then (s)."""
    known, rise = node.absolute.zeroed, rise or Rise()
    singles = state.ledger.table("singles").copy()
    sources = [state.source(name) for name in (known.name, rise.was) if name]
    singles[np.isin(singles[:, 6], sources) & (singles[:, 0] >= since_t), 6] = state.source(new)
    state.ledger.replace("singles", singles)
    known = replace(known, name=new, odd=(), recent=(), rise=rise)
    state.nodes[node.node] = replace(node, absolute=replace(node.absolute, zeroed=known))


def _let_rise(state: FusionState, node: NodeState, during: tuple[float, float], doubt_m2: float) -> None:
    """Let a node have gone up or down by so much (m²), in what its unit has told between two epochs (s)."""
    steps = state.ledger.table("steps").copy()
    lasted_s = steps[:, 0] - steps[:, 2]
    mine = (steps[:, 1] == node.index) & (steps[:, 0] > during[0]) & (steps[:, 2] < during[1])
    if not lasted_s[mine].sum() > 0.0:
        doubt_height(state, node, during[0], doubt_m2)
        return
    _loosen(state, node, doubt_m2)
    steps[mine, 7] += doubt_m2 * lasted_s[mine] / lasted_s[mine].sum()
    state.ledger.replace("steps", steps)


def _loosen(state: FusionState, node: NodeState, doubt_m2: float) -> None:
    """Let a node's height be unsure by more in the graph (m²)."""
    rows = np.array([state.graph.starts[node.position] + np.arange(3)])
    noise = np.diag([0.0, 0.0, doubt_m2]) + 1e-9 * np.eye(3)
    state.graph.advance(rows, state.graph.reference[rows], np.eye(3)[None], noise[None])
