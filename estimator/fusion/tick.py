"""One tick of the default tracker: what happens to its readings, in this order."""

from collections.abc import Sequence
from typing import NamedTuple

from msgspec.structs import replace

from estimator.estimate import Notice
from estimator.fusion import beginnings, free, held, introduce, motion, physics
from estimator.fusion.rows import Linear, Pair, Stack
from estimator.fusion.state import FusionState
from estimator.fusion.update import update
from estimator.measurements import AnyReading
from estimator.measurements.altitude import Altitude, Pressure
from estimator.measurements.bearing import Bearing
from estimator.measurements.displacement import Displacement
from estimator.measurements.drop import Drop
from estimator.measurements.imu import Imu
from estimator.measurements.node import MOVING_ROLES, Node
from estimator.measurements.position import Position
from estimator.measurements.range import Range
from estimator.measurements.retire import Retire
from estimator.measurements.rssi import Rssi

SAME_EPOCH_S = 1e-6


class _Held(NamedTuple):
    linear: list[Linear]
    pairs: list[Pair]


def fold_tick(state: FusionState, until_t: float, readings: Sequence[AnyReading]) -> list[Notice]:
    """Fold the readings of one tick into the state.

    Args:
        state: changed in place.
        until_t: end of the tick, Unix seconds.
        readings: in canonical order (see `order`).

    Returns:
        What was noticed.
    """
    state.notices = []
    state.newest_t = max(state.newest_t, until_t)
    for reading in readings:
        if isinstance(reading, Node):
            introduce.introduce(state, reading)
        elif isinstance(reading, Imu):
            text = f"{reading.node} sends raw IMU samples, which are logged and not fused yet"
            state.say("not_fused", reading.t, reading.node, text, once=f"imu of {reading.node}")
            state.node_of(reading.node, "responder", reading.t)
            state.count("not_fused")
    linear: list[Linear] = []
    motion.move_units(state, [r for r in readings if isinstance(r, Displacement)], linear)
    retired = [r for r in readings if isinstance(r, Retire)]
    gone = {r.node for r in retired}
    ready: list[AnyReading] = []
    waiting: list[AnyReading] = []
    holds = (Position, Altitude, Pressure, Drop, Range, Rssi, Bearing)
    for reading in sorted(
        [*state.waiting, *(r for r in readings if isinstance(r, holds))], key=lambda r: r.t
    ):
        late = reading.t < until_t - physics.PENDING_S
        wait = not late and not gone.intersection(names_of(reading)) and _ahead(state, reading)
        (waiting if wait else ready).append(reading)
    state.waiting = tuple(waiting)
    for part in _parts(state, ready):
        _hold(state, part, linear)
        linear = []
    for reading in retired:
        _retire(state, reading)
    keep_poses(state)
    return state.notices


def keep_poses(state: FusionState) -> None:
    """Take down where everyone who moves is now: the next solution of the window starts from there."""
    reference, starts = state.graph.reference, state.graph.starts
    for node in state.nodes.values():
        if node.moving:
            unit = node.mode == "unit"
            rest = starts[node.unit if unit else node.velocity]
            here = starts[node.position]
            values = (*reference[here : here + 3].tolist(), *reference[rest : rest + 3].tolist())
            state.ledger.add("poses", node.pose_t, node.index, float(unit), *values)


def flush(state: FusionState) -> None:
    """Hold what waits for a displacement against the newest positions: for a picture, on a copy."""
    waiting, state.waiting = state.waiting, ()
    if waiting:
        _hold(state, waiting, [])


def _hold(state: FusionState, readings: Sequence[AnyReading], linear: list[Linear]) -> None:
    """Hold readings against the graph: fixes and heights, then drops, then pairs, all solved together."""
    _carry(state, readings)
    pairs: list[Pair] = []
    for reading in readings:
        if isinstance(reading, Position):
            linear.extend(held.fix(state, reading))
        elif isinstance(reading, Altitude | Pressure):
            linear.extend(held.height(state, reading))
        elif isinstance(reading, Drop):
            _drop(state, reading)
    for reading in readings:
        if isinstance(reading, Range | Rssi | Bearing):
            made = _pair(state, reading)
            if made is not None:
                pairs.append(made)
    if linear or pairs:
        update(state, Stack(state.graph.starts, linear, pairs))
    beginnings.decide(state)
    for reading in readings:
        for name in names_of(reading):
            node = state.nodes.get(name)
            if node is not None and node.t < reading.t and node.mode != "retired":
                state.nodes[name] = replace(node, t=reading.t)


