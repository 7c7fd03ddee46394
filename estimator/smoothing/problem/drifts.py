"""What lasts, but not for ever: what altimeters and receivers are off by moves on after a prior was made."""

import math

import numpy as np

from estimator.fusion import physics
from estimator.fusion.learned.receivers import OFFSET_NUMBERS
from estimator.fusion.memory.prior import SIZES, Prior
from estimator.smoothing.keyframes.layout import Layout

OLDEST = 1.0 / 6.0
"""Share of a window that goes when it has become long."""


def drifted(prior: Prior, layout: Layout) -> Prior:
    """A prior with altimeters and receivers that have moved on since.

    In a window each is off by one number all along. By as much as the window has grown since its oldest
    keyframes went, as many seconds will go with the next ones. An altimeter's offset walks; a receiver's
    forgets what it was, x' = ρ x + w, and is as large as ever (Ornstein, Uhlenbeck).

    Args:
        prior: what is known from before.
        layout: of the window.
    """
    passed_s = OLDEST * float(layout.grid[-1] - layout.grid[0])
    rows, kept, walked = list[int](), list[float](), list[float]()
    forgets, start = math.exp(-passed_s / physics.RECEIVER_MEMORY_S), 0
    walked_m2 = physics.HEIGHT_WALK_M_PER_ROOT_S**2 * passed_s
    for kind, number in prior.keys:
        if kind == "altimeter" and walked_m2 > 0.0:
            rows.append(start)
            kept.append(1.0)
            walked.append(walked_m2)
        elif kind == "receiver" and forgets < 1.0:
            known = layout.state.receivers[layout.state.sources[number]]
            rows += range(start, start + OFFSET_NUMBERS)
            kept += [forgets] * OFFSET_NUMBERS
            walked += [(1.0 - forgets**2) * sigma**2 for sigma in known.sigma[:OFFSET_NUMBERS]]
        start += SIZES[kind]
    if not rows:
        return prior
    matrix, vector, reference = prior.matrix.copy(), prior.vector.copy(), prior.reference.copy()
    if min(kept) < 1.0:
        matrix[rows] /= np.array(kept)[:, None]
        matrix[:, rows] /= np.array(kept)
        vector[rows] /= kept
        reference[rows] *= kept
    own = matrix[np.ix_(rows, rows)] + np.diag(1.0 / np.array(walked))
    gain = np.linalg.solve(own, matrix[rows])
    matrix -= matrix[:, rows] @ gain
    vector -= gain.T @ vector[rows]
    return prior._replace(matrix=0.5 * (matrix + matrix.T), vector=vector, reference=reference)
