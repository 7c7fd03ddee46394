"""How far back the window reaches, and what becomes of what leaves it."""

import numpy as np

from estimator.fusion.memory.prior import SIZES, Key, Prior
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Indices
from estimator.graph.kirchhoff import marginalised
from estimator.graph.variable import TECHNOLOGIES
from estimator.smoothing.keyframes.layout import technology_key
from estimator.smoothing.keyframes.levelled_ways import forget_steps
from estimator.smoothing.keyframes.losses import going_on
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.gauge_turn import turned
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

SPACING_S = 2.0
FREE_SPACING_S = 1.0
LONGEST_S = 300.0
SHORTEST_S = 60.0
SLACK = 0.2
"""A window grows by this much of its length before its oldest keyframes go."""
STEPS_S = 60.0
ROWS_MAX = 40_000
WORK = 1e8
"""Multiplications of one Gauss-Newton step that are worth their time every `PERIOD_S`: beyond it the window
gets shorter, and then the solutions rarer."""


def spacing_s(state: FusionState) -> float:
    """Time between keyframes (s): where a unit's own way does not fill it, it is shorter."""
    free = any(node.mode == "free" for node in state.nodes.values())
    return FREE_SPACING_S if free else SPACING_S


def work(state: FusionState) -> float:
    """Multiplications that one keyframe costs."""
    width = STATES * sum(node.moving for node in state.nodes.values())
    return float(max(width, 1) * max(state.graph.size, 1) ** 2)


def trim(problem: Problem, solved: Solution) -> tuple[Prior, float] | None:
    """Marginalise the window's oldest keyframes where it has become long: the prior of the next solution."""
    layout, rows = problem.layout, len(problem.rows.slab)
    lasted = float(layout.grid[-1] - layout.grid[0])
    affordable = WORK / work(problem.layout.state) * spacing_s(problem.layout.state)
    longest = max(min(LONGEST_S, affordable, lasted * ROWS_MAX / max(rows, 1)), SHORTEST_S)
    if lasted < longest * (1.0 + SLACK):
        return None
    cut = int(np.searchsorted(layout.grid, layout.grid[-1] - longest))
    before = problem.assemble(solved.x, solved.linear, solved.weighted, solved.motions, cut)
    left = turned(before.remainder(cut), layout, problem.pivot_m, problem.first(solved.x), solved.x)
    keys: list[Key] = []
    at: list[Indices] = []
    epochs: dict[int, float] = {}
    for i, walk in enumerate(layout.walks):
        if walk.first <= cut <= walk.last:
            keys.append(("free" if walk.way is None else "walk", walk.number))
            epochs[walk.number] = float(layout.times[cut, i])
            at.append(np.arange(STATES * i, STATES * (i + 1)))
    for number, start in layout.stands.items():
        keys.append(("stand", number))
        at.append(layout.width + np.arange(start, start + 3))
    for key, start in layout.technologies.items():
        keys.append(key)
        at.append(layout.width + np.arange(start, start + SIZES[key[0]]))
    kept = going_on(layout.lost, float(layout.grid[cut]))
    keys += kept
    at += [np.array([layout.width + layout.lost[key].column]) for key in kept]
    over = [layout.width + one.column for key, one in layout.lost.items() if key not in kept]
    chosen = np.concatenate(at) if at else np.zeros(0, dtype=np.intp)
    here = np.concatenate(
        [solved.x[cut * layout.width : (cut + 1) * layout.width], solved.x[layout.length * layout.width :]]
    )
    matrix, vector = left.matrix[np.ix_(chosen, chosen)], left.vector[chosen]
    if over:
        matrix, vector = marginalised(left.matrix, left.vector, np.array(over, dtype=np.intp), chosen)
    prior = Prior(tuple(keys), matrix, vector, here[chosen], epochs)
    return prior, float(layout.grid[cut])


def restart(state: FusionState) -> None:
    """Begin the window anew from what the filter knows: it has come to span more than can be solved.

    Nothing is lost but the chance to linearise again what was long ago.
    """
    graph = state.graph
    walking = [n for n in state.nodes.values() if n.moving]
    keys: list[Key] = [("walk" if n.mode == "unit" else "free", n.index) for n in walking]
    at: list[Indices] = []
    for node in walking:
        rest = node.unit if node.mode == "unit" else node.velocity
        at += [np.arange(*graph.rows(v).indices(graph.size)) for v in (node.position, rest)]
    for variable in graph.starts:
        owner = state.nodes.get(variable.owner)
        if variable.kind in TECHNOLOGIES:
            keys.append(technology_key(state, variable))
        elif owner is not None and owner.mode == "static":
            keys.append(("stand", owner.index))
        else:
            continue
        at.append(np.arange(*graph.rows(variable).indices(graph.size)))
    chosen = np.concatenate(at) if at else np.zeros(0, dtype=np.intp)
    matrix = graph.information[np.ix_(chosen, chosen)].copy()
    vector, reference = graph.vector[chosen].copy(), graph.reference[chosen].copy()
    state.prior = Prior(tuple(keys), matrix, vector, reference, {n.index: n.pose_t for n in walking})
    state.window_t = max((n.pose_t for n in walking), default=state.newest_t)
    state.ledger.forget(state.window_t + 1e-3, ("pairs", "singles", "drops"))
    state.ledger.forget(state.window_t - STEPS_S, ("poses",))
    forget_steps(state, state.window_t - STEPS_S)
