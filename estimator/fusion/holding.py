"""What is held against the graph together, and when: some wait for displacements that cover their epochs."""

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from itertools import chain
from operator import attrgetter

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering import base_entry, beginnings, late_start
from estimator.fusion.memory.hearing import Crossing
from estimator.fusion.memory.state import AnyHeld, FusionState
from estimator.fusion.motion.constant_velocity import move_free
from estimator.fusion.motion.dead_reckoning import drift_units
from estimator.fusion.readings import absolute, drops
from estimator.fusion.readings.pairs import AnyPair, Pairs
from estimator.fusion.rows.rows import Single, table_of
from estimator.fusion.update import update
from estimator.inertial.samples import AnyFolded
from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.bearing import Bearing
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.node import MOVING_ROLES
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.rssi import Rssi

SAME_EPOCH_S = 1e-6
PAIRS = (Rssi, Range, Crossing, Bearing)
HELD = (*PAIRS, Position, Altitude, Pressure, Drop)
"""The commonest first: that a reading is of a kind is told at once, that it is of none of several is not."""
PLACING = frozenset((Range, Position))
"""What tells where somebody is."""
LOOSE = ("free", "undecided")
"""How those move of whom nobody knows how, if they move."""
EPOCH = attrgetter("t")


def names_of(reading: AnyFolded | Crossing) -> tuple[str, ...]:
    """The nodes that a reading names."""
    if type(reading) is Displacement:
        return (reading.node,)
    if isinstance(reading, PAIRS):
        return reading.a, reading.b
    if isinstance(reading, Drop):
        return reading.node, reading.by
    return (reading.node,)


def covered(
    state: FusionState, readings: Sequence[AnyHeld], until_t: float, unwaited: set[str]
) -> list[AnyHeld]:
    """Readings to be held now; for the others a displacement that covers their epoch may still come.

    Args:
        state: the fusion: takes those that wait.
        readings: in order of epoch.
        until_t: newest epoch (s).
        unwaited: nodes for whose displacements nothing waits.
    """
    told_until, awaited = _told_until(state), _awaited(state, until_t)
    soonest = min((*told_until.values(), *awaited.values()), default=math.inf)
    if not readings or readings[-1].t <= soonest:
        state.waiting = ()
        return list(readings)
    # None waits for a displacement that should have come long ago.
    units = {name: max(t, until_t - state.nodes[name].wait_s) for name, t in told_until.items()} | awaited
    told = bisect_right(readings, min(units.values()), key=EPOCH)
    ready = list(readings[:told])
    waiting: list[AnyHeld] = []
    for reading in readings[told:]:
        names = names_of(reading)
        wait = reading.t > min(units.get(name, math.inf) for name in names)
        (waiting if wait and unwaited.isdisjoint(names) else ready).append(reading)
    state.waiting = tuple(waiting)
    return ready


def _awaited(state: FusionState, until_t: float) -> dict[str, float]:
    """The epoch since when each unit's way is still to be told whose first report is to come, by node (s)."""
    for name in [name for name, one in state.awaited.items() if one.told_t < until_t]:
        del state.awaited[name]
    free = {name for name in state.awaited if name in state.nodes and state.nodes[name].mode == "free"}
    return {
        name: max(state.awaited[name].t, state.nodes[name].pose_t) + SAME_EPOCH_S for name in sorted(free)
    }


def _told_until(state: FusionState) -> dict[str, float]:
    """The epoch up to which each unit's own way is known, by node (s)."""
    return {n.node: n.pose_t + SAME_EPOCH_S for n in state.nodes.values() if n.mode == "unit"}


def flush(state: FusionState) -> None:
    """Hold what waits for a displacement against the newest positions."""
    waiting, state.waiting = state.waiting, ()
    for part in parts_of(state, waiting):
        if part:
            hold(state, part, [])


