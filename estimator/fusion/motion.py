"""How nodes with a PDR unit move between ticks: by its displacements."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.introduce import attach_unit, begin_at_base, waits_for_ranges
from estimator.fusion.nodes import NodeState
from estimator.fusion.physics import NOISES
from estimator.fusion.rows import Linear
from estimator.fusion.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.displacement import Displacement, move
from estimator.measurements.node import MOVING_ROLES

TRAIL_S = 4.0
FIRST_DURATION_S = 1.0
NOISE_FLOOR = np.array([1e-6, 1e-6, 1e-6, 1e-10, 1e-14, 1e-12])
LONGEST_S = 600.0
"""Noise stops growing with the time between two reports there: nobody is followed over longer silences."""


class Increment(NamedTuple):
    """What one displacement adds to a unit's way.

    Attributes:
        node: the unit after it.
        delta_m: displacement in the unit's frame, 3 (m).
        duration_s: time that it took since the unit's last epoch (s).
        noise: variances of position, ψ, β and s that it adds, 6.
        turn: the gyro bias that it shows, if the unit stood still (ZARU).
        too_fast: nobody moves so far in its time.
    """

    node: NodeState
    delta_m: Array
    duration_s: float
    noise: Array
    turn: Linear | None
    too_fast: bool


class Step:
    """What one unit has moved in one tick.

    Attributes:
        node: the unit, before the step.
        delta_m: displacement in the unit's frame, 3 (m).
        duration_s: time that it took (s).
        noise: variances of position, ψ, β and s that it adds, 6.
    """

    def __init__(self, node: NodeState) -> None:
        self.node = node
        self.delta_m: Array = np.zeros(3)
        self.duration_s = 0.0
        self.noise: Array = np.zeros(6)


def move_units(state: FusionState, readings: Sequence[Displacement], turns: list[Linear]) -> None:
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
            state.count("not_fused")
            continue
        if node.mode == "undecided":
            if waits_for_ranges(state, node, reading.t):
                text = f"nobody said where {node.node} entered: its displacements wait for ranges that tell"
                state.say("not_fused", reading.t, node.node, text, once=f"{node.node} waits for ranges")
                state.count("not_fused")
                continue
            begin_at_base(state, node, _start_of(reading, None))
        if state.nodes[node.node].mode == "free":
            attach_unit(state, state.nodes[node.node], reading.heading_rad)
        step = steps.get(node.node)
        if step is None:
            step = steps[node.node] = Step(state.nodes[node.node])
        if _extend(state, step, reading, turns):
            state.count("fused")
    moving = [s for s in steps.values() if s.duration_s > 0.0 or s.noise.any()]
    if moving:
        _advance_units(state, moving)
    for step in steps.values():
        state.nodes[step.node.node] = step.node


def _start_of(reading: Displacement, pose_t: float | None) -> float:
    if reading.from_t is not None:
        return reading.from_t
    return reading.t - FIRST_DURATION_S if pose_t is None else pose_t


def _extend(state: FusionState, step: Step, reading: Displacement, turns: list[Linear]) -> bool:
    node = step.node
    increment = increment_of(node, reading)
    if increment is None:
        text = f"{node.node} reported this epoch's displacement before"
        state.say("conflict", reading.t, node.node, text)
        state.count("not_fused")
        return False
    if increment.too_fast:
        length = float(np.linalg.norm(increment.delta_m))
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
    variances = increment.noise[[0, 2, 3, 4, 5]].tolist()
    delta = increment.delta_m.tolist()
    state.ledger.add("steps", reading.t, node.index, node.pose_t, *delta, *variances, given)
    step.delta_m = step.delta_m + increment.delta_m
    step.duration_s += increment.duration_s
    step.noise = step.noise + increment.noise
    step.node = increment.node
    return True


def increment_of(node: NodeState, reading: Displacement) -> Increment | None:
    """A displacement held against what its unit reported before; None where that covers its epoch already."""
    if reading.t < node.pose_t or (node.unit_t is not None and reading.t <= node.unit_t):
        return None
    start = _start_of(reading, node.pose_t if node.unit_t is None else node.unit_t)
    delta = np.array(reading.delta_m)
    duration = min(reading.t - node.pose_t, LONGEST_S)
    own = max(reading.t - start, 0.0)
    length = float(np.sqrt(delta @ delta))
    noise = np.zeros(6)
    if start < node.pose_t and node.unit_t is not None:
        share = duration / own
        noise[:3] += (0.5 * share * (1.0 - share) * length) ** 2
        delta, length, own = delta * share, length * share, duration
    elif start > node.pose_t:
        noise[:3] += (physics.GAP_MPS * min(start - node.pose_t, LONGEST_S)) ** 2
        noise[2] *= 0.1
    too_fast = length > physics.FASTEST_MPS * max(own, physics.TICK_S)
    if too_fast:
        noise[:3] += length**2
    still = own > 0.0 and length < physics.STILL_MPS * own and start <= node.pose_t
    trail = node.trail or ((node.pose_t, 0.0, 0.0, 0.0),)
    e, n, u = (np.array(trail[-1][1:]) + delta).tolist()
    oldest = next((i for i, mark in enumerate(trail) if mark[0] >= reading.t - TRAIL_S), len(trail))
    after = replace(
        node,
        t=max(node.t, reading.t),
        pose_t=reading.t,
        unit_t=reading.t,
        unit_heading_rad=reading.heading_rad,
        speed_mps=float(np.hypot(delta[0], delta[1])) / own if own > 0.0 else node.speed_mps,
        trail=(*trail[max(oldest - 1, 0) :], (reading.t, e, n, u)),
        way_m=node.way_m + length,
    )
    stood, turn = _standing(node, reading, duration) if still else ((), None)
    after = replace(after, still=stood)
    noise += _walk_noise(reading.sigma_m, length, duration)
    return Increment(after, delta, duration, noise, turn, too_fast)


def _walk_noise(sigma_m: float | None, length: float, duration: float) -> Array:
    step = physics.WALK_M_PER_ROOT_M**2 * length if sigma_m is None else sigma_m**2
    position = step + physics.STAND_M_PER_ROOT_S**2 * duration + physics.DISPLACEMENT_FLOOR_M**2
    heading = physics.HEADING_WALK_RAD_PER_ROOT_M**2 * length + physics.GYRO_WALK_RAD_PER_ROOT_S**2 * duration
    bias = physics.BIAS_WALK_RADPS_PER_ROOT_S**2 * duration
    scale = physics.SCALE_WALK_PER_ROOT_S**2 * duration
    return np.array([position, position, position, heading, bias, scale])


def _standing(
    node: NodeState, reading: Displacement, duration: float
) -> tuple[tuple[tuple[float, float], ...], Linear | None]:
    """ZARU (estimation.md, point 2): the true heading stays, so what the unit turns meanwhile is −β Δt.

    Reported headings are noisy, and their noise is not told: β is the slope of a line through those of some
    seconds, and what they scatter about it says how good it is.

    Returns:
        Epochs and headings of this standing that are not used yet, and the bias if they have just been used.
    """
    if reading.heading_rad is None:
        return (), None
    last = node.still[-1][1] if node.still else reading.heading_rad
    turned = (reading.heading_rad - last + np.pi) % (2.0 * np.pi) - np.pi
    if abs(turned) > physics.STILL_TURN_RADPS * max(duration, 1.0):
        return ((reading.t, reading.heading_rad),), None
    still = (*node.still, (reading.t, last + float(turned)))
    lasted = reading.t - still[0][0]
    if len(still) < physics.STILL_READINGS or lasted < physics.STILL_S:
        return still, None
    t, heading = np.array(still).T
    t = t - t.mean()
    spread = float(t @ t)
    slope = float(t @ heading) / spread
    scatter = heading - heading.mean() - slope * t
    variance = float(scatter @ scatter) / (len(still) - 4) / spread
    sigma = float(np.sqrt(variance + physics.GYRO_WALK_RAD_PER_ROOT_S**2 / lasted))
    return still[-1:], Linear(node.unit, 1, -slope, sigma, physics.TURN_NOISE)


def _advance_units(state: FusionState, steps: Sequence[Step]) -> None:
    starts = [(state.graph.rows(s.node.position).start, state.graph.rows(s.node.unit).start) for s in steps]
    rows = np.array([[p, p + 1, p + 2, u, u + 1, u + 2] for p, u in starts])
    before = state.graph.reference[rows]
    moved = move(before, np.array([s.delta_m for s in steps]), np.array([s.duration_s for s in steps]))
    noise = np.array([np.diag(s.noise + NOISE_FLOOR) for s in steps])
    state.graph.advance(rows, moved.state, moved.transition, noise)


def drift_unit(state: FusionState, node: NodeState, t: float) -> None:
    """A unit has not reported up to `t`, and something else is to be held against its position there.

    Its bearer may have stood or walked; a random walk of 1 m per root second covers both. A displacement that
    comes later counts for the part of its time that is left.
    """
    duration = min(t - node.pose_t, LONGEST_S)
    rows = np.arange(3) + state.graph.rows(node.position).start
    wander = physics.SILENT_M_PER_ROOT_S**2 * duration
    noise = np.diag([wander, wander, 0.1 * wander])
    state.graph.advance(rows[None], state.graph.reference[rows][None], np.eye(3)[None], noise[None])
    state.ledger.add(
        "steps", t, node.index, node.pose_t, 0.0, 0.0, 0.0, wander, 0.1 * wander, 0.0, 0.0, 0.0, 1.0
    )
    state.nodes[node.node] = replace(node, pose_t=t, trail=())


def offset_at(state: FusionState, node: NodeState, t: float) -> Array:
    """Where a moving node stood at `t`, from its present position, 3 (m): back along its trail."""
    if node.mode == "free":
        return np.asarray(state.graph.value(node.velocity) * (t - node.pose_t))
    if node.mode != "unit" or t >= node.pose_t or len(node.trail) < 2:
        return np.zeros(3)
    marks = np.array(node.trail)
    then = np.array([np.interp(t, marks[:, 0], marks[:, axis]) for axis in (1, 2, 3)])
    psi, _, scale = state.graph.value(node.unit).tolist()
    e, n, u = ((then - marks[-1, 1:]) * (1.0 + scale)).tolist()
    cosine, sine = np.cos(psi), np.sin(psi)
    return np.array([cosine * e - sine * n, sine * e + cosine * n, u])
