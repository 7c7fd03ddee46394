"""Who is taken to enter at the base: his unit reports, and nobody has said where he entered.

Who comes with the first crew, or has just been introduced, is at the base. Of whom nothing was heard while
others were inside nobody knows whether he comes in only now, or has been inside all the time: a gateway was
cut off, or a unit switched on late (decision 0105).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.entering.introduce import place, turn_sigma
from estimator.fusion.entering.sightings import heard_between
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.silence import LONGEST_S, gone_m2
from estimator.measurements.base import PairReading
from estimator.measurements.bearing import Bearing

ENTERS, ON_THE_ROSTER, STARTED_LATE = 0.5, 0.9, 0.1
"""How likely it is that who is heard of late has only come now; who had been introduced long before: most
units are switched on at the door; and who was there already when a log began that began too late."""


def inside_s(state: FusionState, node: NodeState, t: float) -> float:
    """How long somebody may have been inside at an epoch without having been heard of (s).

    Args:
        state: the fusion.
        node: who moves, undecided.
        t: the epoch at which his unit reported first, or was heard of since (s).
    """
    if node.inside:
        return math.inf
    entered_t = t if state.entered_t is None else state.entered_t
    return max(t - max(entered_t, node.introduced_t), 0.0)


def may_be_inside(state: FusionState, node: NodeState, t: float) -> bool:
    """Whether somebody may have been inside for long when his unit reported first, by an epoch (s)."""
    return inside_s(state, node, min(node.whole_t, t)) > physics.UNSEEN_S


def gone_since_m(node: NodeState, s: float) -> float:
    """How far along each axis one may have gone inside in a time (m)."""
    if math.isinf(s):
        return physics.REACH_M
    usual_mps, memory_s = physics.SPEED_SIGMA_MPS[node.role][0], physics.SPEED_MEMORY_S[node.role]
    return min(math.sqrt(gone_m2(usual_mps, memory_s, s, 0.0)), physics.REACH_M)


def turned_since(state: FusionState, node: NodeState, t: float) -> float | None:
    """How unsure it is by now what the frame of somebody's unit was told to face, if that tells (rad).

    Its gyro has turned it ever since it was switched on. Of who was introduced too late it is taken as told.

    Args:
        state: the fusion.
        node: who moves, found by readings.
        t: the epoch (s).
    """
    if node.inside or not may_be_inside(state, node, t):
        return node.heading_sigma_rad
    on_s = min(inside_s(state, node, t), LONGEST_S)
    return math.hypot(turn_sigma(node), state.bias_sigma_radps(node) * on_s)


def _enters(state: FusionState, node: NodeState) -> float:
    """How likely it is that somebody who is heard of late has only come now."""
    if math.isinf(inside_s(state, node, state.newest_t)):
        return STARTED_LATE
    return ON_THE_ROSTER if node.named else ENTERS


class BasePrior(NamedTuple):
    """What is known without any reading of who may just have entered.

    Attributes:
        place_m: the base: east, north, up (m).
        sigma_m: how far from it he is by now, along each horizontal axis (m).
        reach_m: how far he may be if he has been inside, along each (m).
        log_odds: by how much it is likelier that he is where he most likely is if he has just entered.
    """

    place_m: Vector3
    sigma_m: float
    reach_m: float
    log_odds: float


def prior_at_base(state: FusionState, node: NodeState, t: float) -> BasePrior | None:
    """What is known of an undecided node at an epoch; None: nothing tells that it may enter at the base.

    Args:
        state: the fusion.
        node: it is.
        t: the epoch (s).
    """
    reports, based = math.isfinite(node.whole_t), any(n.mode == "fixed" for n in state.nodes.values())
    if node.inside or not reports or not based or not may_be_inside(state, node, t):
        return None
    entry_m, enters = physics.ENTRY_SIGMA_M[0], _enters(state, node)
    sigma_m = math.hypot(entry_m, gone_since_m(node, t - node.whole_t))
    reach_m = math.hypot(entry_m, gone_since_m(node, inside_s(state, node, t)))
    return BasePrior(
        state.base_place(),
        sigma_m,
        reach_m,
        math.log(enters / (1.0 - enters)) + 2.0 * math.log(reach_m / sigma_m),
    )


def waits_for_ranges(state: FusionState, node: NodeState, t: float) -> bool:
    """Whether ranges or signals are to tell where an undecided node is, rather than that it is at the base.

    Soon, where no base says where it entered; as long as it is heard, where it may have been inside for long.
    Who has been is at no base by now, however long they take.
    """
    if math.isinf(inside_s(state, node, t)):
        return True
    if may_be_inside(state, node, t):
        (_, heard_t), reported_s = heard_between(state, node), t - min(node.whole_t, t)
        return reported_s < physics.MOVING_SIGHTINGS_S or t - heard_t < physics.UNSEEN_S
    anchored = any(n.role in ("base", "anchor") and n.decided for n in state.nodes.values())
    based = any(n.mode == "fixed" for n in state.nodes.values())
    return anchored and not based and t - node.t < physics.WAIT_FOR_RANGES_S


def begin_at_base(state: FusionState, node: NodeState, t: float) -> None:
    """A responder whose first position nobody gave enters at the base: 3 m horizontally, 1 m in height.

    He is as unsure as he may have been inside already, and is nowhere again once he is heard.
    """
    across, _, upwards = physics.ENTRY_SIGMA_M
    long_s = inside_s(state, node, t)
    late = long_s > physics.UNSEEN_S
    if late:
        across = math.hypot(across, math.sqrt(1.0 - _enters(state, node)) * gone_since_m(node, long_s))
        upwards = physics.UNDECIDED_UP_SIGMA_M
    known = replace(node.absolute, beginning="unheard" if late else "assumed")
    place(state, replace(node, absolute=known), t, state.base_place(), (across, across, upwards))


def end_unheard(state: FusionState, readings: Sequence[PairReading]) -> bool:
    """Let those be nowhere again of whom nothing has told where they were, and who are heard now.

    A ring about a radio, or two places that fit, are no parabola about the base: readings are to find them as
    they find who has never begun.

    Args:
        state: the fusion, changed in place.
        readings: what is to be held between two nodes.

    Returns:
        Whether there are any.
    """
    unheard = {name for name, node in state.nodes.items() if node.absolute.beginning == "unheard"}
    if not unheard:
        return False
    stands = {name for name, node in state.nodes.items() if node.mode in ("fixed", "static")}
    heard = [
        name
        for reading in readings
        if not isinstance(reading, Bearing)
        for name, other in ((reading.a, reading.b), (reading.b, reading.a))
        if name in unheard and other in stands
    ]
    for name in dict.fromkeys(heard):
        end_way(state, state.nodes[name])
    return bool(heard)


def end_way(state: FusionState, node: NodeState) -> None:
    """End a way that begins where nobody knows, under its number, and begin another one of the same node."""
    state.graph.delete_nodes([v for v in (node.position, node.velocity, node.unit) if v in state.graph])
    state.ended[node.index] = replace(node, mode="retired", trail=())
    state.nodes[node.node] = NodeState(
        node=node.node,
        role=node.role,
        named=node.named,
        t=node.t,
        index=state.number(node.node),
        heading_rad=node.heading_rad,
        heading_sigma_rad=node.heading_sigma_rad,
        device=node.device,
        crew=node.crew,
        device_told_t=node.device_told_t,
        introduced_t=node.introduced_t,
        whole_t=node.whole_t,
    )
    state.due = True