def parts_of(state: FusionState, readings: Sequence[AnyHeld]) -> list[Sequence[AnyHeld]]:
    """Readings that are held together: all, but by parts of a tick where nobody knows how someone has moved.

    A unit's own way tells where it stood at each epoch that it covers. A velocity that changes tells so for a
    moment only, and of who is silent nothing is told: held at one epoch, seconds of his readings would show
    him where he was on average, and sure of it.

    Args:
        state: the fusion.
        readings: in order of epoch.
    """
    units = _told_until(state)
    soonest = min(units.values(), default=math.inf)
    loose = {n.node for n in state.nodes.values() if n.mode in LOOSE and n.role in MOVING_ROLES}
    if not loose and (not readings or readings[-1].t <= soonest):
        return [readings]
    together: list[AnyHeld] = []
    parts: dict[int, list[AnyHeld]] = {}
    for reading in readings:
        names = names_of(reading)
        if loose.isdisjoint(names) and reading.t <= min(units.get(name, math.inf) for name in names):
            together.append(reading)
        else:
            parts.setdefault(int(reading.t / physics.FREE_TICK_S), []).append(reading)
    return [together, *(parts[k] for k in sorted(parts))]


def hold(state: FusionState, readings: Sequence[AnyHeld], singles: list[Single]) -> None:
    """Hold readings against the graph: fixes, heights and drops, then pairs, all solved together.

    Args:
        state: the fusion.
        readings: in order of epoch.
        singles: what is held along with them; more is added.
    """
    until: dict[str, float] = {}
    between: list[AnyPair] = []
    others: list[AnyHeld] = []
    for reading in readings:
        if isinstance(reading, PAIRS):
            between.append(reading)
            until[reading.a] = until[reading.b] = reading.t
        else:
            others.append(reading)
            until.update(dict.fromkeys(names_of(reading), reading.t))
    if base_entry.end_unheard(state, between):
        singles[:] = [single for single in singles if single.variable in state.graph]
    _carry(state, until, readings)
    pairs = Pairs(state)
    told = pairs.fused_t
    for reading in others:
        if isinstance(reading, (Position, Altitude, Pressure)):
            found = (
                absolute.fix(state, reading)
                if isinstance(reading, Position)
                else absolute.height(state, reading)
            )
            singles.extend(found)
            if found:
                told[reading.node] = reading.t
        elif isinstance(reading, Drop) and drops.hold(state, reading):
            told[reading.node] = told[reading.by] = reading.t
    pairs.take(between)
    rows = pairs.enter()
    table = table_of(state.graph.starts, singles, rows)
    epochs = np.concatenate([np.zeros(len(table) - len(rows)), pairs.epochs]) if singles else pairs.epochs
    update(state, table, epochs)
    late_start.ask(state)
    beginnings.decide(state)
    nodes = state.nodes
    for name, heard_t in until.items():
        node = nodes.get(name)
        if node is None:
            continue
        mode = node.mode
        if mode == "retired":
            continue
        # What says nothing of a place leaves its fix as old as it was.
        t = heard_t if mode in ("undecided", "fixed") else told.get(name, -math.inf)
        if node.t < t:
            nodes[name] = replace(node, t=t)


def _carry(state: FusionState, until: Mapping[str, float], readings: Sequence[AnyHeld]) -> None:
    """Move nodes without newer displacements to the newest epoch at which something is held against them.

    Args:
        state: the fusion.
        until: that epoch, by node (s).
        readings: what is held.
    """
    drifting: dict[str, float] = {}
    silent: dict[str, float] = {}
    for name, t in until.items():
        node = state.nodes.get(name)
        mode = None if node is None else node.mode
        if node is None or mode == "static":
            continue
        if mode == "free":
            drifting[name] = t
        elif mode == "unit" and t > node.pose_t + SAME_EPOCH_S:
            silent[name] = t
    if drifting:
        move_free(state, drifting)
    if silent:
        placing = (names_of(reading) for reading in readings if type(reading) in PLACING)
        drift_units(state, silent, placed=set(chain.from_iterable(placing)))
