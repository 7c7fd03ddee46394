"""A unit that is no good is doubted: what is told of its bearer holds two ways.

Where ranges speak against the way of a unit and for its rival (`learned.rival`), the covariance holds the
rival's place by how likely it is. The unit is followed all the same: it may be a clock that is off, or a
radio that is not on him.
"""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fusion.learned import rival as rivals
from estimator.fusion.learned.rival import Link, Rival
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.silence import SILENT_S
from estimator.fusion.rows.foretold import foretell
from estimator.graph.dense import Array

CLEAR = 4.0
"""Log odds from which on it is said that ranges contradict a unit: 50 to 1."""
AGAIN_S = 5.0
"""As long as its unit is believed a rival follows it within so many seconds: it was right until now."""
CALM, STIRRED = -5.0, -1.0
"""Log odds between which a rival goes its own way more and more."""


def compare(state: FusionState, table: Array, epochs: Array) -> None:
    """Ask of a tick's ranges whose ways foretell them, before they are taken in.

    Args:
        state: the fusion: takes rivals.
        table: of the tick's readings, see `rows.Row`.
        epochs: theirs, m (s).
    """
    graph = state.graph
    units = [node for node in state.nodes.values() if node.mode == "unit"]
    if not units or not len(table):
        return
    starts = np.array([graph.starts[node.position] for node in units], dtype=np.intp)
    told, own = foretell(table, epochs, starts, graph.information, graph.reference)
    if not len(told):
        return
    for i, node in enumerate(units):
        if not _asked(node):
            if node.rival is not None:
                state.nodes[node.node] = replace(node, rival=None)
            continue
        mine = told[told[:, rivals.UNIT] == i]
        if len(mine):
            place_m = graph.reference[starts[i] : starts[i] + 2]
            found = _followed(node, mine, place_m, _covariance(*own[i].tolist()))
            state.nodes[node.node] = replace(node, rival=found)
            if found.odds > CLEAR and (node.rival is None or node.rival.odds <= CLEAR):
                text = f"ranges contradict the unit of {node.node}: it may be worn wrongly, or by another"
                state.say("outlier", node.pose_t, node.node, text)


def _asked(node: NodeState) -> bool:
    """Whether a unit leads its bearer, and one place is all that it may have led him to."""
    if node.turned or node.otherwise or node.apart is not None or node.unit_t is None:
        return False
    return node.pose_t <= node.unit_t + SILENT_S


def _covariance(east: float, north: float, both: float) -> Array:
    """Of a place, from the variances of east, of north and of their sum, 2 × 2 (m²)."""
    across = 0.5 * (both - east - north)
    return np.array([[east, across], [across, north]])


def _followed(node: NodeState, told: Array, place_m: Array, own: Array) -> Rival:
    """A unit's rival after more ranges.

    Args:
        node: the unit's.
        told: the ranges, see `rivals.TOLD`.
        place_m: where its bearer is by the unit: east, north (m).
        own: covariance of that, 2 × 2 (m²).
    """
    old = node.rival
    if old is None:
        begun_t = min(float(told[0, rivals.EPOCH]), node.pose_t)
        covariance = np.eye(4)
        covariance[:2, :2] = own
        links: tuple[Link, ...] = ()
        x, upper = np.array([*place_m.tolist(), 0.0, 0.0]), rivals.upper_of(covariance)
    else:
        begun_t, links = old.t, old.links
        x, upper = np.array(old.state), np.array(old.covariance)
    gains = np.empty(len(told))
    x, covariance, t = rivals.follow(x, upper, begun_t, told, gains)
    until = max(t, node.pose_t)
    links = _links(links, told, gains)
    odds = rivals.odds_of(links, until)
    believed = min(max((STIRRED - odds) / (STIRRED - CALM), 0.0), 1.0)
    share = believed * -math.expm1((begun_t - until) / AGAIN_S)
    x, upper = rivals.drawn(x, covariance, until - t, place_m, own, share)
    return Rival(until, tuple(x.tolist()), tuple(upper.tolist()), links, odds)


def _links(known: tuple[Link, ...], told: Array, gains: Array) -> tuple[Link, ...]:
    """What each link tells with more ranges, of those that have told anything lately."""
    links = {link.number: link for link in known}
    for number, t, gain in zip(
        told[:, rivals.LINK].astype(int).tolist(), told[:, rivals.EPOCH].tolist(), gains.tolist(), strict=True
    ):
        before = links.get(number)
        kept, tells = 0.0, 1.0
        if before is not None:
            waited_s = max(t - before.t, 0.0)
            kept = before.gain * math.exp(-waited_s / rivals.MEMORY_S)
            tells = min(waited_s / rivals.SPELL_S, 1.0)
        links[number] = Link(number, t, min(max(kept + tells * gain, rivals.LEAST), rivals.MOST))
    newest_t = float(told[-1, rivals.EPOCH])
    return tuple(links[n] for n in sorted(links) if links[n].t > newest_t - rivals.MEMORY_S)
