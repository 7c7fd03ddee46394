"""Solutions in which those whom signals alone locate are among the radios that they hear best.

What a power tells of a distance depends on the path loss, which is learned along: far outside of all radios
somebody may fit as well, with another P0, as among them. No turn or reflection leads from one to the other.
The centroid of the radios, weighted by their powers, needs no P0 (Blumenthal et al. 2007, "Weighted Centroid
Localization in Zigbee-based Sensor Networks").
"""

from typing import NamedTuple

import numpy as np

from estimator.fusion.images import Image
from estimator.fusion.memory.ledger import RSSI
from estimator.graph.dense import Array
from estimator.measurements.rssi import DB_PER_NEPER
from estimator.smoothing.images.alternatives import Mode, same_place
from estimator.smoothing.images.earlier_images import CLEARER, LEAST
from estimator.smoothing.images.heard_radios import FIX
from estimator.smoothing.images.local_solution import local_solution
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.problem.newton import METRES_OFF, Problem
from estimator.smoothing.problem.solution import Solution

RADIOS = 3
"""What fewer radios leave open are images."""
NEAR_S = 3.0
"""Signals fade and come back: for about so long somebody is near the radios that he has heard best."""
FREE_SPACE = 2.0
"""Powers weigh as the inverse of a distance does by this exponent."""


class _Powers(NamedTuple):
    """What somebody has heard of radios that stand.

    Attributes:
        t: epochs, m (s).
        radio_m: where the radio of each is, m × 2 (m).
        dbm: powers, m (dBm).
    """

    t: Array
    radio_m: Array
    dbm: Array


def starts_near_radios(problem: Problem, solved: Solution, whole: bool) -> tuple[Solution, list[Mode]]:
    """The likelier of a solution and the one with everybody whom signals alone locate among the radios.

    Args:
        problem: of a window.
        solved: a solution of it.
        whole: what differs at any time is another solution, not only what differs now.

    Returns:
        The likelier one, and the other one if it is not much less likely.
    """
    layout, there = problem.layout, solved.x.copy()
    moved = [i for i, walk in enumerate(layout.walks) if _put_among(problem, solved, i, walk, there)]
    if not moved:
        return solved, []
    other = local_solution(problem, there, METRES_OFF, solved)
    if other is None:
        return solved, []
    best, less = (other, solved) if other.cost < solved.cost - CLEARER else (solved, other)
    odds = float(np.exp(best.cost - less.cost))
    apart = [i for i in moved if not _same(layout, best.x, less.x, i, whole)]
    if odds < LEAST or not apart:
        return best, []
    images = {layout.walks[i].number: _now(layout, best.x, less.x, i) for i in moved}
    first = layout.walks[apart[0]]
    since_t = float(layout.times[first.first, apart[0]])
    mode = Mode(first.number, odds / (1.0 + odds), less.x, since_t, images[first.number], images)
    return best, [mode]


def _put_among(problem: Problem, solved: Solution, index: int, walk: Walk, x: Array) -> bool:
    """Put a walk that signals alone locate among the radios that it has heard best, in place."""
    if walk.way is not None or not walk.node.moving:
        return False
    powers = _heard(problem, solved, walk)
    if powers is None:
        return False
    layout = problem.layout
    own = slice(walk.first, walk.last + 1)
    states = layout.states(x, index)[own]
    states[:, :2] = centroids(powers.t, powers.radio_m, powers.dbm, layout.times[own, index])
    states[:, 3:5] = 0.0
    return True


def _heard(problem: Problem, solved: Solution, walk: Walk) -> _Powers | None:
    """What a walk has heard of radios that stand; None: too little, or other readings locate it."""
    rows = problem.rows
    pairs, singles = rows.pairs, rows.singles
    own = (pairs[:, 2] == walk.number) | (pairs[:, 3] == walk.number)
    if (pairs[own, 1] != RSSI).any() or ((singles[:, 1] == walk.number) & (singles[:, 5] == FIX)).any():
        return None
    (a_m, b_m), (a_stands, b_stands) = rows.places(solved.x), rows.standing
    first = pairs[:, 2] == walk.number
    at = np.flatnonzero(own & np.where(first, b_stands, a_stands))
    if len(np.unique(np.where(first, pairs[:, 3], pairs[:, 2])[at])) < RADIOS:
        return None
    return _Powers(rows.t[at], np.where(first[at, None], b_m[at, :2], a_m[at, :2]), pairs[at, 4])


def centroids(t: Array, radio_m: Array, dbm: Array, times: Array) -> Array:
    """The centroids of radios, weighted by their powers and by how near in time they were heard, k × 2 (m).

    Args:
        t: epochs, m (s).
        radio_m: where the radio is, m × 2 (m).
        dbm: powers, m (dBm).
        times: for which epochs, k (s).
    """
    found = np.empty((len(times), 2))
    for k, time in enumerate(times.tolist()):
        log_weight = dbm / (FREE_SPACE * DB_PER_NEPER) - np.abs(t - time) / NEAR_S
        weight = np.exp(log_weight - log_weight.max())
        found[k] = weight @ radio_m / weight.sum()
    return found


def _same(layout: Layout, one: Array, other: Array, index: int, whole: bool) -> bool:
    walk = layout.walks[index]
    asked = slice(walk.first if whole else walk.last, walk.last + 1)
    return same_place(*(layout.states(x, index)[asked, :2] for x in (one, other)))


def _now(layout: Layout, here: Array, there: Array, index: int) -> Image:
    """The move that leads from where somebody is now in one estimate to where he is in another."""
    last = layout.walks[index].last
    return Image().through(*(layout.states(x, index)[last, :2] for x in (here, there)))
