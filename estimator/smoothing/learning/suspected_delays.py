"""Radios that are trusted, and may be off nevertheless: what that does to all places.

Were a radio's ranges too long by b, all unknowns would be elsewhere by −b L⁻¹ R, R = Σ w J of its ranges.
What readings say of b if it is off at all, and how likely that is, `delays` tells: the second moment about
what is shown holds both, as with a scale of the other kind (`fusion.learned.calibration.doubt`).
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from estimator.fusion.learned.delays import Radio, Suspicion, reported_as
from estimator.graph.dense import Array
from estimator.smoothing.learning.radios import Delay, RangesByRadio, bias_columns
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

NOTHING_M2 = 1e-3
"""Three centimetres are seen in no place."""


class Suspect(NamedTuple):
    """A radio that may be off.

    Attributes:
        radio: its technology and node.
        off_m2: mean square of what its ranges may be off by (m²).
        moved: by how much each unknown then is elsewhere, for each metre, flat.
    """

    radio: Radio
    off_m2: float
    moved: Array


def suspects(
    problem: Problem, solved: Solution, told: RangesByRadio, pulling: Sequence[Delay]
) -> Iterator[Suspect]:
    """Radios that may be off by what can be seen.

    Args:
        problem: of a window, or of the whole incident.
        solved: its solution, whose chain has been reduced.
        told: its ranges.
        pulling: those radios that may be off.
    """
    off_m2 = {one.radio: one.off_m2 for one in pulling if one.off_m2 > NOTHING_M2}
    number = {radio: i for i, radio in enumerate(told.radios)}
    if not off_m2:
        return
    layout = problem.layout
    size = layout.length * layout.width
    right = bias_columns(problem, solved, told, np.array([number[radio] for radio in off_m2]))
    right = right[:, ::2] + right[:, 1::2]
    of_keyframes = right[:size].reshape(layout.length, layout.width, right.shape[1])
    moved, fixed = solved.chain.response(of_keyframes, right[size:])
    moved = moved.reshape(size, right.shape[1])
    for i, (radio, square) in enumerate(off_m2.items()):
        yield Suspect(radio, square, -np.concatenate([moved[:, i], fixed[:, i]]))


def suspicions(
    problem: Problem, solved: Solution, told: RangesByRadio, pulling: Sequence[Delay]
) -> dict[Radio, Suspicion]:
    """What the filter is to know of the radios of who moves: how their delays go through the technologies.

    Args:
        problem: of a window.
        solved: its solution, whose chain has been reduced.
        told: its ranges.
        pulling: those radios that may be off, and are trusted.
    """
    layout = problem.layout
    state, size = layout.state, layout.length * layout.width
    sources = problem.rows.pairs[told.ranges, 6].astype(np.intp)
    moving = [one for one in pulling if state.nodes[one.radio[1]].moving]
    found = {}
    for suspect in suspects(problem, solved, told, moving):
        technology, root = suspect.radio[0], math.sqrt(suspect.off_m2)
        carried = (told.carried == told.radios.index(suspect.radio)).any(axis=1)
        off, alike = {}, np.zeros(len(sources), dtype=bool)
        for (kind, source), start in layout.technologies.items():
            name = state.sources[source]
            if kind == "range" and reported_as(name) == technology:
                scale, bias_m = suspect.moved[size + start : size + start + 2].tolist()
                mine = sources == source
                off[name] = root * scale, root * (bias_m + bool(carried[mine].any()))
                alike |= mine
        found[suspect.radio] = Suspicion(off, bool(carried[alike].all()))
    return found
