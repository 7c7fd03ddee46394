"""What it does to the places of a solved chain that a ranging technology may be calibrated, or not."""

import numpy as np
from msgspec.structs import replace

from estimator.fusion.learned.calibration import Calibration, doubt
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout
from estimator.smoothing.keyframes.walks import STATES
from estimator.smoothing.problem.solved import Solved
from estimator.smoothing.results.swung import responses


def scales(layout: Layout) -> dict[int, Calibration]:
    """What is thought of scales of ranging technologies, by where they are in an estimate, flat."""
    state, size = layout.state, layout.length * layout.width
    found = {}
    for (kind, source), start in layout.technologies.items():
        name = state.sources[source]
        known = state.calibrations.get(name) if kind == "range" else None
        if known is not None:
            # Each solution of the whole incident has a prior of its own.
            narrow, assumed = state.narrow_sigma(name), state.range_scale_sigma(name)
            found[size + start] = replace(known, narrow=narrow, assumed=assumed)
    return found


def doubt_scales(layout: Layout, solved: Solved, found: tuple[Array, Array, Array]) -> None:
    """Let covariances hold that ranging technologies may be of the other kind than they were taken for.

    Args:
        layout: of the chain.
        solved: its solution, whose chain is solved.
        found: covariances of the keyframes, of each with the next one and of the border, as
            `Chain.covariances` gives them; changed in place.
    """
    keyframes, ahead, border = found
    size, judged = layout.length * layout.width, scales(layout)
    across = responses(layout, solved, list(judged))
    for i, (row, known) in enumerate(judged.items()):
        factor = doubt(known, float(solved.x[row]), float(across[row, i]))
        moved, lasting = across[:size, i].reshape(layout.length, -1, STATES), across[size:, i]
        keyframes += factor * np.einsum("kwi,kwj->kwij", moved, moved)
        ahead += factor * np.einsum("kwi,kwj->kwij", moved[:-1], moved[1:])
        border += factor * np.outer(lasting, lasting)


def doubted(judged: dict[int, Calibration], x: Array, told: Array, start: int) -> Array:
    """What is to be added to one place's covariance, 3 × 3 (m²).

    Args:
        judged: see `scales`.
        x: the estimate, flat.
        told: columns of the covariance for these scales, size × m.
        start: where the place is.
    """
    found = np.zeros((3, 3))
    for i, (row, known) in enumerate(judged.items()):
        across = told[start : start + 3, i]
        found += doubt(known, float(x[row]), float(told[row, i])) * np.outer(across, across)
    return found
