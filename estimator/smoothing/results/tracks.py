"""A solved window as tracks: a point at each whole second of every node's life."""

import math
from collections.abc import Mapping

import numpy as np

from estimator.estimate import TrackPoint
from estimator.fusion.entering.introduce import NO_PRIOR_SIGMA_M, tuple_of, upper_triangle
from estimator.fusion.motion.constant_velocity import free_motion
from estimator.fusion.physics import BESIDE_M
from estimator.graph.dense import Array
from estimator.smoothing.keyframes.layout import Layout, Walk
from estimator.smoothing.keyframes.walks import dead_reckon

Lifetimes = Mapping[str, tuple[float, float]]


def tracks(
    layout: Layout, x: Array, keyframes: Array, ahead: Array, border: Array, lifetimes: Lifetimes
) -> dict[str, list[TrackPoint]]:
    """Every placed node's track.

    Args:
        layout: of the window.
        x: its estimate, flat.
        keyframes: covariance of each walk at each keyframe, k × walks × 6 × 6.
        ahead: of each with itself at the next keyframe, (k − 1) × walks × 6 × 6.
        border: covariance of the border, s × s.
        lifetimes: first and last epoch of each node's readings (s).
    """
    found: dict[str, list[TrackPoint]] = {}
    for i, walk in enumerate(layout.walks):
        # Who has come back has a walk for each time that he was in.
        before = found.get(walk.node.node, [])
        found[walk.node.node] = before + _moving_points(layout, walk, i, x, (keyframes, ahead), lifetimes)
    size = layout.length * layout.width
    stands = layout.state.ledger.table("stands")
    drops = {int(row[1]): float(row[0]) for row in layout.state.ledger.table("drops")}
    lay = _lying_spans(layout, drops)
    for row in stands:
        number = int(row[1])
        node, name, start = layout.state.life(number), layout.state.owners[number], layout.stands[number]
        place = tuple_of(x[size + start : size + start + 3])
        told = border[start : start + 3, start : start + 3].copy()
        told[2, 2] = max(told[2, 2], node.doubt_up_m2)
        covariance = upper_triangle(told)
        first, last = lifetimes[name]
        since = max(drops.get(number, first), first) if name in found or number in drops else first
        came_t, left_t = lay.get(number, (-math.inf, math.inf))
        if node.index == number and node.mode == "retired":
            left_t = min(left_t, math.floor(node.t) + 1.0)
        since = max(since, came_t)
        others = found.get(name, [])
        stood = [
            TrackPoint(t=float(t), position_m=place, covariance_m2=covariance)
            for t in range(math.ceil(min(since, last + 1.0)), math.floor(last) + 1)
            if t < left_t
        ]
        found[name] = [*(p for p in others if p.t < since), *stood, *(p for p in others if p.t >= left_t)]
    for node in layout.state.nodes.values():
        if node.role == "base" and node.place_m is not None:
            first, last = lifetimes[node.node]
            found[node.node] = [
                TrackPoint(t=float(t), position_m=node.place_m, covariance_m2=(0.0,) * 6)
                for t in range(math.ceil(first), math.floor(last) + 1)
            ]
    return {name: points for name, points in found.items() if points}


def _lying_spans(layout: Layout, drops: Mapping[int, float]) -> dict[int, tuple[float, float]]:
    """First and last epoch for which each number of a standing node in the ledger holds (s).

    Args:
        layout: of the window.
        drops: epochs of drops, by number (s).
    """
    ledger, owners = layout.state.ledger, layout.state.owners
    pairs = ledger.table("pairs")
    # Where a gateway has put it, and since when it walks: no reading need tell of these.
    told = {int(row[1]): float(row[0]) for row in ledger.table("stands") if row[5] < NO_PRIOR_SIGMA_M}
    told |= {int(row[1]): float(row[0]) for row in ledger.table("begins")[::-1]}
    stood = {*ledger.table("stands")[:, 1].tolist(), *np.unique(pairs[:, 2:4]).tolist(), *told}
    found: dict[int, tuple[float, float]] = {}
    last_of: dict[str, int] = {}
    for number, name in enumerate(owners):
        if name in last_of and number not in stood:
            # That it lay elsewhere was taken back.
            continue
        if name in last_of:
            own = pairs[(pairs[:, 2] == number) | (pairs[:, 3] == number), 0]
            moved_t = drops.get(number, float(own.min()) if len(own) else math.inf)
            moved_t = min(moved_t, told.get(number, math.inf))
            before = last_of[name]
            found[before] = found.get(before, (-math.inf, math.inf))[0], moved_t
            found[number] = moved_t, math.inf
        last_of[name] = number
    return found


