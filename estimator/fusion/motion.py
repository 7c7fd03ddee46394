"""How nodes with a PDR unit move between ticks: by its displacements."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from msgspec.structs import replace
from numba import njit

from estimator.fusion import physics
from estimator.fusion.introduce import attach_unit, begin_at_base, waits_for_ranges
from estimator.fusion.ledger import GYRO_BIAS
from estimator.fusion.nodes import NodeState
from estimator.fusion.physics import NOISES
from estimator.fusion.rows import Single
from estimator.fusion.silence import SILENT_S, unheard_m2
from estimator.fusion.state import Count, FusionState
from estimator.fusion.steps import Step, start_of, sum_of
from estimator.graph.dense import Array, Indices
from estimator.inertial.navigation import Led
from estimator.measurements.displacement import Displacement, move
from estimator.measurements.node import MOVING_ROLES

FLOOR = (1e-6, 1e-6, 1e-6, 1e-10, 1e-14, 1e-12)


def move_units(state: FusionState, readings: Sequence[Displacement], turns: list[Single]) -> None:
    """Fold a tick's displacements: one transition for all units at once, and ZARU where they stand still.

    Args:
        state: the fusion.
        readings: in order of epoch.
        turns: takes the gyro biases that standing units tell.
    """
    steps: dict[str, Step] = {}
    for reading in readings:
        step = steps.get(reading.node) or _begin(state, reading)
        if step is None:
            _count(state, reading, "not_fused")
            continue
        steps[reading.node] = step
        if _extend(state, step, reading, turns):
            _count(state, reading, "fused")
    moving = [step for step in steps.values() if step.taken]
    if moving:
        _advance_units(state, moving)
    for name, step in steps.items():
        state.nodes[name] = step.after()


def _begin(state: FusionState, reading: Displacement) -> Step | None:
    """The step that a unit's first displacement in a tick begins; None where its node is not to move."""
    node = state.node_of(reading.node, "responder", reading.t)
    if node.role not in MOVING_ROLES or node.mode == "retired":
        text = f"{node.node} is a {node.mode} {node.role}: its displacement is set aside"
        state.say("conflict", reading.t, node.node, text, once=f"displacement of {node.node}")
        return None
    if node.mode == "undecided":
        if waits_for_ranges(state, node, reading.t):
            text = f"nobody said where {node.node} entered: its displacements wait for ranges that tell"
            state.say("not_fused", reading.t, node.node, text, once=f"{node.node} waits for ranges")
            return None
        begin_at_base(state, node, start_of(reading, None))
    if state.nodes[node.node].mode == "free":
        attach_unit(state, state.nodes[node.node], reading.heading_rad)
    return Step(state.nodes[node.node])


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
        start_t = start_of(reading, until_t)
        if start_t > until_t + physics.FREE_TICK_S:
            back.setdefault(reading.node, start_t)
        told_until[reading.node] = max(until_t, reading.t)
    return back


def was_silent(node: NodeState) -> bool:
    """Whether a unit has reported nothing for some time up to where its node is now."""
    return node.unit_t is None or node.pose_t > node.unit_t + SILENT_S


def _extend(state: FusionState, step: Step, reading: Displacement, turns: list[Single]) -> bool:
    node, increment = step.node, step.take(reading)
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
        told, noise = increment.turn, physics.TURN_NOISE
        state.ledger.add(
            "singles", told.t, node.index, GYRO_BIAS, told.value, told.sigma, float(NOISES.index(noise))
        )
        # The tick moves on first, then takes in what was told before.
        sigma = math.sqrt(told.sigma**2 + told.since)
        turns.append(Single(node.unit, 1, told.value, sigma, noise))
    given = float(reading.sigma_m is not None)
    across, _, up, turn, bias, scale = increment.noise
    variances = (across, up, turn, bias, scale, given)
    state.ledger.add("steps", reading.t, node.index, increment.since_t, *increment.delta_m, *variances)
    return True


def _advance_units(state: FusionState, steps: Sequence[Step]) -> None:
    starts = state.graph.starts
    told = [
        (starts[s.node.position], starts[s.node.unit], *s.delta_m, s.duration_s, *sum_of(s.noise, FLOOR))
        for s in steps
    ]
    state.graph.advance(*walked(np.array(told), state.graph.reference))


@njit(cache=True)
def walked(steps: Array, x: Array) -> tuple[Indices, Array, Array, Array]:
    """What steps make of the blocks of their units, as `Kirchhoff.advance` takes it.

    Args:
        steps: where each unit's position and its errors start; displacement in its frame (m), time (s), and
            the variances of its six numbers, g × 12.
        x: the reference of the graph, n.
    """
    g = len(steps)
    rows, states, noise = np.empty((g, 6), dtype=np.intp), np.empty((g, 6)), np.zeros((g, 6, 6))
    for i in range(g):
        for c in range(6):
            rows[i, c] = int(steps[i, c // 3]) + c % 3
            states[i, c], noise[i, c, c] = x[rows[i, c]], steps[i, 6 + c]
    moved = move(states, steps[:, 2:5], steps[:, 5])
    return rows, moved.state, moved.transition, noise


def drift_units(state: FusionState, until: Mapping[str, float]) -> None:
    """Units have not reported up to an epoch at which something else is to be held against their position.

    Their bearers may have stood or walked (`silence.unheard_m2`). A displacement that comes later counts for
    the part of its time that is left.

    Args:
        state: the fusion.
        until: the epoch, by unit.
    """
    nodes = [state.nodes[name] for name in until]
    noise = np.zeros((len(nodes), 3, 3))
    for i, (node, t) in enumerate(zip(nodes, until.values(), strict=True)):
        since_s = math.inf if node.unit_t is None else node.pose_t - node.unit_t
        if since_s < SILENT_S <= since_s + t - node.pose_t:
            # From now on ranges alone tell where he goes.
            state.suspected = True
        wander = unheard_m2(t - node.pose_t, since_s)
        across, up = wander, 0.1 * wander
        noise[i, 0, 0], noise[i, 1, 1], noise[i, 2, 2] = across, across, up
        step = (0.0, 0.0, 0.0, across, up, 0.0, 0.0, 0.0, 1.0)
        state.ledger.add("steps", t, node.index, node.pose_t, *step)
        state.nodes[node.node] = replace(node, pose_t=t, trail=())
    rows = np.array([state.graph.starts[node.position] for node in nodes])[:, None] + np.arange(3)
    still = np.zeros((len(nodes), 3, 3)) + np.eye(3)
    state.graph.advance(rows, state.graph.reference[rows], still, noise)
