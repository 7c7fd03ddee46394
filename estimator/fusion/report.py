"""What leaves the fusion: estimates of every node, and the position of one relative to another."""

import math

import numpy as np
from numba import njit

from estimator.estimate import NodeEstimate, Relative
from estimator.fusion import physics
from estimator.fusion.entering.introduce import tuple_of, upper_triangle
from estimator.fusion.entering.late_start import unsure_m2
from estimator.fusion.entering.separated_unit import apart_m2, elsewhere_m2
from estimator.fusion.entering.technologies import technology_variable
from estimator.fusion.images import doubt_between_m2
from estimator.fusion.learned.calibration import doubt
from estimator.fusion.learned.delays import Suspicion
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.heading_arcs import loose_headings, swung_m2, swung_most_m2
from estimator.graph.dense import Array, Indices
from estimator.graph.variable import BODY, Variable
from estimator.measurements.bearing import within_pi

NOTHING = 1e-3
"""What a doubt adds to the variance of a scale, as a share of it, that is not seen in any place."""
MOVING_MPS = 0.3
"""Below it a velocity tells no heading."""


def covariance_of(state: FusionState) -> Array:
    """Σ of the graph, n × n.

    It holds also that radios may be calibrated otherwise than is assumed, and told places and fixes be wrong;
    that a bearer is not where his boot stands; and that nobody may have entered when the log began.
    """
    graph = state.graph
    found = graph.covariance()
    places = ((state.nodes[name], mistold.moment_m2) for name, mistold in state.mistold.items())
    told = [
        (graph.starts[node.position], slice(0, 2), moment) for node, moment in places if node.mode == "static"
    ]
    for name, receiver in state.receivers.items():
        told += [(graph.starts[Variable("receiver", name)], *doubt) for doubt in receiver.doubts]
    elsewhere = [(_along(found, start, own), moment) for start, own, moment in told]
    judged = [(name, 0, known) for name, known in state.calibrations.items()]
    judged += [(name, BODY, known) for name, known in state.bodies.items()]
    for name, number, known in judged:
        start = graph.starts.get(technology_variable(name))
        if start is not None:
            row = start + number
            variance = float(found[row, row])
            factor = doubt(known, float(graph.reference[row]), variance)
            if factor * variance > NOTHING:
                widen(found, row, factor)
    for (_, name), suspicion in state.suspects.items():
        _widen_by_delay(state, state.nodes[name], suspicion, found)
    for along, moment_m2 in elsewhere:
        found += along @ moment_m2 @ along.T
    for node in state.nodes.values():
        if node.raw and node.mode == "unit":
            rows = state.graph.starts[node.position] + np.arange(2)
            found[rows, rows] += physics.BESIDE_M**2
    for name, m2 in unsure_m2(state).items():
        start = graph.starts.get(state.nodes[name].position)
        if start is not None:
            rows = start + np.arange(2)
            found[rows, rows] += m2
    return found


def _along(covariance: Array, start: int, numbers: slice) -> Array:
    """By how much everything goes along with some numbers p of a block, n × k: Σ_xp Σ_pp⁻¹.

    Args:
        covariance: Σ, n × n.
        start: first row of the block.
        numbers: which of its numbers, k.
    """
    own = slice(start + numbers.start, start + numbers.stop)
    return np.asarray(np.linalg.solve(covariance[own, own], covariance[own]).T, dtype=np.float64)


def _widen_by_delay(state: FusionState, node: NodeState, suspicion: Suspicion, covariance: Array) -> None:
    """Let who carries a radio be as unsure as its antenna delay is.

    For him the technologies T seem off by u: his place goes along as it does with what these are off by for
    everybody, by Σ_xT Σ_TT⁻¹ u. Where no other radio takes part, so does everything else.

    Args:
        state: the fusion.
        node: who carries it.
        suspicion: what it may be off by.
        covariance: Σ, n × n, changed.
    """
    graph = state.graph
    held = {name: graph.starts.get(Variable("range", name)) for name in suspicion.off}
    off = [(start, suspicion.off[name]) for name, start in held.items() if start is not None]
    if not node.moving or not node.decided or not off:
        return
    at = np.array([(start, start + 1) for start, _ in off]).ravel()
    by = np.linalg.solve(covariance[at[:, None], at], np.array([numbers for _, numbers in off]).ravel())
    moved = covariance[:, at] @ by
    if not suspicion.alone:
        own = np.zeros(len(moved))
        for block in (node.position, node.unit if node.mode == "unit" else node.velocity):
            own[graph.rows(block)] = moved[graph.rows(block)]
        moved = own
    covariance += moved[:, None] * moved


@njit(cache=True)
def widen(covariance: Array, row: int, factor: float) -> None:
    """Add to all covariances what a larger variance of one number gives them, in place.

    Args:
        covariance: Σ, n × n, changed.
        row: of the number.
        factor: what is added to its variance, as a share of its square.
    """
    share, n = covariance[:, row].copy(), len(covariance)
    for r in range(n):
        for c in range(n):
            covariance[r, c] += factor * (share[r] * share[c])


def estimates(state: FusionState, covariance: Array) -> list[NodeEstimate]:
    """Every node ever introduced, in order of introduction.

    Args:
        state: the fusion.
        covariance: see `covariance_of`, n × n.
    """
    graph = state.graph
    loose = np.array(loose_headings(state, covariance), dtype=np.intp)
    told = shown(graph.firsts("position"), graph.reference, covariance, loose).tolist()
    numbers, found = graph.numbers("position"), list[NodeEstimate]()
    for node in state.nodes.values():
        number = numbers.get(node.position)
        found.append(_estimate(state, node, covariance, None if number is None else told[number]))
    return found


