"""A unit that is no good is doubted: what is told of its bearer holds two ways.

Where ranges, or powers of who is not ranged, speak against the way of a unit and for its rival
(`learned.rival`), the covariance holds the rival's place by how likely it is. The unit is followed all the
same: it may be a clock that is off, or a radio that is not on him.
"""

import math
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.learned.noise import LearnedNoise
from estimator.fusion.learned.rival import DOUBTED, LED_ASTRAY, MEMORY_S, RARE
from estimator.fusion.memory.ledger import RANGE, UNTOLD_POWER
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.silence import SILENT_S
from estimator.fusion.rows.rival_kernels import RivalUpdate, Units, rivals_of, units_from
from estimator.fusion.rows.rows import KIND
from estimator.graph.dense import Array

CLEAR = 4.0
"""Log odds from which on it is said that ranges contradict a unit: 50 to 1."""
KNOWN_S = 3.0
"""So soon after somebody was where his radio was, and nobody knew how he went, ranges tell where he is."""
AWAY_M, AWAY_SIGMAS = 1.0, 1.5
"""From when on somebody's rival is elsewhere."""
LIKELY = 0.2
"""From which share on it is asked again soon whether a frame has turned."""
SPOKEN = 0.5
"""So much more than nothing (log odds) speaks against a unit that powers are asked on."""


class QuestionedUnits(NamedTuple):
    """Of whom a tick's ranges, or powers, are asked.

    Attributes:
        nodes: all who have a unit.
        epochs: that the position of each refers to (s); NaN: he is not asked about.
        told: the same as numbers.
    """

    nodes: list[NodeState]
    epochs: list[float]
    told: Units


NOBODY = QuestionedUnits([], [], units_from([], []))


def ask(state: FusionState, table: Array) -> QuestionedUnits:
    """Of whom to ask a tick's ranges, or powers, whose ways foretell them.

    Args:
        state: the fusion; who is not asked about any more loses his rival.
        table: of the tick's readings, see `rows.Row`.
    """
    nodes = [node for node in state.nodes.values() if node.mode == "unit"]
    if not nodes or not len(table):
        return NOBODY
    powers = _asked_by_powers(state, nodes)
    if not any(powers) and RANGE not in table[:, KIND].tolist():
        return NOBODY
    starts, asked_t, rows, some = state.graph.starts, list[float](), list[tuple[float, float, bool]](), False
    for node, by_powers in zip(nodes, powers, strict=True):
        asked = _asked(node)
        asked_t.append(node.pose_t if asked else math.nan)
        rows.append((starts[node.position], asked_t[-1], by_powers))
        some = some or asked or node.rival is not None
    # Where nobody is asked about there is something to do only for who was.
    if not some:
        return NOBODY
    return QuestionedUnits(nodes, asked_t, units_from(rows, [node.rival for node in nodes]))


def answer(state: FusionState, asked: QuestionedUnits, found: RivalUpdate) -> None:
    """Take down the rivals that a tick's readings have told of.

    Args:
        state: the fusion: takes them.
        asked: of whom they were asked.
        found: what has come of it.
    """
    if not found.heard:
        return
    for node, asked_t, rival in zip(asked.nodes, asked.epochs, rivals_of(found), strict=True):
        if math.isnan(asked_t) and node.rival is not None:
            state.nodes[node.node] = replace(node, rival=None)
        if rival is None:
            continue
        state.nodes[node.node] = replace(node, rival=rival)
        if rival.odds > CLEAR and (node.rival is None or node.rival.odds <= CLEAR):
            by = "powers" if math.isinf(rival.ranged_t) else "ranges"
            text = f"{by} contradict the unit of {node.node}: it may be worn wrongly, or by another"
            state.say("outlier", node.pose_t, node.node, text)
            state.due = True


def may_have_turned(node: NodeState) -> bool:
    """Whether the frame of a unit may so well have turned on the way that it is asked again soon."""
    return sum(other.share for other in node.detours) > LIKELY


def leads_astray(node: NodeState) -> bool:
    """Whether a unit is clearly contradicted, or its frame may well have turned."""
    if node.mode != "unit":
        return False
    return may_have_turned(node) or (node.rival is not None and node.rival.odds > CLEAR)


def is_noisy(node: NodeState) -> bool:
    """Whether a unit has become far noisier than was assumed: its bearer is shown where his rival has him."""
    return node.walk_factors[0] > LED_ASTRAY


def is_contradicted(node: NodeState) -> bool:
    """Whether readings speak against a unit: for its rival, or it has become far noisier than was assumed."""
    return is_noisy(node) or (node.rival is not None and node.rival.odds > DOUBTED)


def leads_elsewhere(node: NodeState, place_m: Array, t: float) -> bool:
    """Whether a unit that is contradicted has led its bearer away from where his rival has him.

    Args:
        node: of the unit.
        place_m: where it has led him: east, north (m).
        t: at which epoch (s).
    """
    if node.rival is None or not is_contradicted(node):
        return False
    there_m, unsure = node.rival.place(t)
    off = there_m - place_m
    return float(off @ off) > AWAY_M**2 and float(off @ np.linalg.solve(unsure, off)) > AWAY_SIGMAS**2


def _asked(node: NodeState) -> bool:
    """Whether a unit leads its bearer, and one place is all that it may have led him to."""
    if (
        node.turned
        or (node.otherwise and not all(other.by_unit for other in node.otherwise))
        or node.apart is not None
        or node.carried_t is not None
        or node.pose_t < node.joined_t + KNOWN_S
        or node.unit_t is None
    ):
        return False
    return node.pose_t <= node.unit_t + SILENT_S


def _asked_by_powers(state: FusionState, units: list[NodeState]) -> list[bool]:
    """Of which units powers are asked; a rival that only powers told of is forgotten where they are not."""
    known = [noise for name, noise in state.noise.items() if name.startswith(UNTOLD_POWER)]
    powers, odd = [False] * len(units), None
    for i, node in enumerate(units if known else ()):
        rival = node.rival
        if rival is not None and node.pose_t <= rival.ranged_t + MEMORY_S:
            continue
        if odd is None:
            odd = any(map(_odd, known))
        powers[i] = odd or (rival is not None and rival.odds > RARE + SPOKEN)
        if rival is not None and math.isinf(rival.ranged_t) and not powers[i]:
            state.nodes[node.node] = units[i] = replace(node, rival=None)
    return powers


def _odd(noise: LearnedNoise) -> bool:
    """Whether powers are off by more, or more alike, than was assumed: a bad unit makes them so, or walls."""
    factor, shared, _ = noise.terms(0.0)
    return factor > 1.0 or shared > physics.SHARED_NOISE
