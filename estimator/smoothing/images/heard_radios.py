"""What somebody has heard of radios that stand, and which images of his way that contradicts."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimator.fusion import physics
from estimator.fusion.images import Image
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.graph.chain_kernels import Integers
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Walk
from estimator.smoothing.problem.newton import Problem
from estimator.smoothing.problem.solution import Solution

FIX = physics.NOISES.index(physics.FIX_NOISE)
RADIOS = 2
"""Radios whose symmetries are asked about: those that tell most of where somebody is."""
MAST_M = 0.5
"""Two radios on one mast, one above the other, are on no line on whose sides somebody may be."""
SLACK_M, SLACK_DB = 0.5, 4.0
"""What the rest of a way may bend by, so that readings fit an image of it."""
CONTRADICTED, MOST = 1.0, 4.0
"""Mean cost of a reading, in log likelihood, that contradicts an image, and what one costs at most."""
NEAR_M = 0.3


class HeardRadios(NamedTuple):
    """Readings of one walk to radios that stand, and its fixes, as ranges of nil to where they say, m.

    Attributes:
        t: epoch of each (s).
        slab: its keyframe.
        here_m: where he was, m × 2.
        radio_m: where the radio is, m × 2.
        ranged: whether it is a range; else a signal's power.
        sigma: its standard deviation (m or dB).
        radio: number of the radio; −1: it is a fix.
        told: what it tells of where he was, if it is of a radio.
    """

    t: Array
    slab: Integers
    here_m: Array
    radio_m: Array
    ranged: NDArray[np.bool_]
    sigma: Array
    radio: Integers
    told: Array

    def some(self, chosen: NDArray[np.bool_]) -> "HeardRadios":
        """Some of them."""
        t, slab, here_m, radio_m, ranged, sigma, radio, told = self
        return HeardRadios(
            t[chosen],
            slab[chosen],
            here_m[chosen],
            radio_m[chosen],
            ranged[chosen],
            sigma[chosen],
            radio[chosen],
            told[chosen],
        )

    def contradicts(self, image: Image) -> bool:
        """Whether they do not fit where an image would have put him; as nothing, they fit nowhere."""
        was = np.maximum(np.hypot(*(self.here_m - self.radio_m).T), NEAR_M)
        now = np.maximum(np.hypot(*(image.of(self.here_m) - self.radio_m).T), NEAR_M)
        off = np.where(self.ranged, now - was, 20.0 * np.log10(now / was))
        sigma = np.hypot(self.sigma, np.where(self.ranged, SLACK_M, SLACK_DB))
        cost = np.minimum(0.5 * (off / sigma) ** 2, MOST)
        return not len(cost) or bool(cost.mean() > CONTRADICTED)


def heard_by(problem: Problem, solved: Solution, walk: Walk) -> HeardRadios:
    """What a walk has heard of radios that stand."""
    rows, m = problem.rows, len(problem.rows.pairs)
    (a_m, b_m), (a_stands, b_stands) = rows.places(solved.x), rows.standing
    first = (rows.pairs[:, 2] == walk.number) & b_stands
    second = (rows.pairs[:, 3] == walk.number) & a_stands
    at = np.flatnonzero((first | second) & (rows.pairs[:, 1] <= RSSI))
    mine, jacobian = first[at][:, None], solved.linear.jacobian[at]
    slope = np.where(mine, jacobian[:, :2], jacobian[:, 6:8])
    seen = HeardRadios(
        rows.t[at],
        rows.slab[at],
        np.where(mine, a_m[at, :2], b_m[at, :2]),
        np.where(mine, b_m[at, :2], a_m[at, :2]),
        rows.pairs[at, 1] == RANGE,
        rows.sigma[at],
        np.where(first[at], rows.pairs[at, 3], rows.pairs[at, 2]).astype(np.int64),
        solved.weighted.information[:m][at] * (slope**2).sum(axis=1),
    )
    fixes = _fixes(problem, solved, walk)
    return HeardRadios(*(np.concatenate(both) for both in zip(seen, fixes, strict=True)))


def _fixes(problem: Problem, solved: Solution, walk: Walk) -> HeardRadios:
    """A walk's fixes, each of whose three rows follow each other."""
    rows, m = problem.rows, len(problem.rows.pairs)
    own = (rows.singles[:, 1] == walk.number) & (rows.singles[:, 5] == FIX)
    east = np.flatnonzero(own & (rows.singles[:, 2] == 0.0))
    here_m = np.stack([rows.singles[east, 3], rows.singles[east + 1, 3]], axis=1)
    off_m = np.stack([solved.linear.residual[m + east], solved.linear.residual[m + east + 1]], axis=1)
    return HeardRadios(
        rows.t[m + east],
        rows.slab[m + east],
        here_m - off_m,
        here_m,
        np.ones(len(east), dtype=bool),
        rows.sigma[m + east],
        np.full(len(east), -1),
        np.zeros(len(east)),
    )


def radios_of(heard: HeardRadios) -> list[Array]:
    """Where those radios are that tell most of where somebody is, each apart from the others (m)."""
    numbers, first, index = np.unique(heard.radio, return_index=True, return_inverse=True)
    told = np.bincount(index, heard.told, len(numbers))
    found: list[Array] = []
    for k in np.argsort(-told, kind="stable").tolist():
        at_m = heard.radio_m[first[k]]
        apart = all(np.hypot(*(at_m - other_m)) > MAST_M for other_m in found)
        if told[k] > 0.0 and apart and len(found) < RADIOS:
            found.append(at_m)
    return found
