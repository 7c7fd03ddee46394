"""What a solved window tells: what may be wrong, what is learned, who lies elsewhere, who faces where."""

from collections.abc import Callable, Collection

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.beginnings import decide
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.measurements.bearing import within_pi
from estimator.smoothing.changes.branch import branch
from estimator.smoothing.changes.changed_links import changed_links
from estimator.smoothing.changes.clock_delays import set_clocks
from estimator.smoothing.changes.duplicate_names import tell_duplicate_names
from estimator.smoothing.changes.moved_nodes import moved_nodes
from estimator.smoothing.changes.recent_ranges import RecentRanges
from estimator.smoothing.changes.separated_units import find_separated_units
from estimator.smoothing.images.heading_images import reports_from, to_other_sides
from estimator.smoothing.images.heard_radios import heard_by
from estimator.smoothing.images.image_starts import SAME_RAD
from estimator.smoothing.images.likeliest_image import JudgedImages
from estimator.smoothing.learning.trusted_radios import trust_moved
from estimator.smoothing.learning.unit_noise import learn
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.told_causes import NONE, Causes, ask


def tell_findings(
    state: FusionState, judged: JudgedImages, solved_t: float, build: Callable[[FusionState], Problem]
) -> Causes:
    """Tell a fusion, which has gone on from a solution of its window, what else follows from that.

    Args:
        state: the fusion, changed in place; where a node lies elsewhere, the window is due again.
        judged: the solution.
        solved_t: when the window was last solved (s).
        build: builds the problem of a fusion.

    Returns:
        What was told and may be wrong, not corrected yet.
    """
    problem, solved = judged.problem, judged.solved
    causes = ask(problem, solved) if solved.rests else NONE
    if solved.rests:
        causes.doubt(state)
    found = learn(state, problem, solved, build, other=causes.odds)
    hearing = RecentRanges(problem, solved)
    find_separated_units(state, hearing, set_clocks(state, hearing, solved_t))
    tell_duplicate_names(state, hearing)
    _judge_turns(problem, solved, found, judged.asked)
    _tell_changes(state, problem, solved)
    return causes


def _tell_changes(state: FusionState, problem: Problem, solved: Solution) -> None:
    """Tell of links that have changed, and of nodes that lie elsewhere, which begin anew."""
    for link in changed_links(problem):
        pair = sorted((link.a, link.b))
        text = f"the link between {pair[0]} and {pair[1]} changed by {link.change_db:+.0f} dB for good"
        state.say("link_changed", link.t, pair[0], text, once=f"link {pair[0]} {pair[1]}")
    moves, state.suspected = moved_nodes(problem, solved)
    if moves and not solved.rests:
        # What a solution has left undone is no breadcrumb's fault: it is asked again at rest.
        rested = problem.solve(solved.x)
        moves, state.suspected = moved_nodes(problem, rested)
        state.due = True
    for moved in moves:
        branch(state, moved)
        trust_moved(state, moved.name)
        state.due = True
    decide(state)


def _judge_turns(problem: Problem, solved: Solution, found: Array, asked: Collection[int]) -> None:
    """Mark units whose heading is found, so that turns of it are no longer tried; and those open again."""
    layout = problem.layout
    for i, walk in enumerate(layout.walks):
        node = layout.state.life(walk.number)
        sigma = float(np.sqrt(max(found[walk.last, i, 3, 3], 0.0)))
        one_of_two = any(other.image.turned_rad != 0.0 for other in node.otherwise)
        sure = sigma < physics.TURNED_SIGMA_RAD and not one_of_two
        if one_of_two and not node.turned:
            layout.state.keep(replace(node, turned=True))
        if node.turned and sure and i in asked and not _in_line(problem, solved, i):
            layout.state.keep(replace(node, turned=False))


def _in_line(problem: Problem, solved: Solution, index: int) -> bool:
    """Whether a unit's way lies along the lines to all its radios: its mirror image is the same so far."""
    layout = problem.layout
    walk, way_m = layout.walks[index], layout.states(solved.x, index)[:, :2]
    sides = to_other_sides(heard_by(problem, solved, walk), way_m, walk, reports_from(layout, index))
    return bool(sides) and all(abs(within_pi(by_rad)) < SAME_RAD for by_rad in sides)
