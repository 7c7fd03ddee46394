"""Sightings of nodes whose position is not decided yet, and the kept positions that they were made from."""

from typing import Literal

import numpy as np

from estimator.fusion import physics
from estimator.fusion.held import end_of, measured
from estimator.fusion.introduce import tuple_of
from estimator.fusion.nodes import Clone, NodeState, Sighting
from estimator.fusion.rows import End
from estimator.fusion.state import FusionState
from estimator.measurements.node import MOVING_ROLES
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi


def sight(state: FusionState, undecided: NodeState, other: NodeState, reading: Range | Rssi) -> bool:
    """Keep a range or RSSI from a decided node to an undecided one until it can be used.

    Returns:
        False where the sighting is of no use: a moving node seen from a moving one.
    """
    moving = undecided.role in MOVING_ROLES
    if other.moving and moving:
        return False
    end = _kept(state, other, reading.t) if other.moving else end_of(state, other, reading.t)
    value, sigma, technology, sent = measured(reading)
    kind: Literal["range", "rssi"] = "range" if isinstance(reading, Range) else "rssi"
    sighting = Sighting(kind, reading.t, end.variable, end.offset_m, value - sent, sigma, technology)
    oldest = reading.t - (physics.MOVING_SIGHTINGS_S if moving else physics.SIGHTINGS_S)
    known = [s for s in state.sightings.get(undecided.node, ()) if s.t >= oldest]
    if len(known) >= physics.SIGHTINGS_MAX:
        known = known[::2]
        state.tried[undecided.node] = len(known)
    state.sightings[undecided.node] = (*known, sighting)
    return True


def _kept(state: FusionState, node: NodeState, t: float) -> End:
    """A moving node at `t`, as an offset from its newest clone; a new clone where it has moved on."""
    clones = state.clones.get(node.node, ())
    here = state.graph.value(node.position)
    step = state.clone_step.get(node.node, physics.CLONE_STEP_M)
    if clones:
        clone = clones[-1]
        there = state.graph.value(clone.position)
        near = float(np.hypot(*(here - there)[:2])) < step and node.way_m - clone.way_m < 2.0 * step
        if near:
            return End(clone.position, tuple_of(here + offset_of(state, node, t) - there))
        if clone.t == node.pose_t:
            return End(clone.position, tuple_of(offset_of(state, node, t)))
    clone = Clone(node.node, node.pose_t, node.way_m)
    state.graph.add_node(clone.position, here.copy(), (np.inf,) * 3)
    kept, moved = state.graph.rows(clone.position).start, state.graph.rows(node.position).start
    axes = np.arange(3)
    state.graph.add_measurements(
        np.column_stack([kept + axes, moved + axes]),
        np.tile([1.0, -1.0], (3, 1)),
        np.full(3, physics.CLONE_SIGMA_M**-2),
        np.zeros(3),
    )
    state.clones[node.node] = (*clones, clone)
    return End(clone.position, tuple_of(offset_of(state, node, t)))


def offset_of(state: FusionState, node: NodeState, t: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Offset of a moving node's end at `t` as an array, 3 (m)."""
    return np.array(end_of(state, node, t).offset_m)


def prune(state: FusionState) -> None:
    """Marginalise kept positions that no sighting needs, and thin them where there are too many."""
    if not state.clones:
        return
    for name in [n for n, node in state.nodes.items() if node.mode != "undecided" and n in state.sightings]:
        del state.sightings[name]
    while sum(len(c) for c in state.clones.values()) > physics.CLONES_MAX:
        name = max(state.clones, key=lambda n: len(state.clones[n]))
        gone = {c.position for c in state.clones[name][-2::-2]}
        state.clone_step[name] = 2.0 * state.clone_step.get(name, physics.CLONE_STEP_M)
        for seen, sightings in state.sightings.items():
            state.sightings[seen] = tuple(s for s in sightings if s.other not in gone)
            state.tried[seen] = min(state.tried.get(seen, 0), len(state.sightings[seen]))
        _drop_unneeded(state)
    _drop_unneeded(state)


def _drop_unneeded(state: FusionState) -> None:
    needed = {s.other for sightings in state.sightings.values() for s in sightings}
    gone = [c.position for clones in state.clones.values() for c in clones if c.position not in needed]
    state.graph.delete_nodes(gone)
    for name, clones in list(state.clones.items()):
        kept = tuple(c for c in clones if c.position in needed)
        if kept:
            state.clones[name] = kept
        else:
            del state.clones[name]
            state.clone_step.pop(name, None)