def _parts(state: FusionState, readings: Sequence[AnyReading]) -> list[list[AnyReading]]:
    """Readings that are held together: all, but by parts of the tick where a node without PDR is among them.

    A unit's own way tells where it stood at each epoch; a velocity that changes does so for a moment only.
    """
    together: list[AnyReading] = []
    parts: dict[int, list[AnyReading]] = {}
    for reading in readings:
        nodes = (state.nodes.get(name) for name in names_of(reading))
        if any(n is not None and n.role in MOVING_ROLES and n.mode in ("free", "undecided") for n in nodes):
            parts.setdefault(int(reading.t / physics.FREE_TICK_S), []).append(reading)
        else:
            together.append(reading)
    return [together, *(parts[k] for k in sorted(parts))]


def names_of(reading: AnyReading) -> tuple[str, ...]:
    """The nodes that a reading names."""
    if isinstance(reading, Range | Rssi | Bearing):
        return reading.a, reading.b
    if isinstance(reading, Drop):
        return reading.node, reading.by
    return (reading.node,)


def _ahead(state: FusionState, reading: AnyReading) -> bool:
    """Whether a displacement that covers the reading's epoch may still come."""
    nodes = (state.nodes.get(name) for name in names_of(reading))
    return any(n is not None and n.mode == "unit" and reading.t > n.pose_t + SAME_EPOCH_S for n in nodes)


def _carry(state: FusionState, readings: Sequence[AnyReading]) -> None:
    """Move nodes without newer displacements to the newest epoch at which something is held against them."""
    until: dict[str, float] = {}
    for reading in readings:
        for name in names_of(reading):
            until[name] = max(until.get(name, 0.0), reading.t)
    free.move_free(state, {n: t for n, t in until.items() if n in state.nodes})
    for name, t in until.items():
        node = state.nodes.get(name)
        if node is not None and node.mode == "unit" and t > node.pose_t + SAME_EPOCH_S:
            motion.drift_unit(state, node, t)


def _drop(state: FusionState, reading: Drop) -> None:
    by = state.node_of(reading.by, "responder", reading.t)
    if by.mode == "undecided" and by.role in MOVING_ROLES:
        introduce.begin_at_base(state, by, reading.t)
        by = state.nodes[reading.by]
    if not by.decided:
        text = f"{reading.by} has no position: {reading.node} cannot be dropped by it"
        state.say("conflict", reading.t, reading.node, text)
        state.count("not_fused")
        return
    where = state.place(by)
    if by.moving:
        where = where + motion.offset_at(state, by, reading.t)
    done = introduce.drop(state, reading.node, by, where, reading.t)
    state.count("fused" if done else "not_fused")


def _pair(state: FusionState, reading: Range | Rssi | Bearing) -> Pair | None:
    a, b = (state.node_of(name, "breadcrumb", reading.t) for name in (reading.a, reading.b))
    for node, other in ((a, b), (b, a)):
        if node.mode == "retired":
            text = f"{node.node} is retired: what {other.node} measures to it is set aside"
            state.say("conflict", reading.t, node.node, text, once=f"pair with retired {node.node}")
            state.count("not_fused")
            return None
    if a.decided and b.decided:
        if a.mode == "fixed" and b.mode == "fixed":
            state.count("not_fused")
            return None
        made = held.pair(state, a, b, reading)
        if made is not None:
            state.count("fused")
        return made
    undecided, other = (b, a) if a.decided else (a, b)
    if not other.decided or isinstance(reading, Bearing):
        state.count("not_fused")
        return None
    if other.moving and undecided.role in MOVING_ROLES:
        state.count("not_fused")
        return None
    held.enter(state, a, b, reading)
    state.sightings[undecided.node] = state.sightings.get(undecided.node, 0) + 1
    return None


def _retire(state: FusionState, reading: Retire) -> None:
    node = state.node_of(reading.node, "responder", reading.t)
    if node.mode == "retired":
        state.say("conflict", reading.t, node.node, f"{node.node} is retired already")
        state.count("not_fused")
        return
    introduce.retire(state, node, reading.t)
    state.count("fused")
