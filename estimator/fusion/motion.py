"""How nodes with a PDR unit move between ticks: by its displacements."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.introduce import attach_unit, begin_at_base, waits_for_ranges
from estimator.fusion.nodes import NodeState
from estimator.fusion.physics import NOISES
from estimator.fusion.rows import Single
from estimator.fusion.silence import LONGEST_S, SILENT_S, wandered_m2
from estimator.fusion.standing import stand_on
from estimator.fusion.state import Count, FusionState
from estimator.fusion.way import Mark
from estimator.inertial.navigation import Led
from estimator.measurements.displacement import Displacement, move
from estimator.measurements.node import MOVING_ROLES

TRAIL_S = 4.0
FIRST_DURATION_S = 1.0
NOISE_FLOOR = (1e-6, 1e-6, 1e-6, 1e-10, 1e-14, 1e-12)
AXES = np.arange(6)
Noise = tuple[float, float, float, float, float, float]
"""Variances of east, north, up (m²), ψ (rad²), β (rad²/s²) and s."""
NOTHING = (0.0,) * 6


class Increment(NamedTuple):
    """What one displacement adds to a unit's way.

    Attributes:
        node: the unit after it.
        delta_m: displacement in the unit's frame (m).
        duration_s: time that it took since the unit's last epoch (s).
        noise: variances that it adds.
        turn: the gyro bias that is told by a standstill, if one has ended or lasted long (ZARU).
        too_fast: nobody moves so far in its time.
    """

    node: NodeState
    delta_m: Vector3
    duration_s: float
    noise: Noise
    turn: Single | None
    too_fast: bool


class Step:
    """What one unit has moved in one tick.

    Attributes:
        node: the unit, after the step.
        delta_m: displacement in the unit's frame (m).
        duration_s: time that it took (s).
        noise: variances that it adds.
    """

    def __init__(self, node: NodeState) -> None:
        self.node = node
        self.delta_m: Vector3 = (0.0, 0.0, 0.0)
        self.duration_s = 0.0
        self.noise: Noise = NOTHING

    def add(self, increment: Increment) -> None:
        """Take in what one displacement adds."""
        self.node = increment.node
        (e, n, u), (more_e, more_n, more_u) = self.delta_m, increment.delta_m
        self.delta_m = e + more_e, n + more_n, u + more_u
        self.duration_s += increment.duration_s
        self.noise = _sum(self.noise, increment.noise)


def _sum(one: Noise, other: Noise) -> Noise:
    e, n, u, psi, beta, scale = one
    more_e, more_n, more_u, more_psi, more_beta, more_scale = other
    return e + more_e, n + more_n, u + more_u, psi + more_psi, beta + more_beta, scale + more_scale


def move_units(state: FusionState, readings: Sequence[Displacement], turns: list[Single]) -> None:
    """Fold a tick's displacements: one transition for all units at once, and ZARU where they stand still.

    Args:
        state: the fusion.
        readings: in order of epoch.
        turns: takes the gyro biases that standing units tell.
    """
    steps: dict[str, Step] = {}
    for reading in readings:
        node = state.node_of(reading.node, "responder", reading.t)
        if node.role not in MOVING_ROLES or node.mode == "retired":
            text = f"{node.node} is a {node.mode} {node.role}: its displacement is set aside"
            state.say("conflict", reading.t, node.node, text, once=f"displacement of {node.node}")
            _count(state, reading, "not_fused")
            continue
        if node.mode == "undecided":
            if waits_for_ranges(state, node, reading.t):
                text = f"nobody said where {node.node} entered: its displacements wait for ranges that tell"
                state.say("not_fused", reading.t, node.node, text, once=f"{node.node} waits for ranges")
                _count(state, reading, "not_fused")
                continue
            begin_at_base(state, node, _start_of(reading, None))
        if state.nodes[node.node].mode == "free":
            attach_unit(state, state.nodes[node.node], reading.heading_rad)
        step = steps.get(node.node)
        if step is None:
            step = steps[node.node] = Step(state.nodes[node.node])
        if _extend(state, step, reading, turns):
            _count(state, reading, "fused")
    moving = [s for s in steps.values() if s.duration_s > 0.0 or any(s.noise)]
    if moving:
        _advance_units(state, moving)
    for step in steps.values():
        state.nodes[step.node.node] = step.node


def _count(state: FusionState, reading: Displacement, what: Count) -> None:
    """Count a displacement, unless samples have made it, which are counted."""
    if not isinstance(reading, Led):
        state.count(what)


def returns(state: FusionState, readings: Sequence[Displacement]) -> dict[str, float]:
    """Units that report again after a silence of which they tell nothing, and since when they do (s).

    Args:
        state: the fusion.
        readings: a tick's displacements, in order of epoch.
    """
    told_until = {node.node: node.pose_t for node in state.nodes.values() if node.mode == "unit"}
    back: dict[str, float] = {}
    for reading in readings:
        until_t = told_until.get(reading.node, math.inf)
        start_t = _start_of(reading, until_t)
        if start_t > until_t + physics.FREE_TICK_S:
            back.setdefault(reading.node, start_t)
        told_until[reading.node] = max(until_t, reading.t)
    return back


def was_silent(node: NodeState) -> bool:
    """Whether a unit has reported nothing for some time up to where its node is now."""
    return node.unit_t is None or node.pose_t > node.unit_t + SILENT_S


def _start_of(reading: Displacement, pose_t: float | None) -> float:
    if reading.from_t is not None:
        return reading.from_t
    return reading.t - FIRST_DURATION_S if pose_t is None else pose_t


def _extend(state: FusionState, step: Step, reading: Displacement, turns: list[Single]) -> bool:
    node = step.node
    increment = increment_of(node, reading)
    if increment is None:
        text = f"{node.node} reported this epoch's displacement before"
        state.say("conflict", reading.t, node.node, text, once=f"epochs of {node.node}")
        _count(state, reading, "not_fused")
        return False
    if increment.too_fast:
        length = math.hypot(*increment.delta_m)
        text = f"{node.node} reported {length:.1f} m at once, faster than anyone runs"
        state.say("outlier", reading.t, node.node, text)
        state.count("outlier")
    if increment.turn is not None:
        told = increment.turn
        state.ledger.add(
            "singles", reading.t, node.index, 4.0, told.value, told.sigma, float(NOISES.index(told.noise))
        )
        turns.append(told)
    given = float(reading.sigma_m is not None)
    across, _, up, turn, bias, scale = increment.noise
    variances = (across, up, turn, bias, scale, given)
    state.ledger.add("steps", reading.t, node.index, node.pose_t, *increment.delta_m, *variances)
    step.add(increment)
    return True


def increment_of(node: NodeState, reading: Displacement) -> Increment | None:
    """A displacement held against what its unit reported before; None where that covers its epoch already."""
    if reading.t < node.pose_t or (node.unit_t is not None and reading.t <= node.unit_t):
        return None
    start = _start_of(reading, node.pose_t if node.unit_t is None else node.unit_t)
    e, n, u = reading.delta_m
    duration = min(reading.t - node.pose_t, LONGEST_S)
    own = max(reading.t - start, 0.0)
    length = math.sqrt(e * e + n * n + u * u)
    across = up = 0.0
    if start < node.pose_t and node.unit_t is not None:
        share = duration / own
        across = up = (0.5 * share * (1.0 - share) * length) ** 2
        e, n, u, length, own = e * share, n * share, u * share, length * share, duration
    elif start > node.pose_t:
        across = (physics.GAP_MPS * min(start - node.pose_t, LONGEST_S)) ** 2
        up = 0.1 * across
    too_fast = length > physics.FASTEST_MPS * max(own, physics.TICK_S)
    if too_fast:
        across, up = across + length**2, up + length**2
    still = own > 0.0 and length < physics.STILL_MPS * own and start <= node.pose_t
    stood, told = None, None
    if still and reading.heading_rad is not None:
        stood, told = stand_on(node.still, reading.t, reading.heading_rad)
    elif still:
        stood = node.still
    elif node.still is not None:
        told = node.still.bias()
    turn = None if told is None else Single(node.unit, 1, told.value, told.sigma, physics.TURN_NOISE)
    after = replace(
        node,
        t=max(node.t, reading.t),
        pose_t=reading.t,
        unit_t=reading.t,
        unit_heading_rad=reading.heading_rad,
        speed_mps=math.hypot(e, n) / own if own > 0.0 else node.speed_mps,
        trail=_trail(node, reading.t, e, n, u),
        still=stood,
        way_m=node.way_m + length,
    )
    up += (physics.SCALE_SIGMA * u) ** 2
    noise = _sum((across, across, up, 0.0, 0.0, 0.0), _walk_noise(reading.sigma_m, length, duration))
    return Increment(after, (e, n, u), duration, noise, turn, too_fast)


def _trail(node: NodeState, t: float, e: float, n: float, u: float) -> tuple[Mark, ...]:
    """A unit's trail with one displacement (m) more, without what is longer ago than `TRAIL_S`."""
    trail = node.trail or ((node.pose_t, 0.0, 0.0, 0.0),)
    _, last_e, last_n, last_u = trail[-1]
    oldest = 0
    while oldest < len(trail) and trail[oldest][0] < t - TRAIL_S:
        oldest += 1
    return *trail[max(oldest - 1, 0) :], (t, last_e + e, last_n + n, last_u + u)


