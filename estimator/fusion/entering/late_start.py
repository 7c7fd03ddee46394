"""Whether the log begins only when people have long been inside: nobody was at the base then.

Who comes first, and of whom nobody said where he entered, is taken to be at the base: most systems are
switched on at the door. That is an assumption with a probability. Radios of known places may say that he is
elsewhere, and the more so where breadcrumbs that nobody has dropped lie about: somebody has been there who is
not in the log (decision 0110).
"""

import math
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.base_entry import end_way
from estimator.fusion.entering.guesses import forget_place
from estimator.fusion.entering.modes import UndecidedNode, find_modes, mode_at
from estimator.fusion.entering.reinitialise import known_before
from estimator.fusion.entering.rival_modes import area_m2, farthest_m
from estimator.fusion.entering.sightings import DRIFT, UNSURE_M, of_node
from estimator.fusion.entering.technologies import path_loss_states, technology_states
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array
from estimator.graph.variable import BODY
from estimator.measurements.node import MOVING_ROLES

BEFOREHAND = math.log(0.1 / 0.9)
"""How likely a system is to be started when people are inside already, without any reading (log odds): one
of ten."""
UNDROPPED = (0.0, 1.5, 3.0)
"""What none, one, and more breadcrumbs that nobody has dropped speak for that (log likelihood): one may be
the radio of somebody who has not reported yet. More than two share their reason."""
ASKED_S = 60.0
"""For so long after the first one's beginning it is asked: later his beginning is part of what is known."""
HANDED_M = 3.0, 1.5
"""What ranges, and powers, tell to be farther from everybody is in nobody's hand."""


def ask(state: FusionState) -> None:
    """Let those begin where readings allow who were taken to be at the base, if the log began too late.

    Args:
        state: the fusion, changed in place.
    """
    if state.entered_t is None or not 0.0 <= state.newest_t - state.entered_t <= ASKED_S:
        return
    crew = [node for node in state.nodes.values() if _is_assumed(state, node)]
    if not crew:
        return
    told = [odds for odds in (_odds_elsewhere(state, node) for node in crew) if odds is not None]
    if not told:
        # Nobody could be found again, and the map is right but for where it lies.
        return
    waited = state.newest_t - state.entered_t >= physics.MOVING_SIGHTINGS_S
    undropped = len(_undropped(state, state.entered_t)) if waited else 0
    if BEFOREHAND + UNDROPPED[min(undropped, len(UNDROPPED) - 1)] + max(told) > 0.0:
        _begin_again(state, crew)


def _is_assumed(state: FusionState, node: NodeState) -> bool:
    return node.absolute.beginning == "assumed" and node.mode == "unit" and not known_before(state, node)


def _odds_elsewhere(state: FusionState, node: NodeState) -> float | None:
    """By how much readings of known places speak against his way from the base (log likelihood).

    Args:
        state: the fusion.
        node: who moves, taken to have begun at the base.

    Returns:
        It; None: no radio of a known place is heard.
    """
    known = {
        other.index
        for other in state.nodes.values()
        if other.mode == "fixed" or (other.mode == "static" and other.absolute.believed_m is not None)
    }
    seen = of_node(state, node, state.newest_t - physics.UNSEEN_S, known)
    if seen is None:
        return None
    way = _way(state, node)
    gone_m = way.at(seen.t)
    here_m = way.at(np.array([state.newest_t]))[0]
    behind_m = np.linalg.norm(gone_m - here_m, axis=1)
    owner = state.sources[seen.source]
    ranged = seen.kind == RANGE
    states = technology_states(state, owner) if ranged else path_loss_states(state, owner)
    own = slice(state.graph.starts[states], state.graph.starts[states] + BODY)
    extra, covariance = state.graph.value(states)[:BODY].copy(), state.graph.covariance()[own, own]
    sigma = seen.sigma * state.learned(owner).factor
    if ranged:
        sigma = np.hypot(sigma, UNSURE_M + (way.turn_sigma_rad + DRIFT) * behind_m)
    sought = UndecidedNode(
        kind="range" if ranged else "rssi",
        # As if he had stood where he is now.
        points=seen.points - (gone_m - here_m),
        value=seen.value,
        sigma=sigma * np.sqrt(seen.alike),
        up_m=float(seen.points[:, 2].mean()),
        up_sigma_m=physics.UNDECIDED_MOVING_UP_SIGMA_M,
        extra=extra,
        extra_covariance=covariance,
    )
    modes = find_modes(sought)
    if not modes:
        return None
    entry_m = physics.ENTRY_SIGMA_M[0]
    sigma_m = entry_m + (way.turn_sigma_rad + DRIFT) * float(np.linalg.norm(here_m))
    here = mode_at(sought, (np.array(state.base_place()) + here_m)[:2], sigma_m)
    most_m = min(physics.REACH_M, farthest_m(seen, modes[0])) if ranged else physics.REACH_M
    # How much more surely the base tells where he is than the whole building does.
    told = 2.0 * math.log(physics.REACH_M / sigma_m) + math.log(
        area_m2(here, most_m) / area_m2(modes[0], most_m)
    )
    return here.cost - told - modes[0].cost


