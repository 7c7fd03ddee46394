"""Where an undecided node is: every place that its sightings allow, and whether one is clearly the best.

A range-only node starts as a ring, and after a straight path as two mirror images.
It enters the graph only once the second mode is clearly worse; the window is then solved again with all its
sightings, each used once. Who moves cannot wait for that: what is older tells ever less of where he is now.
After some seconds he is shown at the best mode, and the others are told as images of it (decision 0026).
"""

import math
from typing import Literal, NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.base_entry import BasePrior, prior_at_base, turned_since
from estimator.fusion.entering.introduce import NO_PRIOR_SIGMA_M, Entry, place
from estimator.fusion.entering.modes import (
    Mode,
    UndecidedNode,
    find_modes,
)
from estimator.fusion.entering.rival_modes import farthest_m, is_place, others_of, with_entry
from estimator.fusion.entering.sightings import Sightings, heard_between, of_node
from estimator.fusion.entering.technologies import path_loss_states, technology_states
from estimator.fusion.images import Alternative, mirrored
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.silence import gone_m2
from estimator.graph.dense import Array
from estimator.graph.variable import BODY
from estimator.measurements.node import MOVING_ROLES

ENTRY_SIGHTINGS_MIN = 3
"""So many readings tell whether somebody enters at the base: it takes less than to find him anywhere."""


class ChosenMode(NamedTuple):
    """A beginning.

    Attributes:
        mode: where.
        others: the places that fit as well.
        sure: it is decided.
        up_m: mean of the height prior behind it (m).
        up_sigma_m: standard deviation of that (m).
        entry: where he has come in, if that explains what was measured.
    """

    mode: Mode
    others: list[Mode]
    sure: bool
    up_m: float
    up_sigma_m: float
    entry: BasePrior | None = None


def decide(state: FusionState, sightings_s: float = physics.SIGHTINGS_S) -> None:
    """Try undecided nodes that have been seen anew, and begin those whose position is decided.

    Who moves is begun where he may be when he has been heard for `physics.UNSEEN_S`, decided or not.

    Args:
        state: the fusion, changed in place.
        sightings_s: how old sightings of a standing node may be (s).
    """
    covariance: Array | None = None
    for name, seen in list(state.sightings.items()):
        node = state.nodes[name]
        if node.mode != "undecided":
            del state.sightings[name]
            continue
        moving = node.role in MOVING_ROLES
        tried = state.tried.get(name, 0)
        often = seen >= max(physics.SIGHTINGS_MIN, min(tried + 10, 1.2 * tried))
        since_t, until_t = heard_between(state, node) if moving else (0.0, 0.0)
        late = until_t - since_t >= physics.UNSEEN_S
        entry = prior_at_base(state, node, until_t) if moving else None
        entering = entry is not None and seen > tried
        if not often and not late and not entering:
            continue
        state.tried[name] = seen
        kept_s = sightings_s
        if moving:
            kept_s = physics.UNSEEN_S if late else physics.MOVING_SIGHTINGS_S
        sightings = of_node(state, node, state.newest_t - kept_s)
        least = physics.UNSEEN_SIGHTINGS_MIN if late else physics.SIGHTINGS_MIN
        least = least if entry is None else ENTRY_SIGHTINGS_MIN
        if sightings is None or len(sightings.t) < least:
            continue
        owner = state.sources[sightings.source]
        ranged = sightings.kind == RANGE
        states = technology_states(state, owner) if ranged else path_loss_states(state, owner)
        if covariance is None or len(covariance) != state.graph.size:
            covariance = state.graph.covariance()
        # What bodies do is little against how unsure a place is that is to be decided.
        own = slice(state.graph.starts[states], state.graph.starts[states] + BODY)
        extra, extra_covariance = state.graph.value(states)[:BODY].copy(), covariance[own, own]
        chosen = _choose(state, node, sightings, extra, extra_covariance, late, entry)
        if chosen is not None and (chosen.sure or (late and is_place(sightings, chosen.mode))):
            _begin(state, node, sightings, chosen, since_t)
            covariance = None