def _walk_noise(sigma_m: float | None, length: float, duration: float) -> Noise:
    step = physics.WALK_M_PER_ROOT_M**2 * length if sigma_m is None else sigma_m**2
    position = step + physics.STAND_M_PER_ROOT_S**2 * duration + physics.DISPLACEMENT_FLOOR_M**2
    heading = physics.HEADING_WALK_RAD_PER_ROOT_M**2 * length + physics.GYRO_WALK_RAD_PER_ROOT_S**2 * duration
    bias = physics.BIAS_WALK_RADPS_PER_ROOT_S**2 * duration
    scale = physics.SCALE_WALK_PER_ROOT_S**2 * duration
    return position, position, position, heading, bias, scale


def _advance_units(state: FusionState, steps: Sequence[Step]) -> None:
    starts = [(state.graph.starts[s.node.position], state.graph.starts[s.node.unit]) for s in steps]
    rows = np.array([(p, p + 1, p + 2, u, u + 1, u + 2) for p, u in starts])
    delta, duration = np.array([s.delta_m for s in steps]), np.array([s.duration_s for s in steps])
    moved = move(state.graph.reference[rows], delta, duration)
    noise = np.zeros((len(steps), 6, 6))
    noise[:, AXES, AXES] = [_sum(s.noise, NOISE_FLOOR) for s in steps]
    state.graph.advance(rows, moved.state, moved.transition, noise)


