"""How nodes with a PDR unit move between ticks: by its displacements, or unseen in a silence."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from numba import njit

from estimator.estimate import Vector3
from estimator.fusion import physics
from estimator.fusion.learned.gait import KEPT, RENEWED
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


def advance_units(state: FusionState, steps: Sequence[Step]) -> None:
    """One transition for all units that have moved in a tick, by what their displacements add up to."""
    advance_by(state, [(s.node, s.delta_m, s.duration_s, s.noise) for s in steps])


def advance_by(state: FusionState, moves: Sequence[tuple[NodeState, Vector3, float, Noise]]) -> None:
    """One transition for units.

    Args:
        state: the fusion: its graph is changed.
        moves: of each unit its node, displacement in its frame (m), time (s) and variances that it adds.
    """
    graph, starts = state.graph, state.graph.starts
    told = [
        (starts[node.position], starts[node.unit], *delta_m, duration_s, *sum_of(noise, FLOOR))
        for node, delta_m, duration_s, noise in moves
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
        steps: as `walked` takes them, g × 12.
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
    for i in range(g):
        if noise[i, 5, 5] > RENEWED:
            moved.transition[i, 5, 5] = KEPT
            moved.state[i, 5] *= KEPT
    return rows, moved.state, moved.transition, noise


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
        moves.append((node, delta_m, until_s - since_s, (across, across, 0.1 * across, 0.0, 0.0, 0.0)))
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

    Their bearers go on as they went for a moment; they may have stood or walked (`silence.unheard_m2`). A
    displacement that comes later counts for the part of its time that is left.

    Args:
        state: the fusion.
        until: the epoch, by unit.
        onward: nothing is heard of them: what is tells where they go, and nothing of their headings.
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
        noise = unseen_noise(span_s, since_s)
        # What is heard of him meanwhile tells how he goes on: then nothing is missed all along.
        untold_m2 = missed_m2(span_s, missed_s, node.raw) if since_s == 0.0 else 0.0
        delta_m, trail = STOOD, tuple[Mark, ...]()
        if onward and since_s + span_s <= SILENT_S and len(node.trail) > 1:
            delta_m = onward_m(node.trail, span_s, since_s)
            trail = (*node.trail, mark_after(node.trail[-1], t, delta_m))
        across, _, up, turn, bias, scale = noise
        across = max(across, untold_m2)
        placed_t, silent = t if name in placed else node.placed_t, since_s + span_s > SILENT_S
        if silent and t > placed_t + physics.UNHEARD_MEMORY_S:
            across = max(across, unplaced_m2(span_s, since_s))
        step = (*delta_m, across, up, turn, bias, scale, UNSEEN)
        state.ledger.add("steps", t, node.index, node.pose_t, *step)
        moves.append((node, delta_m, span_s, (across, across, up, turn, bias, scale)))
        state.nodes[name] = replace(
            node,
            pose_t=t,
            trail=trail,
            missed_s=missed_s + (span_s if since_s == 0.0 else 0.0),
            placed_t=placed_t,
            # What readings of a link have in common he leaves behind as he goes, seen or not.
            way_m=node.way_m + (physics.FREE_WAY_MPS * span_s if silent else 0.0),
        )
    # His unit's frame turns on, whether it reports or not.
    advance_by(state, moves)
