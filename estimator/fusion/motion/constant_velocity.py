"""How nodes without a PDR unit move between ticks: with a velocity that is forgotten with time."""

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.silence import LONGEST_S
from estimator.graph.dense import Array
from estimator.graph.ornstein_uhlenbeck import ornstein_uhlenbeck

LONGEST_STEP = 3.0
"""Memories of a velocity that are carried in one step: its Jacobian's inverse grows as their exponential."""


def move_free(state: FusionState, until: dict[str, float]) -> None:
    """Carry nodes without PDR to the epoch of their newest reading: a velocity that is forgotten with time.

    Args:
        state: the fusion.
        until: epoch to move to, by node; nodes that are there already stay.
    """
    moving = [
        node
        for node, t in ((state.nodes[name], t) for name, t in until.items())
        if node.mode == "free" and t > node.pose_t
    ]
    left_s = {node.node: min(until[node.node] - node.pose_t, LONGEST_S) for node in moving}
    # After many times its memory nothing is left of a velocity, and its transition has no usable inverse.
    # In steps it has one, and steps one after the other are the same process.
    while stepping := [node for node in moving if left_s[node.node] > 0.0]:
        steps_s = [
            min(left_s[node.node], LONGEST_STEP * physics.SPEED_MEMORY_S[node.role]) for node in stepping
        ]
        _carry(state, stepping, steps_s)
        for node, step_s in zip(stepping, steps_s, strict=True):
            left_s[node.node] -= step_s
    for node in moving:
        velocity_m = state.graph.value(node.velocity)
        speed = float(np.hypot(velocity_m[0], velocity_m[1]))
        way = node.way_m + speed * (until[node.node] - node.pose_t)
        state.nodes[node.node] = replace(node, pose_t=until[node.node], speed_mps=speed, way_m=way)


def _carry(state: FusionState, stepping: Sequence[NodeState], steps_s: Sequence[float]) -> None:
    """Carry nodes without PDR on, each by a time of its own (s), all in one operation."""
    rows, moved, transitions, noises = [], [], [], []
    for node, step_s in zip(stepping, steps_s, strict=True):
        start, velocity = state.graph.rows(node.position).start, state.graph.rows(node.velocity).start
        index = [start, start + 1, start + 2, velocity, velocity + 1, velocity + 2]
        transition, noise = free_motion(node.role, step_s)
        rows.append(index)
        moved.append(transition @ state.graph.reference[index])
        transitions.append(transition)
        noises.append(noise)
    state.graph.advance(np.array(rows), np.array(moved), np.array(transitions), np.array(noises))


def free_motion(role: str, duration_s: float) -> tuple[Array, Array]:
    """Transition and noise of position and velocity, 6 × 6 each, over a time (s).

    The velocity is an Ornstein-Uhlenbeck process: v' = v e^(−Δt/τ) + w with the role's usual speed.
    """
    return ornstein_uhlenbeck(physics.SPEED_MEMORY_S[role], *physics.SPEED_SIGMA_MPS[role], duration_s)
