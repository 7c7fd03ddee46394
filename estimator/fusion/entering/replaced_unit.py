"""Who is on the way puts on another unit: his place goes on, but the new one's frame is turned anyhow.

A `node` reading that names another device tells so. What was learned of the old unit, its gyro's bias and the
scale of its steps, tells nothing of the new one; what he faces is known as far as that reading tells it. ψ
goes on as a state, with that doubt, and the new frame is turned into the old one's.
"""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fusion.entering.introduce import initial_turn, turn_sigma
from estimator.fusion.entering.unit_mounting import RIGHT, reported
from estimator.fusion.learned.calibration import UNTOLD
from estimator.fusion.learned.report_period import Cadence
from estimator.fusion.learned.straight_legs import StraightLegs
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.dead_reckoning import FLOOR
from estimator.inertial.displacement import InertialDisplacement
from estimator.inertial.levelling import ANYWHERE_RAD
from estimator.measurements.bearing import within_pi
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node

AGREE_RAD = 0.3
"""Turns that are nearer to each other agree: what a bearer faces is told to the eye."""


def reports_another_unit(known: NodeState, reading: Node) -> bool:
    """Whether a `node` reading names another device than the one whose displacements lead a node."""
    told = known.device is not None and reading.device is not None
    return known.mode == "unit" and told and reading.device != known.device


def announce(state: FusionState, reading: Node) -> None:
    """Take down that a unit is another one from now on: what is navigated of the old one ends."""
    node = state.nodes[reading.node]
    state.navigations.pop(node.node, None)
    state.nodes[node.node] = replace(
        node, changed=(reading.t, reading.heading_rad), still=None, straight=StraightLegs(), cadence=Cadence()
    )
    state.announced[node.node] = reading.t
    faces = "as told" if reading.heading_rad is not None else "not known"
    text = (
        f"{node.node} wears another unit, {reading.device}: its heading is {faces}, its gyros not known yet"
    )
    state.say("unit_changed", reading.t, node.node, text)


def change(state: FusionState, name: str) -> None:
    """Doubt the errors of a unit that is another one: its frame, its gyro's bias, and its scale."""
    node = state.nodes[name]
    if node.mode != "unit" or node.changed is None:
        return
    _, told_rad = node.changed
    by_place, by_turn = node.walk_factors
    # That the old one was better than assumed says nothing of the new one; its own steps stay as doubtful.
    factors = max(by_place, 1.0), max(by_turn, 1.0)
    state.nodes[name] = node = replace(node, bias_told=UNTOLD, walk_factors=factors, rival=None)
    sigma_rad = ANYWHERE_RAD if told_rad is None else turn_sigma(node)
    _, bias, scale = state.graph.value(node.unit).tolist()
    # What the old one was off by is no better a guess than nil.
    bias2 = state.bias_sigma_radps(node) ** 2 + bias**2
    _doubt(state, node, (sigma_rad**2, bias2, state.scale_sigma(node) ** 2 + scale**2))


def begin_frame(state: FusionState, reading: Displacement) -> None:
    """Turn the frame of a unit that has just been put on, by its first displacement, into the old one's."""
    node = state.nodes.get(reading.node)
    if node is None or node.changed is None or node.mode != "unit":
        return
    changed_t, told_rad = node.changed
    if reading.t <= changed_t:
        return
    raw, faced_rad = isinstance(reading, InertialDisplacement), reading.heading_rad
    before_rad, frame_rad = node.unit_heading_rad, 0.0
    if told_rad is not None:
        frame_rad = 0.0 if raw else initial_turn(told_rad, faced_rad)
        frame_rad -= float(state.graph.value(node.unit)[0])
        if not raw and faced_rad is not None and _ambiguous(told_rad, faced_rad):
            _doubt(state, node, (ANYWHERE_RAD**2, *FLOOR[4:]))
    elif before_rad is not None and faced_rad is not None:
        # Nobody tells: he rather goes on as he went than not.
        frame_rad = before_rad - faced_rad
    state.nodes[node.node] = replace(node, raw=raw, changed=None, frame_rad=within_pi(frame_rad), worn=RIGHT)


def _ambiguous(told_rad: float, faced_rad: float) -> bool:
    """Whether no two of the turns agree that a told heading can mean, see `initial_turn`."""
    faced, axis = within_pi(told_rad - faced_rad), within_pi(told_rad)
    return min(abs(within_pi(faced - axis)), abs(faced), abs(axis)) > AGREE_RAD


def _doubt(state: FusionState, node: NodeState, variances: tuple[float, float, float]) -> None:
    """Add to the variances of ψ (rad²), of its gyro's bias ((rad/s)²), and of its scale."""
    rows = np.array([state.graph.starts[node.unit] + np.arange(3)])
    state.graph.advance(rows, state.graph.reference[rows], np.eye(3)[None], np.diag(variances)[None])
    step = (0.0, 0.0, 0.0, 0.0, 0.0, *variances, 1.0)
    state.ledger.add("steps", node.pose_t, node.index, node.pose_t, *step)


def framed(node: NodeState, reading: Displacement) -> Displacement:
    """A displacement in the frame that ψ counts from."""
    reading = reported(node, reading)
    if node.frame_rad == 0.0:
        return reading
    east, north, up = reading.delta_m
    cosine, sine = math.cos(node.frame_rad), math.sin(node.frame_rad)
    faces = None if reading.heading_rad is None else reading.heading_rad + node.frame_rad
    turned = (cosine * east - sine * north, sine * east + cosine * north, up)
    return replace(reading, delta_m=turned, heading_rad=faces)
