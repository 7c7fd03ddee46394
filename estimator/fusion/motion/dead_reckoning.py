"""How nodes with a PDR unit move between ticks: by its displacements, or unseen in a silence."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from numba import njit

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.learned.gait import SHORT_S, STRIDE_S, kept
from estimator.fusion.memory.ledger import UNSEEN
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.coasting import mark_after, missed_m2, onward_m, went_on_m2
from estimator.fusion.motion.recent_places import Mark
from estimator.fusion.motion.silence import SILENT_S, unplaced_m2, went_on
from estimator.fusion.motion.steps import Noise, Step, sum_of, unseen_noise
from estimator.graph.dense import Array, Indices
from estimator.graph.filter_kernels import advance
from estimator.measurements.displacement import move

FLOOR = (1e-6, 1e-6, 1e-6, 1e-10, 1e-14, 1e-12)
STOOD: Vector3 = (0.0, 0.0, 0.0)
SELDOM_S = 1.5
"""Of who tells more than a stride at once nobody knows how he went at the end of it."""


class Move(NamedTuple):
    """How one unit has moved.

    Attributes:
        node: its node.
        delta_m: displacement in its frame (m).
        duration_s: time (s).
        noise: variances that it adds.
        changed_m: way, in its frame, of a gait that has changed: east, north (m).
    """

    node: NodeState
    delta_m: Vector3
    duration_s: float
    noise: Noise
    changed_m: tuple[float, float] = (0.0, 0.0)


def advance_units(state: FusionState, steps: Sequence[Step]) -> None:
    """One transition for all units that have moved in a tick, by what their displacements add up to."""
    advance_by(state, [Move(s.node, s.delta_m, s.duration_s, s.noise, s.changed_m) for s in steps])


def advance_by(state: FusionState, moves: Sequence[Move]) -> None:
    """One transition for units, of the state's graph."""
    graph, starts = state.graph, state.graph.starts
    told = [
        (starts[node.position], starts[node.unit], *delta_m, duration_s, *sum_of(noise, FLOOR), *changed_m)
        for node, delta_m, duration_s, noise, changed_m in moves
    ]
    rows = np.empty(6 * len(told), dtype=np.intp)
    kernel = np.empty((len(rows), len(rows)))
    if not walk(np.array(told), *graph.storage(), graph.size, rows, kernel):
        graph.loosen(rows, kernel)


@njit(cache=True, nogil=True)
def walk(
    steps: Array, matrix: Array, vector: Array, reference: Array, n: int, rows: Indices, kernel: Array
) -> bool:
    """Steps of units as one transition of the Kirchhoff state, see `Kirchhoff.advance`.

    Args:
        steps: as `walked` takes them, g × 14.
        matrix: L, n × n or larger, changed.
        vector: b, as long, changed.
        reference: x, as long, changed.
        n: rows in use.
        rows: takes the rows that move, 6 g.
        kernel: takes Q⁻¹ + Eᵀ A E, 6 g × 6 g.

    Returns:
        False where that is not positive definite: `Kirchhoff.loosen` is still to be done.
    """
    blocks, moved, transition, noise = walked(steps, reference[:n])
    done, found = advance(matrix, vector, n, blocks, transition, noise)
    kernel[:] = found
    for i in range(len(blocks)):
        for c in range(6):
            rows[6 * i + c] = blocks[i, c]
            reference[blocks[i, c]] = moved[i, c]
    return done


