"""What it does to the places of a solved chain that a technology, a radio or a told place may be off."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion.learned.calibration import Calibration, doubt
from estimator.graph.dense import Array
from estimator.graph.variable import BODY
from estimator.smoothing.changes.told_fixes import shared_moments
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.learning.delays import scored_delays
from estimator.smoothing.learning.radios import ranges_by_radio
from estimator.smoothing.learning.suspected_delays import suspects
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution
from estimator.smoothing.results.heading_arcs import responses
from estimator.smoothing.told_causes import ask


def scales(layout: Layout) -> dict[int, Calibration]:
    """What is thought of scales of technologies and of bodies, by where they are in an estimate, flat."""
    state, size = layout.state, layout.length * layout.width
    found = {}
    for (kind, source), start in layout.technologies.items():
        name = state.sources[source]
        known = state.calibrations.get(name) if kind == "range" else None
        if known is not None:
            # Each solution of the whole incident has a prior of its own.
            narrow, assumed = state.narrow_sigma(name), state.range_scale_sigma(name)
            found[size + start] = replace(known, narrow=narrow, assumed=assumed)
        bodies = state.bodies.get(name) if kind in ("range", "rssi") else None
        if bodies is not None:
            found[size + start + BODY] = replace(bodies, assumed=state.body_sigma(name, kind == "rssi"))
    return found


def doubt_scales(layout: Layout, solved: Solution, found: tuple[Array, Array, Array]) -> None:
    """Let covariances hold that ranging technologies may be of the other kind than they were taken for.

    Args:
        layout: of the chain.
        solved: its solution, whose chain is solved.
        found: covariances of the keyframes, of each with the next one and of the border, as
            `Chain.covariances` gives them; changed in place.
    """
    judged = scales(layout)
    across = responses(layout, solved, list(judged))
    for i, (row, known) in enumerate(judged.items()):
        factor = doubt(known, float(solved.x[row]), float(across[row, i]))
        _widen(layout, found, factor, across[:, i])


class Doubt(NamedTuple):
    """Something that may be otherwise than it is taken to be.

    Attributes:
        square: mean square of what it may be off by.
        moved: by how much each unknown is elsewhere then, for each of its units, flat.
    """

    square: float
    moved: Array


def suspected(problem: Problem, solved: Solution) -> list[Doubt]:
    """What radios may be off by that are trusted, and places that were told.

    Args:
        problem: of the chain.
        solved: its solution, whose chain is solved.
    """
    told = ranges_by_radio(problem, solved)
    radios = suspects(problem, solved, told, scored_delays(problem, solved, told))
    return [*(Doubt(one.off_m2, one.moved) for one in radios), *_told(problem, solved)]


def _told(problem: Problem, solved: Solution) -> list[Doubt]:
    """Told places and fixes that may be wrong: all goes along with such numbers p by L⁻¹_xp (L⁻¹_pp)⁻¹."""
    layout, causes = problem.layout, ask(problem, solved)
    size, found = layout.length * layout.width, []
    wrong = causes.doubted_places()
    told = [
        (layout.stands[place.number], slice(0, 2), wrong[place.name].moment_m2)
        for place in causes.places
        if place.name in wrong
    ]
    for fixes, moment in shared_moments(causes.fixes, causes.besides_fixes()):
        number = layout.state.source(fixes.name)
        told.append((layout.technologies["receiver", number], fixes.own, moment))
    for start, own, moment in told:
        first, last = size + start + own.start, size + start + own.stop
        across = responses(layout, solved, list(range(first, last)))
        along = np.linalg.solve(across[first:last], across.T).T
        squares, axes = np.linalg.eigh(moment)
        found += [
            Doubt(square, along @ axis)
            for square, axis in zip(np.maximum(squares, 0.0).tolist(), axes.T, strict=True)
        ]
    return found


def doubt_suspected(problem: Problem, solved: Solution, found: tuple[Array, Array, Array]) -> None:
    """Let covariances hold that radios may have an antenna delay, and told places may be wrong.

    Args:
        problem: of the chain.
        solved: its solution, whose chain is solved.
        found: see `doubt_scales`; changed in place.
    """
    for suspect in suspected(problem, solved):
        _widen(problem.layout, found, suspect.square, suspect.moved)


def _widen(layout: Layout, found: tuple[Array, Array, Array], square: float, moved: Array) -> None:
    """Add the mean square of a number to covariances of what moves by so much for each of its units."""
    keyframes, ahead, border = found
    size = layout.length * layout.width
    walks, lasting = moved[:size].reshape(layout.length, -1, STATES), moved[size:]
    keyframes += square * np.einsum("kwi,kwj->kwij", walks, walks)
    ahead += square * np.einsum("kwi,kwj->kwij", walks[:-1], walks[1:])
    border += square * np.outer(lasting, lasting)


def doubted(
    judged: dict[int, Calibration], x: Array, told: Array, doubts: Sequence[Doubt], start: int
) -> Array:
    """What is to be added to one place's covariance, 3 × 3 (m²).

    Args:
        judged: see `scales`.
        x: the estimate, flat.
        told: columns of the covariance for these scales, size × m.
        doubts: see `suspected`.
        start: where the place is.
    """
    found = np.zeros((3, 3))
    for i, (row, known) in enumerate(judged.items()):
        across = told[start : start + 3, i]
        found += doubt(known, float(x[row]), float(told[row, i])) * np.outer(across, across)
    for one in doubts:
        moved = one.moved[start : start + 3]
        found += one.square * np.outer(moved, moved)
    return found
