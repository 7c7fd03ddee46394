"""Where an undecided node is: every place that its sightings allow, and whether one is clearly the best.

A range-only node starts as a ring, and after a straight path as two mirror images (estimation.md, point 7).
It enters the graph only once the second mode is clearly worse, and then with all its sightings, each used
once.
"""

from typing import Literal, NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.held import pair_of
from estimator.fusion.introduce import NO_PRIOR_SIGMA_M, place
from estimator.fusion.modes import Mode, Sought, find_modes
from estimator.fusion.nodes import NodeState, Sighting
from estimator.fusion.rows import End, Stack
from estimator.fusion.state import FusionState
from estimator.fusion.update import update
from estimator.graph.dense import Array
from estimator.graph.variable import Variable
from estimator.measurements.node import MOVING_ROLES

JOINT_ITERATIONS = 15


class Chosen(NamedTuple):
    """A decided beginning: the mode, and the height prior that it was found with (m)."""

    mode: Mode
    up_m: float
    up_sigma_m: float


def decide(state: FusionState) -> None:
    """Try undecided nodes that have been seen anew, and begin those whose position is decided."""
    covariance: Array | None = None
    for name in list(state.sightings):
        sightings = state.sightings[name]
        tried = state.tried.get(name, 0)
        if len(sightings) < max(physics.SIGHTINGS_MIN, min(tried + 10, 1.2 * tried)):
            continue
        state.tried[name] = len(sightings)
        node = state.nodes[name]
        if covariance is None or len(covariance) != state.graph.size:
            covariance = state.graph.covariance()
        chosen = _choose(state, node, sightings, covariance)
        if chosen is not None:
            _begin(state, node, sightings, chosen)
            covariance = None


def _choose(
    state: FusionState, node: NodeState, sightings: tuple[Sighting, ...], covariance: Array
) -> Chosen | None:
    kind: Literal["range", "rssi"] = "range" if any(s.kind == "range" for s in sightings) else "rssi"
    owners = [s.technology for s in sightings if s.kind == kind]
    owner = max(sorted(set(owners)), key=owners.count)
    used = [s for s in sightings if s.kind == kind and s.technology == owner]
    if len(used) < physics.SIGHTINGS_MIN:
        return None
    # Adds the technology's states with their prior, if this is its first reading.
    pair_of(state, kind, (End(None, (0.0,) * 3),) * 2, 0.0, 1.0, owner)
    states = Variable("range" if kind == "range" else "rssi", owner)
    if state.graph.size != len(covariance):
        covariance = state.graph.covariance()
    rows = state.graph.rows(states)
    points, spread = _points(state, used, covariance)
    source = owner if kind == "range" else f"rssi {owner}"
    sigma = np.array([s.sigma for s in used]) * state.learned(source).factor
    if kind == "range":
        sigma = np.hypot(sigma, spread)
    moving = node.role in MOVING_ROLES
    up_sigma = physics.UNDECIDED_MOVING_UP_SIGMA_M if moving else physics.UNDECIDED_UP_SIGMA_M
    sought = Sought(
        kind=kind,
        points=points,
        value=np.array([s.value for s in used]),
        sigma=sigma,
        up_m=float(points[:, 2].mean()),
        up_sigma_m=up_sigma,
        extra=state.graph.value(states).copy(),
        extra_covariance=covariance[rows, rows],
    )
    modes = find_modes(sought)
    if not modes or modes[0].sigma_m > physics.DECIDED_SIGMA_M[kind]:
        return None
    if len(modes) > 1 and modes[1].cost - modes[0].cost < physics.MODE_MARGIN:
        return None
    return Chosen(modes[0], sought.up_m, up_sigma)


def _points(state: FusionState, used: list[Sighting], covariance: Array) -> tuple[Array, Array]:
    """Where the sightings were made, m × 3, and how unsure each place is against the newest one, m (m)."""
    points = np.array([s.offset_m for s in used])
    spread = np.zeros(len(used))
    newest = next((s.other for s in reversed(used) if s.other is not None), None)
    for i, sighting in enumerate(used):
        if sighting.other is None:
            continue
        rows = state.graph.rows(sighting.other)
        points[i] += state.graph.value(sighting.other)
        if newest is not None and sighting.other != newest:
            last = state.graph.rows(newest)
            between = covariance[rows, last]
            relative = covariance[rows, rows] + covariance[last, last] - between - between.T
            spread[i] = np.sqrt(max(0.5 * (relative[0, 0] + relative[1, 1]), 0.0))
    return points, spread


def _begin(state: FusionState, node: NodeState, sightings: tuple[Sighting, ...], chosen: Chosen) -> None:
    mode = chosen.mode
    t = max(s.t for s in sightings)
    if node.role in MOVING_ROLES:
        # The sightings of the last seconds stand in the mode's own covariance; they are not used again.
        place(state, node, t, mode.position_m, (mode.sigma_m, mode.sigma_m, mode.up_sigma_m))
        return
    start = (float(mode.position_m[0]), float(mode.position_m[1]), chosen.up_m)
    place(state, node, t, start, (NO_PRIOR_SIGMA_M, NO_PRIOR_SIGMA_M, chosen.up_sigma_m))
    here = End(node.position, (0.0, 0.0, 0.0))
    pairs = [
        pair_of(
            state,
            s.kind,
            (End(s.other, s.offset_m), here),
            s.value,
            s.sigma,
            s.technology,
        )
        for s in sightings
    ]
    if update(state, Stack(state.graph.starts, [], pairs), JOINT_ITERATIONS) is None:
        state.graph.delete_nodes([node.position])
        state.nodes[node.node] = node
        state.count("not_fused", len(pairs))
    else:
        state.count("fused", len(pairs))
