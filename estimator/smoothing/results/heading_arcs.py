"""What headings that are hardly known do to places of a solved chain: see `fusion.motion.heading_arcs`."""

from collections.abc import Sequence

import numpy as np

from estimator.fusion.motion.heading_arcs import LOOSE_RAD, arcs_ahead_m2, arcs_m2, swung_m2
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import HEADING, PLACES, STATES
from estimator.smoothing.problem.solution import Solution


def responses(layout: Layout, solved: Solution, columns: Sequence[int]) -> Array:
    """Columns of a solution's covariance, size × m.

    Args:
        layout: of the chain.
        solved: its solution, whose chain is solved.
        columns: which of its numbers, flat, m.
    """
    size, count = layout.length * layout.width, len(columns)
    unit = np.zeros((size + layout.border, count))
    unit[list(columns), range(count)] = 1.0
    moved, fixed = solved.chain.response(unit[:size].reshape(layout.length, layout.width, count), unit[size:])
    return np.concatenate([moved.reshape(size, count), fixed])


def last_headings(layout: Layout) -> list[int]:
    """Where the last headings of all units are in an estimate, flat."""
    return [
        walk.last * layout.width + STATES * i + HEADING
        for i, walk in enumerate(layout.walks)
        if walk.way is not None
    ]


def widen_by_arcs(layout: Layout, solved: Solution, found: tuple[Array, Array, Array]) -> None:
    """Widen covariances of places from the tangent of a hardly known heading to its arc, in place.

    Args:
        layout: of the chain.
        solved: its solution, whose chain is solved.
        found: covariances of the keyframes, of each with the next one and of the border, as
            `Chain.covariances` gives them; changed in place.
    """
    keyframes, ahead, border = found
    loose = []
    for i, walk in enumerate(layout.walks):
        variance = np.where(keyframes[:, i, 3, 3] > LOOSE_RAD**2, keyframes[:, i, 3, 3], 0.0)
        if walk.way is None or not variance.any():
            continue
        if variance[walk.last] > 0.0:
            loose.append(walk.last * layout.width + STATES * i + HEADING)
        across, known = keyframes[:, i, :PLACES, HEADING].copy(), slice(HEADING + 1)
        keyframes[:, i, :PLACES, :PLACES] += arcs_m2(across, variance)
        ahead[:, i, :PLACES, :PLACES] += arcs_ahead_m2(across[:, :2], variance, ahead[:, i, known, known])
    if loose and layout.stands:
        size = layout.length * layout.width
        told = responses(layout, solved, loose)
        for start in layout.stands.values():
            own = slice(start, start + PLACES)
            border[own, own] += arc_excess_m2(told, loose, size + start)


def arc_excess_m2(told: Array, headings: Sequence[int], start: int) -> Array:
    """The arc's second moment less the tangent's, for one place, 3 × 3 (m²).

    Args:
        told: columns of the covariance for headings, size × m.
        headings: where these are, flat, m.
        start: where the place is.
    """
    variance = np.array([told[row, column] for column, row in enumerate(headings)])
    loose = np.flatnonzero(variance > LOOSE_RAD**2)
    return np.asarray(swung_m2(told[None, start : start + PLACES][:, :, loose], variance[loose])[0])