class _Way(NamedTuple):
    """The way that a unit has told since its bearer began.

    Attributes:
        t: epochs, ascending, n (s).
        gone_m: displacement since the first, n × 3 (m).
        turn_sigma_rad: how unsure it is whither it leads (rad).
    """

    t: Array
    gone_m: Array
    turn_sigma_rad: float

    def at(self, t: Array) -> Array:
        """Displacements at epochs, m × 3 (m)."""
        return np.column_stack([np.interp(t, self.t, self.gone_m[:, axis]) for axis in range(3)])


def _way(state: FusionState, node: NodeState) -> _Way:
    steps, begins = state.ledger.table("steps"), state.ledger.table("begins")
    steps = steps[steps[:, 1] == node.index]
    turn_rad, sigma_rad = begins[(begins[:, 1] == node.index) & (begins[:, 2] == 1.0)][-1, 10:12].tolist()
    cosine, sine = math.cos(turn_rad), math.sin(turn_rad)
    turned = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    gone_m = np.concatenate([np.zeros((1, 3)), np.cumsum(steps[:, 3:6] @ turned.T, axis=0)])
    start_t = steps[0, 2] if len(steps) else state.newest_t
    return _Way(np.concatenate([[start_t], steps[:, 0]]), gone_m, min(sigma_rad, math.pi))


def _undropped(state: FusionState, since_t: float) -> list[NodeState]:
    """Breadcrumbs that lay away from everybody as soon as anything was heard, and that nobody has dropped.

    Args:
        state: the fusion.
        since_t: when that was (s).
    """
    pairs = state.ledger.table("pairs")
    pairs = pairs[(pairs[:, 1] <= RSSI) & (pairs[:, 0] <= since_t + physics.MOVING_SIGHTINGS_S)]
    ranged_m, heard_m = HANDED_M
    # Even a radio that sends weakly is heard stronger within that.
    near_dbm = physics.RSSI_POWER_DBM - physics.RSSI_POWER_SIGMA_DB
    near_dbm -= 10.0 * physics.RSSI_EXPONENT * math.log10(heard_m)
    near = np.where(pairs[:, 1] == RANGE, pairs[:, 4] < ranged_m, pairs[:, 4] - pairs[:, 7] > near_dbm)
    found = []
    for node in state.nodes.values():
        if node.role != "breadcrumb" or node.mode == "retired" or math.isfinite(node.place_told_t):
            continue
        mine = (pairs[:, 2:4] == node.index).any(axis=1)
        if mine.any() and not near[mine].any():
            found.append(node)
    return found


def _begin_again(state: FusionState, crew: list[NodeState]) -> None:
    """Let nobody be where he was taken to be: all begin where readings allow, and so does what lies there.

    Args:
        state: the fusion, changed in place.
        crew: who was taken to be at the base.
    """
    for node in list(state.nodes.values()):
        if node.mode == "static" and node.absolute.told_m is None:
            forget_place(state, node, moves=False)
    begins = state.ledger.table("begins").copy()
    for node in crew:
        mine = (begins[:, 1] == node.index) & (begins[:, 2] == 0.0)
        begins[mine, 7:9] = physics.REACH_M
    state.ledger.replace("begins", begins)
    for node in crew:
        end_way(state, node)
    # Whoever is in the log by now may have been inside for as long as anybody.
    state.entered_t = -math.inf
    for name, node in list(state.nodes.items()):
        if node.role in MOVING_ROLES and node.mode == "undecided":
            state.nodes[name] = replace(node, introduced_t=-math.inf)
    names = ", ".join(node.node for node in crew)
    text = (
        f"radios say that the log begins when people were inside already: where {names} entered nobody said, "
        "and ranges or fixes are to tell"
    )
    state.say("conflict", state.newest_t, crew[0].node, text, once="the log begins late")
