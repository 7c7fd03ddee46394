"""The ranges of a solution, by the radios at their ends, and what they have in common with its unknowns."""

from typing import NamedTuple

import numpy as np

from estimator.fusion.learned.delays import Radio, reported_as
from estimator.fusion.memory.ledger import RANGE
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array, Indices
from estimator.smoothing.learning.delay_scores import cross_information, scores_by_half
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution


class Delay(NamedTuple):
    """A radio that may be off.

    Attributes:
        radio: its technology and node.
        odds: log likelihood ratio of its being off.
        bias_m: by how much its ranges then are (m).
        constant: whether they are off by the same all the time.
        off_m2: mean square of what they are off by, if it may be off or not, beyond what is usual (m²).
    """

    radio: Radio
    odds: float
    bias_m: float
    constant: bool
    off_m2: float


class RangesByRadio(NamedTuple):
    """The ranges of a window, by the radios at their ends.

    Attributes:
        radios: those that are asked.
        ranges: which of the window's rows they are, in order of epoch, m.
        carried: which of the radios are at both ends of each, m × 2; −1: one that is not asked.
        half: in which half of the time it is to each end, m × 2.
        score: of a bias of each radio in both halves, radios × 2.
        told: information on it that the ranges alone have, radios × 2.
    """

    radios: list[Radio]
    ranges: Integers
    carried: Integers
    half: Integers
    score: Array
    told: Array


def ranges_by_radio(problem: Problem, solved: Solution) -> RangesByRadio:
    """Group a solution's ranges by the radios at their ends, but for those known to have a delay."""
    rows, state = problem.rows, problem.layout.state
    ranges, nodes = np.flatnonzero(rows.pairs[:, 1] == RANGE), len(state.owners)
    ranges = ranges[np.argsort(rows.pairs[ranges, 0], kind="stable")]
    keys = rows.pairs[ranges, 6:7].astype(np.intp) * nodes + rows.pairs[ranges, 2:4].astype(np.intp)
    place = np.full(nodes * len(state.sources), -1)
    each: dict[Radio, int] = {}
    for key in np.flatnonzero(np.bincount(keys.ravel(), minlength=len(place))).tolist():
        # A node that came back, or lies elsewhere, carries the radio that it did.
        radio = reported_as(state.sources[key // nodes]), state.owners[key % nodes]
        if radio not in state.delayed:
            place[key] = each.setdefault(radio, len(each))
    weighted, carried = solved.weighted, place[keys]
    weight, residual = weighted.information[ranges], weighted.residual[ranges]
    return RangesByRadio(list(each), ranges, carried, *scores_by_half(carried, weight, residual, len(each)))


def bias_columns(problem: Problem, solved: Solution, told: RangesByRadio, radios: Indices) -> Array:
    """Cross information of all unknowns with the biases of radios in both halves of the time, n × 2 c.

    Args:
        problem: of a window, or of the whole incident.
        solved: its solution.
        told: its ranges.
        radios: which of theirs, c.
    """
    layout, ranges = problem.layout, told.ranges
    size, place = layout.length * layout.width, np.full(len(told.radios) + 1, -1)
    place[radios] = np.arange(len(radios))
    right = np.zeros((size + layout.border, 2 * len(radios)))
    rows = problem.rows.columns[ranges], problem.rows.slab[ranges], solved.linear.jacobian[ranges]
    weight = solved.weighted.information[ranges]
    cross_information(right, layout.width, size, *rows, weight, told.half, place[told.carried])
    return right