def estimate_of(state: FusionState, name: str) -> NodeEstimate | None:
    """What is shown of one node now; None: nobody knows of it."""
    if name not in state.nodes:
        return None
    found = estimates(state, covariance_of(state))
    return next(estimate for estimate in found if estimate.node == name)


@njit(cache=True)
def shown(starts: Indices, x: Array, covariance: Array, loose: Indices) -> Array:
    """Places and their covariances, m × 9: e, n, u (m); ee, en, eu, nn, nu, uu (m²).

    Args:
        starts: first row of the block of each place, m.
        x: the reference of the graph, n.
        covariance: Σ of it, n × n.
        loose: rows of the headings along whose arcs places swing, see `heading_arcs.loose_headings`.
    """
    found = np.empty((len(starts), 9))
    for i in range(len(starts)):
        at, after = starts[i], 3
        for r in range(3):
            found[i, r] = x[at + r]
            for c in range(r, 3):
                found[i, after] = covariance[at + r, at + c]
                after += 1
    if len(loose) > 0:
        across, variance = np.empty((len(starts), 3, len(loose))), np.empty(len(loose))
        for h in range(len(loose)):
            variance[h] = covariance[loose[h], loose[h]]
            for i in range(len(starts)):
                for r in range(3):
                    across[i, r, h] = covariance[starts[i] + r, loose[h]]
        swung = swung_most_m2(across, variance)
        for i in range(len(starts)):
            after = 3
            for r in range(3):
                for c in range(r, 3):
                    found[i, after] += swung[i, r, c]
                    after += 1
    return found


def _estimate(
    state: FusionState, node: NodeState, covariance: Array, place: list[float] | None
) -> NodeEstimate:
    if place is None:
        known = (0.0,) * 6 if node.mode == "fixed" else node.covariance_m2
        return NodeEstimate(
            node=node.node,
            role=node.role,
            t=node.t,
            position_m=node.place_m,
            covariance_m2=known,
            retired=node.mode == "retired",
        )
    east, north, up, ee, en, eu, nn, nu, uu = place
    rival = node.rival is not None and node.rival.counts
    if rival or node.otherwise or node.detours or node.apart is not None:
        doubt = elsewhere_m2(node, np.array([east, north]))
        ee, en, nn = ee + float(doubt[0, 0]), en + float(doubt[0, 1]), nn + float(doubt[1, 1])
    uu = max(uu, node.doubt_up_m2) + node.absolute.zeroed.contradicts_m2
    heading, sigma = _heading(state, node, covariance) if node.moving else (None, None)
    return NodeEstimate(
        node=node.node,
        role=node.role,
        t=node.t,
        position_m=(east, north, up),
        covariance_m2=(ee, en, eu, nn, nu, uu),
        heading_rad=heading,
        heading_sigma_rad=sigma,
        speed_mps=node.speed_mps,
    )


def _heading(state: FusionState, node: NodeState, covariance: Array) -> tuple[float | None, float | None]:
    """The unit's reported heading plus ψ; else the direction of its way."""
    if node.mode == "unit":
        start = state.graph.starts[node.unit]
        psi, sigma = float(state.graph.reference[start]), math.sqrt(covariance[start, start])
        if node.unit_heading_rad is not None:
            return within_pi(node.unit_heading_rad + psi), sigma
        if len(node.trail) > 1 and (node.speed_mps or 0.0) > MOVING_MPS:
            _, e, n, _ = (np.array(node.trail[-1]) - np.array(node.trail[-2])).tolist()
            return within_pi(float(np.arctan2(n, e)) + psi), float(np.hypot(sigma, 0.1))
    if node.mode == "free" and (node.speed_mps or 0.0) > MOVING_MPS:
        rows = state.graph.rows(node.velocity)
        east, north, _ = state.graph.value(node.velocity).tolist()
        speed = float(np.hypot(east, north))
        across = np.array([-north, east, 0.0]) / speed**2
        sigma = float(np.sqrt(across @ covariance[rows, rows] @ across))
        return float(np.arctan2(north, east)), sigma
    return None, None


def relative(state: FusionState, covariance: Array, a: str, b: str) -> Relative | None:
    """Where `b` is relative to `a`, cross terms included; None where either has no position.

    Raises:
        KeyError: a node is not known.
    """
    ends = state.nodes[a], state.nodes[b]
    if a == b or any(n.place_m is None and not n.decided for n in ends):
        return None
    selector = np.zeros((3, state.graph.size))
    total = np.zeros((3, 3))
    places = []
    for node, sign in zip(ends, (-1.0, 1.0), strict=True):
        places.append(state.place(node))
        if node.place_m is None:
            selector[:, state.graph.rows(node.position)] += sign * np.eye(3)
        elif node.covariance_m2 is not None:
            ee, en, eu, nn, nu, uu = node.covariance_m2
            total += np.array([[ee, en, eu], [en, nn, nu], [eu, nu, uu]])
    across = selector @ covariance
    total += across @ selector.T
    loose = loose_headings(state, covariance)
    total += swung_m2(across[None, :, loose], covariance[loose, loose])[0]
    total[2, 2] = max(total[2, 2], sum(node.doubt_up_m2 for node in ends))
    total[2, 2] += sum(node.absolute.zeroed.contradicts_m2 for node in ends)
    held = [(*node.otherwise, *node.detours) if node.place_m is None else () for node in ends]
    total += doubt_between_m2(held[0], places[0][:2], held[1], places[1][:2])
    for node, place_m in zip(ends, places, strict=True):
        if node.place_m is None:
            total += apart_m2(node, place_m[:2])
    return Relative(delta_m=tuple_of(places[1] - places[0]), covariance_m2=upper_triangle(total))
