"""Introductions that came too late for their own epoch: what they say of a node for good still counts.

What it is, which unit it wears, and where it stands hold at the oldest epoch that can still be folded. Where
somebody who moves was, and what he faced, do not: he has entered long ago, and begins where readings allow
(decision 0026), not at the base. What was told or seen since, or told in time of what it is, goes before.
"""

from msgspec.structs import replace

from estimator.fusion.entering import corrections, reentry
from estimator.fusion.entering.guesses import forget_place
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.measurements.node import MOVING_ROLES, LateNode, Node
from estimator.measurements.position import Position


def take(state: FusionState, reading: LateNode) -> list[Position]:
    """Take in a `node` reading that came too late, and say what was taken of it.

    Args:
        state: the fusion, changed in place.
        reading: it is.

    Returns:
        Where it tells a node to stand that has a place already, as a fix that is still to be held.
    """
    known = state.nodes.get(reading.node)
    lasting = _lasting(known, reading)
    if known is not None and known.mode == "retired":
        _of_retired(state, known, reading, lasting)
        return []
    if known is not None and not known.named:
        _forget_guess(state, known, reading)
    told = corrections.take(state, lasting)
    node = state.nodes[reading.node]
    elsewhere = node.mode == "fixed" and lasting.position_m not in (None, node.place_m)
    if node.role != reading.role or elsewhere:
        return told  # refused, and said so
    node = replace(node, named=known is not None and known.named)
    if node.role not in MOVING_ROLES:
        # Of what stands the fix is as old as what was told or heard of it.
        node = replace(node, t=reading.told_t if known is None else max(known.t, reading.told_t))
    elif not node.decided:
        node = replace(node, inside=True)
    if lasting.position_m is not None:
        node = replace(node, place_told_t=reading.told_t)
    if lasting.device is not None:
        node = replace(node, device_told_t=reading.told_t)
    state.nodes[node.node] = node
    _say(state, reading, _taken(known, lasting), _left(known, reading, lasting))
    return told


def _lasting(known: NodeState | None, reading: LateNode) -> Node:
    """What a reading says of a node for good, but for what was told or seen since."""
    stands = reading.role not in MOVING_ROLES
    place = stands and (known is None or reading.told_t > known.place_told_t)
    device = known is None or reading.told_t > known.device_told_t
    return Node(
        t=reading.t,
        node=reading.node,
        role=reading.role,
        position_m=reading.position_m if place else None,
        sigma_m=reading.sigma_m if place else None,
        heading_rad=reading.heading_rad if place else None,
        heading_sigma_rad=reading.heading_sigma_rad if place else None,
        device=reading.device if device else None,
        crew=reading.crew if known is None or known.crew is None else None,
    )


def _forget_guess(state: FusionState, known: NodeState, reading: LateNode) -> None:
    """Forget where readings have put what was guessed to stand, and is no such thing.

    Who walks was nowhere: what was measured of him tells of no place. A base is where it is told to be.
    """
    moves, placed = reading.role in MOVING_ROLES, known.mode == "static"
    guessed = known.role not in MOVING_ROLES and known.mode in ("undecided", "static")
    if not guessed or not (moves or (placed and reading.role == "base")):
        return
    forget_place(state, known, moves)


def _of_retired(state: FusionState, known: NodeState, reading: LateNode, lasting: Node) -> None:
    """Of who has left, and was introduced again since, or before he left."""
    called, taken = state.called.get(known.node), list[str]()
    if reading.told_t > (known.t if called is None else called.t):
        reentry.note_introduction(state, lasting)
        if state.called.get(known.node) is lasting:
            state.nodes[known.node] = replace(known, inside=reading.role in MOVING_ROLES)
            taken = ["that it may come back"]
    elif known.named or known.place_m is not None:
        state.count("not_fused")
    else:
        state.nodes[known.node] = replace(known, role=reading.role)
        state.count("fused")
        taken = [f"its role ({reading.role})"]
    _say(state, reading, taken, [])


def _taken(known: NodeState | None, lasting: Node) -> list[str]:
    """What of an introduction is news, and counts."""
    place_m = None if known is None else known.place_m or known.absolute.told_m
    taken = [] if known is not None and known.named else [f"its role ({lasting.role})"]
    if lasting.device not in (None, None if known is None else known.device):
        taken.append("its device")
    if lasting.position_m not in (None, place_m):
        taken.append("where it stands")
    return taken


def _left(known: NodeState | None, reading: LateNode, lasting: Node) -> list[str]:
    """What of it would be news, and does not count."""
    place_m, heading_rad, device = None, None, None
    if known is not None:
        place_m, heading_rad = known.place_m or known.absolute.told_m, known.heading_rad
        device = known.device
    left = []
    if lasting.position_m is None and reading.position_m not in (None, place_m):
        left.append("where it was then")
    if lasting.heading_rad is None and reading.heading_rad not in (None, heading_rad):
        left.append("what it faced then")
    if lasting.device is None and reading.device not in (None, device):
        left.append("its device then")
    return left


def _say(state: FusionState, reading: LateNode, taken: list[str], left: list[str]) -> None:
    """Say what of an introduction counts and what does not; one that is repeated is no news."""
    if not taken and not left:
        return
    what = f"what counts is {', '.join(taken) or 'nothing'}"
    if left:
        what += f", what does not is {', '.join(left)}"
    text = f"{reading.node} was introduced too late, at t = {reading.told_t:.0f}: {what}"
    state.say("introduced_late", reading.told_t, reading.node, text, once=f"{reading.node} late: {what}")
