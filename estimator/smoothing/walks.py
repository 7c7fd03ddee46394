"""The way of each moving node on the grid of keyframes, as its readings alone tell it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.free import free_motion
from estimator.fusion.motion import LONGEST_S, NOISE_FLOOR, increment_of
from estimator.fusion.nodes import NodeState
from estimator.fusion.rows import Linear
from estimator.graph.dense import Array
from estimator.graph.variable import Variable
from estimator.measurements.displacement import Displacement, move


class Walk(NamedTuple):
    """One moving node over the keyframes that it lives in.

    Attributes:
        node: the node, as it was when it began.
        first: its first keyframe.
        last: its last one.
        way: for a unit, displacement in its frame, and variances of position, ψ, β and s, summed up to each
            epoch: m × 10 (epochs, 3 + 6); for a free node 0 × 10.
        turns: gyro biases shown while standing, with the keyframe that each belongs to.
    """

    node: NodeState
    first: int
    last: int
    way: Array
    turns: list[tuple[int, Linear]]

    def is_unit(self) -> bool:
        """Whether it moves by displacements."""
        return len(self.way) > 0

    def lengths(self, epochs: Array, x: Array, starts: dict[Variable, int]) -> Array:
        """How far it had walked at each keyframe, k (m): by its unit, or where it is thought to have been."""
        if self.is_unit():
            steps = np.linalg.norm(np.diff(self.way[:, 1:4], axis=0), axis=1)
            return np.interp(epochs, self.way[:, 0], np.r_[0.0, np.cumsum(steps)])
        alive = range(self.first, self.last + 1)
        rows = [starts[Variable("position", self.node.node, float(k))] for k in alive]
        places = x[np.array(rows)[:, None] + np.arange(3)]
        steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
        return np.interp(epochs, epochs[self.first : self.last + 1], np.r_[0.0, np.cumsum(steps)])

    def summed(self, t: Array) -> Array:
        """Displacement and variances summed up to epochs `t`, m × 9; silence adds a random walk."""
        marks = self.way[:, 0]
        inside = np.clip(t, marks[0], marks[-1])
        values = np.column_stack([np.interp(inside, marks, self.way[:, c]) for c in range(1, 10)])
        silent = np.minimum(np.abs(t - inside), LONGEST_S)
        values[:, 3:5] += np.sign(t - inside)[:, None] * (physics.SILENT_M_PER_ROOT_S**2 * silent)[:, None]
        values[:, 5] += np.sign(t - inside) * (0.1 * physics.SILENT_M_PER_ROOT_S**2 * silent)
        return values


def unit_walk(
    node: NodeState, begin_t: float, reports: Sequence[Displacement], span: tuple[int, int]
) -> Walk:
    """The way of a node with a PDR unit: its reports, judged as the tracker judges them.

    Args:
        node: the node.
        begin_t: epoch of its first position.
        reports: its displacements in order of epoch.
        span: first and last keyframe.
    """
    now = replace(node, mode="unit", pose_t=begin_t, unit_t=None, trail=(), unit_heading_rad=None)
    marks = [(begin_t, *(0.0,) * 9)]
    summed = np.zeros(9)
    turns = []
    for report in reports:
        increment = increment_of(now, report)
        if increment is None:
            continue
        if increment.turn is not None:
            turns.append((int(report.t), increment.turn))
        now = increment.node
        summed = summed + np.concatenate([increment.delta_m, increment.noise])
        if report.t > marks[-1][0]:
            marks.append((report.t, *summed.tolist()))
    return Walk(node, *span, np.array(marks), turns)


class Motion(NamedTuple):
    """What all nodes' motion adds to the normal equations at an estimate, for one node.

    Attributes:
        transition: F of each step, k × 6 × 6.
        information: Q⁻¹ of each step, k × 6 × 6.
        residual: where the next keyframe is, less where the step leads, k × 6.
    """

    transition: Array
    information: Array
    residual: Array


def motion_of(walk: Walk, epochs: Array, states: Array) -> Motion:
    """Linearise a node's motion between its keyframes.

    Args:
        walk: the node.
        epochs: of its keyframes, k + 1 (s).
        states: position and unit errors, or position and velocity, (k + 1) × 6.
    """
    steps = len(epochs) - 1
    durations = np.diff(epochs)
    if walk.is_unit():
        each = np.diff(walk.summed(epochs), axis=0)
        led, transition = move(states[:-1], each[:, :3], durations)
        noise = np.maximum(each[:, 3:], 0.0) + NOISE_FLOOR
        information = np.zeros((steps, 6, 6))
        information[:, range(6), range(6)] = 1.0 / noise
        return Motion(transition, information, states[1:] - led)
    pairs = [free_motion(walk.node.role, float(d)) for d in durations]
    transition = np.array([f for f, _ in pairs]).reshape(steps, 6, 6)
    information = np.linalg.inv(np.array([q for _, q in pairs]).reshape(steps, 6, 6))
    led = np.einsum("kij,kj->ki", transition, states[:-1])
    return Motion(transition, information, states[1:] - led)


def block(walk: Walk, keyframe: int) -> Variable:
    """The position block of a node at a keyframe; its unit's or velocity's block follows it."""
    return Variable("position", walk.node.node, float(keyframe))
