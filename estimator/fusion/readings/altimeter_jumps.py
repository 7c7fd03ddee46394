"""Altimeters that jump: a fan at the door, another sensor, a door that opens; or bearers who ride or fall.

A step of air pressure is met by all inside at one time, and nobody's unit climbs: from then on each of their
altimeters is another one. Who rides in a lift stands, and his unit tells that he stays where he is; who falls
through a floor may have a unit that tells nothing of it (decision 0127).
"""

from statistics import median

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.altimeter_zero import AltimeterZero
from estimator.fusion.learned.unseen_rise import Circumstances, Rise, risen_p
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.readings.unseen_rises import (
    are_together,
    doubt_companions,
    goes_back,
    has_stood,
    share_jump,
)

BEFORE_S, SUDDEN_S, NEWEST, LEAST = 30.0, 4.0, 3, 2
"""Readings from so long before a jump, but for the last ones before it, and so many of the newest tell by how
much: so many at least."""
ALIKE = 0.5
"""Two have jumped alike that differ by no more than this factor."""
SAME_TIME_S = 6.0
"""What has begun within so long of a jump is the same one."""
OUTSIDE_M = 10.0
"""Who is nearer to the base may be outside, where no fan presses."""
TOLD_P = 0.1
"""From so likely on it is told that they may have gone up or down."""


def jump(
    state: FusionState, node: NodeState, known: AltimeterZero, since_t: float, jump_m: float
) -> NodeState:
    """Let the altimeters that have jumped be others from then on, or their bearers have moved, or both.

    Args:
        state: the fusion, changed in place: its window is to be solved again.
        node: whose altimeter has jumped.
        known: what is known of that.
        since_t: epoch of its first reading after it (s).
        jump_m: by how much it has (m).

    Returns:
        The node afterwards.
    """
    node = state.nodes[node.node] = replace(node, absolute=replace(node.absolute, zeroed=known))
    others = [o for o in state.nodes.values() if o.node != node.node and o.absolute.zeroed.name is not None]
    alike = [node, *(o for o in others if _alike(state, o, since_t, jump_m))]
    whole_m = _whole(known, since_t, jump_m).up_m
    # Another crew may be on a stair meanwhile.
    group = [one for one in alike if are_together(state, node, one) or not _may_climb(one, jump_m)]
    risen = [*group, *(o for o in others if o not in alike and _has_just_risen(o, since_t, jump_m))]
    witnesses = [o for o in others if o not in risen and _is_witness(state, o, since_t, jump_m)]
    together = all(are_together(state, node, one) for one in risen)
    # Who falls lies afterwards; a crew that rides stands, and one that walks into a stairwell may wait there.
    standing = all(has_stood(state, one, since_t, lately=len(risen) == 1) for one in group)
    p = risen_p(whole_m, Circumstances(len(risen), together, standing, len(witnesses)))
    alike = group if p > TOLD_P else alike
    for one in alike:
        if p > TOLD_P or not goes_back(state, one, since_t, jump_m):
            share_jump(state, one, _whole(one.absolute.zeroed, since_t, jump_m), p)
    who = ", ".join(one.node for one in alike)
    if p > TOLD_P:
        doubt_companions(state, node, since_t, p * whole_m**2)
        text = f"{who} may have gone {'up' if whole_m > 0.0 else 'down'} by {abs(whole_m):.1f} m unseen, "
        text += f"by a lift or a fall ({100.0 * p:.0f} %); or the altimeter is off by that now"
        state.say("conflict", known.t, node.node, text)
    else:
        text = f"the altimeter of {who} has jumped by {jump_m:+.1f} m: what it is off by is asked anew"
        state.say("outlier", known.t, node.node, text)
    state.due = True
    return state.nodes[node.node]


def _whole(known: AltimeterZero, since_t: float, jump_m: float) -> Rise:
    """A jump, with what it may be the rest of."""
    before = known.rise
    if before.goes_on(since_t, jump_m):
        return Rise(before.since_t, known.t, before.up_m + jump_m, before.was)
    return Rise(since_t, known.t, jump_m, known.name or "")


def _alike(state: FusionState, other: NodeState, since_t: float, jump_m: float) -> bool:
    """Whether another altimeter has jumped by the same at the same time, and no unit has told of a climb."""
    known = other.absolute.zeroed
    if not other.decided:
        return False
    climbs = other.mode == "unit" and not other.level
    if climbs and not known.odd:
        return False
    moved_m = _moved_m(state, known, since_t)
    if moved_m is None:
        return False
    if climbs:
        moved_m = median(off_m for _, off_m in known.odd)
    return bool(ALIKE < moved_m / jump_m < 1.0 / ALIKE)


def _may_climb(other: NodeState, jump_m: float) -> bool:
    """Whether a stair on its way may be what another altimeter tells: its unit sees none."""
    known = other.absolute.zeroed
    return other.mode == "unit" and other.level and bool(known.recent) and not known.steep(jump_m)


def _has_just_risen(other: NodeState, since_t: float, jump_m: float) -> bool:
    """Whether another altimeter has been found to have jumped to the same side at the same time."""
    rise = other.absolute.zeroed.rise
    during = rise.since_t - SAME_TIME_S < since_t < rise.until_t + SAME_TIME_S
    return other.decided and during and rise.up_m * jump_m > 0.0


def _is_witness(state: FusionState, other: NodeState, since_t: float, jump_m: float) -> bool:
    """Whether another altimeter inside has not jumped, though it was read before and after."""
    if not (other.decided and other.moving) or other.role in physics.OUTSIDE_ROLES:
        return False
    if np.hypot(*(state.place(other) - state.base_place())[:2]) < OUTSIDE_M:
        return False
    moved_m = _moved_m(state, other.absolute.zeroed, since_t)
    return moved_m is not None and abs(moved_m) < ALIKE * abs(jump_m)


def _moved_m(state: FusionState, known: AltimeterZero, since_t: float) -> float | None:
    """By how much an altimeter reads more after an epoch than before it (m); None: nobody can tell."""
    singles = state.ledger.table("singles")
    mine = singles[singles[:, 6] == state.source(known.name or "")]
    before = mine[(mine[:, 0] >= since_t - BEFORE_S) & (mine[:, 0] < since_t - SUDDEN_S), 3].tolist()
    after = mine[mine[:, 0] >= since_t, 3].tolist()[-NEWEST:]
    return median(after) - median(before) if min(len(before), len(after)) >= LEAST else None