def drift_units(state: FusionState, until: Mapping[str, float]) -> None:
    """Units have not reported up to an epoch at which something else is to be held against their position.

    Their bearers may have stood or walked (`silence.wandered_m2`). A displacement that comes later counts for
    the part of its time that is left.

    Args:
        state: the fusion.
        until: the epoch, by unit.
    """
    if not until:
        return
    nodes = [state.nodes[name] for name in until]
    noise = np.zeros((len(nodes), 3, 3))
    for i, (node, t) in enumerate(zip(nodes, until.values(), strict=True)):
        since_s = math.inf if node.unit_t is None else node.pose_t - node.unit_t
        if since_s < SILENT_S <= since_s + t - node.pose_t:
            # From now on ranges alone tell where he goes.
            state.suspected = True
        wander = wandered_m2(t - node.pose_t, since_s)
        across, up = wander, 0.1 * wander
        noise[i, 0, 0], noise[i, 1, 1], noise[i, 2, 2] = across, across, up
        step = (0.0, 0.0, 0.0, across, up, 0.0, 0.0, 0.0, 1.0)
        state.ledger.add("steps", t, node.index, node.pose_t, *step)
        state.nodes[node.node] = replace(node, pose_t=t, trail=())
    rows = np.array([state.graph.starts[node.position] for node in nodes])[:, None] + np.arange(3)
    still = np.zeros((len(nodes), 3, 3)) + np.eye(3)
    state.graph.advance(rows, state.graph.reference[rows], still, noise)