def _moving_points(
    layout: Layout,
    walk: Walk,
    index: int,
    x: Array,
    covariances: tuple[Array, Array],
    lifetimes: Lifetimes,
) -> list[TrackPoint]:
    """Track points of a moving node: dead reckoned between keyframes, corrected to meet the later one."""
    first, last = lifetimes[walk.node.node]
    if walk.node.mode == "retired":
        last = min(last, walk.node.t)
    times = layout.times[:, index]
    seconds = np.arange(math.ceil(first), math.floor(last) + 1, dtype=np.float64)
    seconds = seconds[seconds >= times[walk.first] - 1e-6]
    if len(seconds) == 0:
        return []
    states = layout.states(x, index)
    at = np.clip(np.searchsorted(layout.grid, seconds, side="right") - 1, walk.first, walk.last)
    after = np.minimum(at + 1, walk.last)
    since, until = times[at], np.maximum(times[after], seconds)
    span = np.maximum(until - since, 1e-9)
    share = np.clip((seconds - since) / span, 0.0, 1.0)
    share[after == at] = 0.0
    places, _ = _dead_reckoned(walk, states[at], since, np.maximum(seconds, since))
    led_to, noise = _dead_reckoned(walk, states[at], since, until)
    places += np.where((after > at)[:, None], share[:, None] * (states[after, :3] - led_to), 0.0)
    part = share[:, None, None]
    keyframes, ahead = covariances
    position = keyframes[:, index, :3, :3]
    both = np.zeros_like(position[at])
    between = after > at
    both[between] = ahead[at[between], index, :3, :3]
    apart = position[at] + position[after] - both - both.transpose(0, 2, 1)
    apart[~between] = 0.0
    covariance = (1.0 - part) * position[at] + part * position[after] - part * (1.0 - part) * apart
    beyond = np.where(between, share * (1.0 - share), 1.0)
    covariance[:, range(3), range(3)] += noise * beyond[:, None]
    if walk.way is not None:
        bridged = walk.way.bridged(seconds)
        covariance[:, range(3), range(3)] += bridged[:, None] * np.array([1.0, 1.0, 0.1])
        doubt_m2 = walk.node.doubt_up_m2 * walk.way.gone(seconds)
        covariance[:, 2, 2] = np.maximum(covariance[:, 2, 2], doubt_m2)
        covariance[:, range(2), range(2)] += walk.node.raw * BESIDE_M**2
    return [
        TrackPoint(t=t, position_m=tuple_of(p), covariance_m2=upper_triangle(c))
        for t, p, c in zip(seconds.tolist(), places, covariance, strict=True)
    ]


def _dead_reckoned(walk: Walk, states: Array, since: Array, until: Array) -> tuple[Array, Array]:
    """Dead reckoned places from states, m × 3 (m), and the variances that this adds, m × 3 (m²)."""
    durations = until - since
    if walk.way is not None:
        parts = walk.way.between(since, until)
        after, _ = dead_reckon(states, parts[:, :3], parts[:, 3:6], durations)
        return after[:, :3], parts[:, [6, 6, 7]]
    moved = {d: free_motion(walk.node.role, d) for d in set(durations.tolist())}
    led = np.array([moved[d][0][:3] @ s for d, s in zip(durations.tolist(), states, strict=True)])
    noise = np.array([np.diag(moved[d][1])[:3] for d in durations.tolist()])
    return led, noise