def _choose(
    state: FusionState,
    node: NodeState,
    seen: Sightings,
    extra: Array,
    extra_covariance: Array,
    late: bool,
    entry: BasePrior | None,
) -> ChosenMode | None:
    """Where a node may begin; None where no place fits, or the best one is too unsure to begin at.

    Args:
        state: the fusion.
        node: the node.
        seen: its sightings.
        extra: states of their technology, 2.
        extra_covariance: of these, 2 × 2.
        late: it begins at the best place, however unsure that is.
        entry: what is known of it if it may just have entered at the base.
    """
    moving = node.role in MOVING_ROLES
    sigma = seen.sigma * state.learned(state.sources[seen.source]).factor
    spread = seen.spread
    if moving:
        spread = np.hypot(spread, _walked_m(node, seen.t.max() - seen.t))
    if seen.kind == RANGE:
        sigma = np.hypot(sigma, spread)
    elif moving:
        sigma = np.hypot(sigma, spread * _db_per_m(seen.value, extra))
    up_sigma = physics.UNDECIDED_MOVING_UP_SIGMA_M if moving else physics.UNDECIDED_UP_SIGMA_M
    kind: Literal["range", "rssi"] = "range" if seen.kind == RANGE else "rssi"
    sought = UndecidedNode(
        kind=kind,
        points=seen.points,
        value=seen.value,
        sigma=sigma,
        up_m=float(seen.points[:, 2].mean()),
        up_sigma_m=up_sigma,
        extra=extra,
        extra_covariance=extra_covariance,
    )
    least_m = physics.DECIDED_SIGMA_M[kind]
    modes = find_modes(sought, math.inf if late else least_m)
    outliers = state.learned(state.sources[seen.source]).outliers(physics.NOISES[seen.kind][0])
    if modes and entry is not None:
        all_modes = with_entry(modes, seen, sought, entry)
        if all_modes[0] is not modes[0]:
            others = others_of(all_modes, sought, seen.alike, outliers)
            # Of a whole region in which he may be instead no image tells.
            known = all(mode.sigma_m <= least_m for mode in others) and (late or not others)
            beside = farthest_m(seen, all_modes[0]) <= physics.ENTRY_SIGMA_M[0]
            if known and (beside or is_place(seen, all_modes[0])):
                return ChosenMode(all_modes[0], others, not others, entry.place_m[2], up_sigma, entry)
    if len(seen.t) < (physics.UNSEEN_SIGHTINGS_MIN if late else physics.SIGHTINGS_MIN):
        return None
    decided = bool(modes) and modes[0].sigma_m <= least_m
    if not (decided or (modes and late)):
        return None
    others = others_of(modes, sought, seen.alike, outliers)
    return ChosenMode(modes[0], others, decided and not others, sought.up_m, up_sigma)


def _walked_m(node: NodeState, s: Array) -> Array:
    """How far along each axis one may walk in times, m (m)."""
    speed_mps, memory_s = physics.SPEED_SIGMA_MPS[node.role][0], physics.SPEED_MEMORY_S[node.role]
    return np.sqrt([gone_m2(speed_mps, memory_s, each_s, 0.0) for each_s in s.tolist()])


def _db_per_m(dbm: Array, path_loss: Array) -> Array:
    """By how much powers change with the distance, where they seem to come from, m (dB/m)."""
    exponent = max(float(path_loss[1]), 1.0)
    distance_m = 10.0 ** np.clip((path_loss[0] - dbm) / (10.0 * exponent), 0.0, 2.5)
    return np.asarray(10.0 * exponent / np.log(10.0) / distance_m)


def _begin(state: FusionState, node: NodeState, seen: Sightings, chosen: ChosenMode, since_t: float) -> None:
    mode = chosen.mode
    t = float(seen.t.max())
    state.due = True
    state.count("fused", len(seen.t))
    here = (float(mode.position_m[0]), float(mode.position_m[1]), chosen.up_m)
    if node.role not in MOVING_ROLES:
        place(state, node, t, here, (NO_PRIOR_SIGMA_M, NO_PRIOR_SIGMA_M, chosen.up_sigma_m))
        return
    # Until the window is solved, which is at once, what the sightings tell stands in the filter.
    far_m = farthest_m(seen, mode)
    if seen.kind == RANGE:
        # On a ring nobody is farther from its radio than its radius.
        reach_m = far_m + float(_walked_m(node, np.array([t - since_t]))[0])
    else:
        reach_m = max(physics.REACH_M, far_m)
    centre = (*seen.points[:, :2].mean(axis=0).tolist(), chosen.up_m)
    entered = Entry(since_t, centre, (reach_m, reach_m, chosen.up_sigma_m))
    if chosen.entry is not None:
        came = chosen.entry
        node = replace(node, absolute=replace(node.absolute, beginning="assumed"))
        entered = Entry(since_t, came.place_m, (came.sigma_m, came.sigma_m, chosen.up_sigma_m))
    else:
        node = replace(node, heading_sigma_rad=turned_since(state, node, t))
    sigma_m = min(mode.sigma_m, reach_m)
    since_t = since_t if state.window_t is None else max(float(np.floor(since_t)), state.window_t)
    place(
        state,
        replace(node, otherwise=_otherwise(node, chosen, since_t)),
        t,
        mode.position_m,
        (sigma_m, sigma_m, mode.up_sigma_m),
        entered,
    )


def _otherwise(node: NodeState, chosen: ChosenMode, since_t: float) -> tuple[Alternative, ...]:
    """The other modes as images of the best one, in the line that is as far from both."""
    best = chosen.mode
    odds = [float(np.exp(best.cost - mode.cost)) for mode in chosen.others]
    total, found = 1.0 + sum(odds), []
    for mode, each in zip(chosen.others, odds, strict=True):
        across = (mode.position_m - best.position_m)[:2]
        middle = 0.5 * (mode.position_m + best.position_m)[:2]
        image = mirrored(middle, float(np.arctan2(across[0], -across[1])))
        found.append(Alternative(node.index, each / total, image, since_t, image))
    return tuple(found)
