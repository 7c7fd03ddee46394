"""From a solved window back to the filter: its Kirchhoff matrix of now, and where everyone was."""

import numpy as np

from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array, Indices
from estimator.graph.kirchhoff import Kirchhoff, marginalised
from estimator.graph.variable import DIMENSION, TECHNOLOGIES, Variable
from estimator.smoothing.keyframes.layout import Layout, technology_key
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.solution import Solution

NONE = np.zeros(0, dtype=np.intp)


def hand_back(state: FusionState, layout: Layout, solved: Solution, matrix: Array) -> None:
    """Put the window's Kirchhoff matrix of now in the place of the filter's."""
    graph = state.graph
    columns: dict[Variable, Indices] = {}
    gone: list[Indices] = []
    here = np.concatenate(
        [
            solved.x[(layout.length - 1) * layout.width : layout.length * layout.width],
            solved.x[layout.length * layout.width :],
        ]
    )
    for i, walk in enumerate(layout.walks):
        own = np.arange(STATES * i, STATES * (i + 1))
        node = state.life(walk.number)
        if node.moving:
            columns[node.position] = own[:3]
            columns[node.velocity if walk.way is None else node.unit] = own[3:]
        elif walk.last == layout.length - 1:
            gone.append(own)
    for number, start in layout.stands.items():
        node = state.life(number)
        own = layout.width + np.arange(start, start + 3)
        if node.index == number and node.mode == "static":
            columns[node.position] = own
        else:
            gone.append(own)
    for variable in graph.starts:
        if variable.kind in TECHNOLOGIES:
            start = layout.width + layout.technologies[technology_key(state, variable)]
            columns[variable] = start + np.arange(DIMENSION[variable.kind])
    gone.append(layout.width + np.array([one.column for one in layout.lost.values()], dtype=np.intp))
    order = [v for v in graph.starts if v in columns]
    if len(order) != len(graph.starts):
        raise ValueError("the window does not hold all that the filter holds")
    if not order:
        # All have left.
        return
    kept = np.concatenate([columns[v] for v in order])
    nothing = np.zeros(len(matrix))
    left, rest = marginalised(matrix, nothing, np.concatenate([*gone, NONE]), kept)
    reference = here[kept]
    if not np.isfinite(reference).all():
        raise ValueError("the window's solution is not finite")
    # Where the window has not come to rest, what is left of its gradient is dropped: it asks for a step
    # that Marquardt's damping has refused.
    state.graph = Kirchhoff.of(order, left, rest, reference)


def keep_keyframes(state: FusionState, layout: Layout, x: Array) -> None:
    """The solution's keyframes are where the next one starts from."""
    size = layout.length * layout.width
    keyframes = x[:size].reshape(layout.length, layout.width)
    poses = state.ledger.table("poses")
    parts = [poses[poses[:, 0] < layout.since_t]]
    for i, walk in enumerate(layout.walks):
        alive = slice(walk.first, walk.last + 1)
        states = keyframes[alive, STATES * i : STATES * (i + 1)]
        told = np.empty((len(states), 9))
        told[:, 0], told[:, 1], told[:, 2] = layout.times[alive, i], walk.number, float(walk.way is not None)
        told[:, 3:] = states
        parts.append(told)
    state.ledger.replace("poses", np.concatenate(parts))