@njit(cache=True)
def walked(steps: Array, x: Array) -> tuple[Indices, Array, Array, Array]:
    """What steps make of the blocks of their units, as `Kirchhoff.advance` takes it.

    Args:
        steps: where each unit's position and its errors start; displacement in its frame (m), time (s), and
            the variances of its six numbers; the way of a gait that has changed, see `renew`, g × 14.
        x: the reference of the graph, n.
    """
    g = len(steps)
    rows, states, noise = np.empty((g, 6), dtype=np.intp), np.empty((g, 6)), np.zeros((g, 6, 6))
    for i in range(g):
        for c in range(6):
            rows[i, c] = int(steps[i, c // 3]) + c % 3
            states[i, c], noise[i, c, c] = x[rows[i, c]], steps[i, 6 + c]
    moved = move(states, steps[:, 2:5], steps[:, 5])
    for i in range(g):
        renew(states[i], steps[i, 12:14], moved.state[i], moved.transition[i], noise[i])
    return rows, moved.state, moved.transition, noise


@njit(cache=True)
def renew(before: Array, changed_m: Array, state: Array, transition: Array, noise: Array) -> None:
    """Let a unit's scale be another one since its bearer began to go otherwise, where a step renews it.

    That shows after some seconds, in which he has gone a way D at the scale before, s: with the scale that it
    had, s' = 0.1 s + δ, he is at p' = p + Rz(ψ) D (s' − s). So δ, which is the step's noise, moves his place
    as well, and what later tells the scale tells of that way too.

    Args:
        before: ψ, β, s − 1 behind the place, before the step, 6.
        changed_m: D in the unit's frame, 2 (m).
        state: the same after the step, changed.
        transition: F of the step, 6 × 6, changed.
        noise: Q, 6 × 6, so far only its diagonal; changed.
    """
    share, variance = kept(noise[5, 5]), noise[5, 5]
    if share == 1.0:
        return
    cosine, sine, less = np.cos(before[3]), np.sin(before[3]), (1.0 - share) * before[5]
    east = cosine * changed_m[0] - sine * changed_m[1]
    north = sine * changed_m[0] + cosine * changed_m[1]
    state[5], transition[5, 5] = share * before[5], share
    state[0] -= less * east
    state[1] -= less * north
    transition[0, 3] += less * north
    transition[1, 3] -= less * east
    transition[0, 5] -= (1.0 - share) * east
    transition[1, 5] -= (1.0 - share) * north
    noise[0, 5] = noise[5, 0] = variance * east
    noise[1, 5] = noise[5, 1] = variance * north
    noise[0, 0] += variance * east * east
    noise[1, 1] += variance * north * north
    noise[0, 1] = noise[1, 0] = variance * east * north


def go_on(state: FusionState, until: Mapping[str, float]) -> None:
    """Let bearers go on as they went, up to epochs that their units' displacements do not cover yet.

    Of who has been silent nobody knows how he goes: he is left to `drift_units`.

    Args:
        state: the fusion.
        until: the epoch, by node.
    """
    steps = []
    for name, t in until.items():
        node = state.nodes[name]
        if node.mode != "unit" or node.pose_t != node.unit_t or len(node.trail) < 2:
            continue
        if node.pose_t < t <= node.pose_t + SILENT_S:
            step = Step(node)
            step.go_on(t)
            steps.append(step)
    if steps:
        advance_units(state, steps)
    for step in steps:
        state.nodes[step.node.node] = step.after()


class Pace(NamedTuple):
    """How the bearer of a unit goes that sums up for seconds what it tells.

    Attributes:
        pace_mps: mean velocity in its newest report, in the unit's frame: east, north, up (m/s).
        told_t: epoch of that report (s).
        lasted_s: for how long it lasted (s).
    """

    pace_mps: Vector3
    told_t: float
    lasted_s: float


def paces(state: FusionState) -> dict[str, Pace]:
    """How those go whose units report seldom, and who are not silent but report as ever, by node."""
    found = {}
    for name, node in state.nodes.items():
        seldom = node.mode == "unit" and not node.raw and node.report_s > SELDOM_S
        if not seldom or node.pose_t != node.unit_t or len(node.trail) < 2:
            continue
        found[name] = Pace(Step(node).pace_mps(), node.pose_t, node.report_s)
    return found


def go_on_at(state: FusionState, until: Mapping[str, float], known: Mapping[str, Pace]) -> None:
    """Let bearers go on at their pace, up to epochs for which their units' next reports wait.

    What is heard on the way tells how he goes: each part of it adds its own variance.

    Args:
        state: the fusion.
        until: the epoch, by node.
        known: their paces, of others as well.
    """
    moves = []
    for name, t in until.items():
        node, pace = state.nodes[name], known.get(name)
        if pace is None or not node.pose_t < t <= pace.told_t + node.wait_s:
            continue
        since_s, until_s = node.pose_t - pace.told_t, t - pace.told_t
        along_s = went_on(until_s)[0] - went_on(since_s)[0]
        across = went_on_m2(until_s, pace.lasted_s) - went_on_m2(since_s, pace.lasted_s)
        e, n, u = (along_s * each for each in pace.pace_mps)
        delta_m = e, n, u
        noise = across, across, 0.1 * across, 0.0, 0.0, 0.0
        moves.append(Move(node, delta_m, until_s - since_s, noise))
        marks = node.trail or ((node.pose_t, 0.0, 0.0, 0.0),)
        trail = (*marks, mark_after(marks[-1], t, delta_m))
        state.nodes[name] = replace(node, pose_t=t, trail=trail)
    if moves:
        advance_by(state, moves)


def was_silent(node: NodeState) -> bool:
    """Whether a unit has reported nothing for some time up to where its node is now."""
    return node.unit_t is None or node.pose_t > node.unit_t + SILENT_S


def drift_units(
    state: FusionState, until: Mapping[str, float], onward: bool = False, placed: Collection[str] = ()
) -> None:
    """Units have not reported up to an epoch at which something else is to be held against their position.

    Their bearers go on as they went for a moment; they may have stood or walked (`silence.unheard_m2`). Not
    those of whom ranges or fixes tell: these say where they go, and would tell of their headings by what was
    only guessed. A displacement that comes later counts for the part of its time that is left.

    Args:
        state: the fusion.
        until: the epoch, by unit.
        onward: nothing is heard of them.
        placed: those of them of whom a range or a fix tells there.
    """
    moves = []
    for name, t in until.items():
        node = state.nodes[name]
        since_s = math.inf if node.unit_t is None else node.pose_t - node.unit_t
        if since_s < SILENT_S <= since_s + t - node.pose_t:
            # From now on ranges alone tell where he goes.
            state.suspected = True
        span_s, missed_s = t - node.pose_t, node.missed_s
        placed_t, silent = t if name in placed else node.placed_t, since_s + span_s > SILENT_S
        unplaced = t > placed_t + physics.UNHEARD_MEMORY_S
        goes_on = (onward or unplaced) and not silent and len(node.trail) > 1
        delta_m, trail = STOOD, tuple[Mark, ...]()
        if goes_on:
            delta_m = onward_m(node.trail, span_s, since_s)
            trail = (*node.trail, mark_after(node.trail[-1], t, delta_m))
        across, _, up, turn, bias, scale = unseen_noise(span_s, since_s)
        if goes_on and _told_pace(node):
            across = went_on(since_s + span_s)[1] - went_on(since_s)[1]
            up = 0.1 * across
        else:
            # What is heard of him meanwhile tells how he goes on: then nothing is missed all along.
            untold_m2 = missed_m2(span_s, missed_s, node.raw) if since_s == 0.0 else 0.0
            across = max(across, untold_m2, unplaced_m2(span_s, since_s) if unplaced and silent else 0.0)
            missed_s += span_s if since_s == 0.0 else 0.0
        step = (*delta_m, across, up, turn, bias, scale, UNSEEN)
        state.ledger.add("steps", t, node.index, node.pose_t, *step)
        moves.append(Move(node, delta_m, span_s, (across, across, up, turn, bias, scale)))
        state.nodes[name] = replace(
            node,
            pose_t=t,
            trail=trail,
            missed_s=missed_s,
            placed_t=placed_t,
            # What readings of a link have in common he leaves behind as he goes, seen or not.
            way_m=node.way_m + (physics.FREE_WAY_MPS * span_s if silent else 0.0),
        )
    # His unit's frame turns on, whether it reports or not.
    advance_by(state, moves)


def _told_pace(node: NodeState) -> bool:
    """Whether a unit has told how its bearer goes: whole strides at once, and nothing was missed since."""
    return not node.raw and node.report_s > STRIDE_S - SHORT_S and node.missed_s == 0.0
