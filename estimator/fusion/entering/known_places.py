"""What radios of known places say of whether somebody has come from the base, or was elsewhere all the time.

His readings of ten seconds are held against the way that has led him from the base, and against every place
that they allow, as if he had stood where he is now. Each hypothesis is weighed by its whole likelihood: a
place among all that a building has is a rare one (Bayes factor by Laplace's method), and an outlier is what
it costs to have one. What a wall or an echo makes of a link stays as long as its bearer is in one room
(`physics.SHARED_M`), however often it is read; and one reading may be anything.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from estimator.fusion import physics
from estimator.fusion.entering.introduce import turn_sigma
from estimator.fusion.entering.modes import (
    Mode,
    UndecidedNode,
    costs_of,
    find_modes,
    mode_at,
    residuals_of,
    short_costs,
)
from estimator.fusion.entering.rival_modes import area_m2, farthest_m, is_place
from estimator.fusion.entering.sightings import DRIFT, UNSURE_M, Sightings, of_node
from estimator.fusion.entering.technologies import path_loss_prior, ranging_sigma
from estimator.fusion.memory.late_start import LateStart
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.variable import BODY

GLITCH = 7.0
"""What one reading speaks at most against a place (log likelihood): one in a thousand may be anything."""
POWERS = 1.0
"""What powers alone speak at most for or against it: radios differ in what they send by as much as a building
makes (decision 0085)."""
INSIDE_M = 50.0
"""Who is inside is so far from the base along each axis, for all that is known."""
SECONDS = 3
"""A wild range does not repeat: in fewer seconds nothing is decided."""


class Spoken(NamedTuple):
    """What known places say of one who was taken to be at the base.

    Attributes:
        odds: by how much likelier they are if he was elsewhere (log likelihood).
        found: whether they tell a place where he may begin, and not a ring or one moment.
        reach_m: how far from where he is shown he then is, along each horizontal axis (m).
    """

    odds: float
    found: bool
    reach_m: float


def spoken(state: FusionState, node: NodeState, known: LateStart, begun_t: float) -> Spoken | None:
    """What is said of one who moves and was taken to be at the base; None: he hears no known place.

    Where his unit alone has led him from there counts: the map is bent until ranges fit, and who comes by the
    base has not begun there.

    Args:
        state: the fusion.
        node: who.
        known: what is known of it: what his unit faced, and how far it has led him.
        begun_t: since when (s).
    """
    seen = of_node(state, node, state.newest_t - physics.UNSEEN_S, _placed(state))
    if seen is None:
        return None
    faced_rad, sigma_rad = known.faced or (0.0, turn_sigma(node))
    gone_m = _gone_m(state, node, seen.t, faced_rad)
    behind_m = np.linalg.norm(gone_m, axis=1)
    on_s = state.newest_t - begun_t
    bias_rad = state.bias_sigma_radps(node) * on_s
    turned_rad = min(math.hypot(sigma_rad, bias_rad), math.pi)
    away_m = _turned(np.array([[*known.led[:2], 0.0]]), faced_rad)[0]
    led_to_m = np.array(state.base_place()) + away_m
    # A loop ends where it has begun whatever its unit faces, but not where that changes on the way.
    unsure_m = math.hypot(sigma_rad * float(np.hypot(*away_m[:2])), (bias_rad / 3.0 + DRIFT) * node.way_m)
    sought = _sought(state, seen, gone_m, behind_m * (turned_rad + DRIFT))
    modes = find_modes(sought)
    if not modes:
        return None
    sigma_m = min(math.hypot(physics.ENTRY_SIGMA_M[0], unsure_m), INSIDE_M)
    here = mode_at(sought, led_to_m[:2], sigma_m)
    noise = state.learned(state.sources[seen.source]).outliers(physics.NOISES[seen.kind][0])
    counts = _counts(seen, gone_m)
    weights = counts, noise
    entered = _cost(here, sought, weights) + here.before - math.log(area_m2(here, sigma_m) / sigma_m**2)
    most_m = min(INSIDE_M, farthest_m(seen, modes[0])) if seen.kind == RANGE else INSIDE_M
    each = np.array(
        [_cost(mode, sought, weights) - math.log(area_m2(mode, most_m) / INSIDE_M**2) for mode in modes]
    )
    inside, reach_m = _elsewhere(modes, each, most_m, state.place(node))
    best = modes[int(np.argmin(each))]
    often = len(np.unique(np.floor(seen.t))) >= SECONDS and len(seen.t) >= physics.UNSEEN_SIGHTINGS_MIN
    odds = entered - inside
    if seen.kind != RANGE:
        odds = min(max(odds, -POWERS), POWERS)
    there = best.sigma_m < physics.DECIDED_SIGMA_M[sought.kind] and is_place(seen, best)
    return Spoken(odds, often and there, reach_m)


def _elsewhere(modes: Sequence[Mode], costs: Array, most_m: float, shown_m: Array) -> tuple[float, float]:
    """What it costs to be at any of some places, and how far that is from where he is shown.

    Args:
        modes: the places, k.
        costs: what each costs by itself, k (log likelihood).
        most_m: each is no larger along an axis (m).
        shown_m: where he is shown, 3 (m).

    Returns:
        What it costs (log likelihood); how far, along each horizontal axis (m).
    """
    least = float(costs.min())
    share = np.exp(least - costs)
    off_m2 = [
        float(((mode.position_m - shown_m)[:2] ** 2).sum())
        + min(mode.sigma_m, most_m) ** 2
        + min(mode.across_m, most_m) ** 2
        for mode in modes
    ]
    reach_m = math.sqrt(0.5 * float(share @ off_m2 / share.sum()))
    return least - math.log(float(share.sum())), reach_m


def _placed(state: FusionState) -> set[int]:
    """Numbers of radios whose place does not hang on where anybody began."""
    found = set()
    for node in state.nodes.values():
        told = node.mode == "static" and node.absolute.believed_m is not None
        flies = node.role == "uav" and node.moving and node.absolute.fixes.t is not None
        if node.mode == "fixed" or told or flies:
            found.add(node.index)
    return found


def _turned(steps_m: Array, by_rad: float) -> Array:
    """Displacements of a frame that is turned, m × 3 (m)."""
    cosine, sine = math.cos(by_rad), math.sin(by_rad)
    turned: Array = steps_m @ np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return turned


def _gone_m(state: FusionState, node: NodeState, t: Array, faced_rad: float) -> Array:
    """Where he was at epochs, less where he is now, by what his unit has told, m × 3 (m)."""
    steps = state.ledger.table("steps")
    steps = steps[(steps[:, 1] == node.index) & (steps[:, 0] > t.min() - physics.MOVING_SIGHTINGS_S)]
    if not len(steps):
        return np.zeros((len(t), 3))
    way = np.concatenate([np.zeros((1, 3)), np.cumsum(_turned(steps[:, 3:6], faced_rad), axis=0)])
    marks = np.concatenate([steps[:1, 2], steps[:, 0]])
    return np.column_stack([np.interp(t, marks, way[:, axis]) - way[-1, axis] for axis in range(3)])


def _sought(state: FusionState, seen: Sightings, gone_m: Array, unsure_m: Array) -> UndecidedNode:
    """The readings as if he had stood where he is now."""
    owner = state.sources[seen.source]
    ranged = seen.kind == RANGE
    # What is learned of them by now hangs on where he was taken to begin.
    usual, unsure = ((0.0, 0.0), ranging_sigma(state, owner)) if ranged else path_loss_prior(state, owner)
    sigma = seen.sigma * state.learned(owner).factor
    if ranged:
        sigma = np.hypot(sigma, np.hypot(UNSURE_M + unsure_m, seen.spread))
    return UndecidedNode(
        kind="range" if ranged else "rssi",
        points=seen.points - gone_m,
        value=seen.value,
        sigma=sigma,
        up_m=float((seen.points - gone_m)[:, 2].mean()),
        up_sigma_m=physics.UNDECIDED_MOVING_UP_SIGMA_M,
        extra=np.array(usual[:BODY]),
        extra_covariance=np.diag(np.array(unsure[:BODY]) ** 2),
    )


def _counts(seen: Sightings, gone_m: Array) -> Array:
    """As how many readings each counts, m: those of one link and one room share their error."""
    found = np.empty(len(seen.t))
    # Who stands is told by his place; of who flies the readings of one link may be taken one by one.
    for link in np.unique(seen.link):
        mine = seen.link == link
        way_m = float(np.linalg.norm(np.diff(gone_m[mine][np.argsort(seen.t[mine])], axis=0), axis=1).sum())
        k = int(mine.sum())
        found[mine] = min(1.0 + way_m / physics.SHARED_M, float(k)) / k
    return found


def _cost(mode: Mode, sought: UndecidedNode, weights: tuple[Array, float]) -> float:
    """What readings cost at a place, outliers being what they are (log likelihood).

    Args:
        mode: the place.
        sought: what was measured.
        weights: as how many readings each counts, m; the share of outliers.
    """
    counts, outliers = weights
    ranged, m = sought.kind == "range", len(sought.value)
    usual = physics.RANGE_NOISE if ranged else physics.RSSI_NOISE
    residual = residuals_of(sought, mode.position_m, mode.extra)
    noise = np.tile((outliers, usual.shift, usual.spread), (m, 1))
    costs = costs_of(residual, sought.sigma, noise, np.full(m, ranged), np.ones(m))
    if ranged:
        costs += short_costs(residual, sought.sigma)
    off, up = mode.extra - sought.extra, (mode.position_m[2] - sought.up_m) / sought.up_sigma_m
    beforehand = 0.5 * (off @ np.linalg.solve(sought.extra_covariance, off) + up**2)
    return float(counts @ np.minimum(costs, GLITCH) + beforehand)
