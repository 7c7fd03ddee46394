"""Whether the log begins only when people have long been inside: nobody was at the base then.

Who comes first, and of whom nobody said where he entered, is taken to be at the base: most systems are
switched on at the door. That is an assumption with a probability, and is told as one as soon as anything
speaks against it (decision 0113): radios of known places, breadcrumbs that nobody has dropped, a base that is
not heard. Where known places tell where somebody is instead, all begin again where readings allow.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from estimator.fusion import physics
from estimator.fusion.entering.base_entry import end_way
from estimator.fusion.entering.guesses import forget_place
from estimator.fusion.entering.introduce import turn_sigma
from estimator.fusion.entering.known_places import INSIDE_M, Spoken, spoken
from estimator.fusion.memory.late_start import DOUBTED, LIKELY, LateStart
from estimator.fusion.memory.ledger import RANGE, RSSI
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.measurements.node import MOVING_ROLES

BEFOREHAND = math.log(0.05 / 0.95)
"""How likely a system is to be started when people are inside already, without any reading (log odds): one
of twenty."""
UNDROPPED = (0.0, 1.5, 3.0)
"""What none, one, and more breadcrumbs that nobody has dropped speak for that (log likelihood): one may be
the radio of somebody who has not reported yet. More than two share their reason."""
UNHEARD_BASE = 1.0
"""What it speaks for that if other radios are heard, and the base is not: it may have none."""
DECIDED = 3.0
"""Log odds from which on all begin again: twenty to one."""
ASKED_S = 60.0
"""For so long after the first one's beginning it is asked, and as long as it is doubted."""
HANDED_M = 3.0, 1.5
"""What ranges, and powers, tell to be farther from everybody is in nobody's hand."""


def ask(state: FusionState) -> None:
    """Ask how likely those were inside already who were taken to be at the base when the log began.

    Args:
        state: the fusion, changed in place: they may begin anew.
    """
    begun_t = state.entered_t
    if begun_t is None or not math.isfinite(begun_t):
        return
    early = state.newest_t - begun_t <= ASKED_S
    # This is asked in each tick, and nearly always there is nobody.
    if not early and all(node.absolute.late.odds <= DOUBTED for node in state.nodes.values()):
        return
    crew = [node for node in state.nodes.values() if _is_asked(state, node, begun_t, early)]
    if not crew:
        return
    if state.newest_t - begun_t <= physics.UNSEEN_S:
        hint = _hint(state, begun_t)
    else:
        hint = max(node.absolute.late.hint for node in crew)
    known = {node.node: _led(state, node) for node in crew}
    heard = {node.node: spoken(state, node, known[node.node], begun_t) for node in crew}
    told = {node.node: _clearest(node.absolute.late.told, heard[node.node]) for node in crew}
    # Whether the log begins late is the same for all; of one by himself his own readings may say more.
    of_all = sum(one for one in told.values() if one is not None)
    found = False
    for node in crew:
        said, own = heard[node.node], told[node.node]
        speaks = hint + (of_all if own is None else max(of_all, own))
        reach_m = said.reach_m if said is not None and said.odds > 0.0 else INSIDE_M
        # Where nothing at all speaks for it he enters, as nearly everybody does.
        odds = BEFOREHAND + speaks if max(hint, speaks) > 0.0 else -math.inf
        late = replace(known[node.node], odds=odds, hint=hint, told=own, reach_m=reach_m)
        state.nodes[node.node] = replace(node, absolute=replace(node.absolute, late=late))
        if odds > LIKELY:
            _tell(state, node, late)
        if said is not None and said.found:
            found = found or BEFOREHAND + hint + min(of_all, said.odds) > DECIDED
    if found:
        now = [state.nodes[node.node] for node in crew]
        _begin_again(state, [node for node in now if node.absolute.late.odds > 0.0])


def _tell(state: FusionState, node: NodeState, late: LateStart) -> None:
    chance = 1.0 / (1.0 + math.exp(-late.odds))
    text = (
        f"{node.node} may have been inside already when the log began (by {chance:.0%}), and is far from "
        "where it is shown then: nobody said where it entered. A fix (`position`) tells where it is"
    )
    state.say("conflict", state.newest_t, node.node, text, once=f"{node.node} may have been inside")


def _is_asked(state: FusionState, node: NodeState, begun_t: float, early: bool) -> bool:
    known = node.absolute
    if known.beginning != "assumed" or node.mode != "unit" or not (early or known.late.odds > DOUBTED):
        return False
    begins = state.ledger.table("begins")
    mine = begins[(begins[:, 1] == node.index) & (begins[:, 2] == 0.0)]
    return not len(mine) or mine[0, 0] <= begun_t + physics.UNSEEN_S


def _led(state: FusionState, node: NodeState) -> LateStart:
    """What is known of him, with how far his unit has led him by now."""
    known, steps = node.absolute.late, state.ledger.table("steps")
    if known.faced is None:
        begins = state.ledger.table("begins")
        mine = begins[(begins[:, 1] == node.index) & (begins[:, 2] == 1.0)]
        turn_rad, sigma_rad = mine[-1, 10:12].tolist() if len(mine) else (0.0, turn_sigma(node))
        known = replace(known, faced=(turn_rad, sigma_rad))
    east, north, until_t = known.led
    steps = steps[(steps[:, 1] == node.index) & (steps[:, 0] > until_t)]
    if not len(steps):
        return known
    gone_e, gone_n = steps[:, 3:5].sum(axis=0).tolist()
    return replace(known, led=(east + gone_e, north + gone_n, float(steps[:, 0].max())))


def _clearest(before: float | None, said: Spoken | None) -> float | None:
    """What known places have said of somebody when they were clearest."""
    if said is None or before is None:
        return before if said is None else said.odds
    return said.odds if abs(said.odds) > abs(before) else before


def _hint(state: FusionState, since_t: float) -> float:
    """What is heard at once for people being inside already (log likelihood).

    Args:
        state: the fusion.
        since_t: when the first one began (s).
    """
    pairs = state.ledger.table("pairs")
    pairs = pairs[pairs[:, 1] <= RSSI]
    found = UNDROPPED[min(len(_undropped(state, since_t)), len(UNDROPPED) - 1)]
    bases = [node.index for node in state.nodes.values() if node.mode == "fixed"]
    waited = state.newest_t - since_t >= physics.MOVING_SIGHTINGS_S
    if waited and bases and len(pairs) and not np.isin(pairs[:, 2:4], bases).any():
        found += UNHEARD_BASE
    return found


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


def _begin_again(state: FusionState, crew: Sequence[NodeState]) -> None:
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


def unsure_m2(state: FusionState) -> dict[str, float]:
    """What places are the less sure by that hang on where those entered who are doubted, by node (m²).

    Along each horizontal axis. What they have told of what lies about them goes with them.

    Args:
        state: the fusion.
    """
    doubted = {
        name: node.absolute.late.doubt_m2
        for name, node in state.nodes.items()
        if node.absolute.beginning == "assumed"
    }
    most_m2 = max(doubted.values(), default=0.0)
    if most_m2 == 0.0:
        return {}
    for name, node in state.nodes.items():
        known = node.absolute
        asked = math.isfinite(known.late.odds) or known.late.told is not None
        told = known.told_m is not None or known.fixes.t is not None
        if node.mode in ("static", "unit", "free") and not told and not asked:
            doubted[name] = most_m2
    return {name: m2 for name, m2 in doubted.items() if m2 > 0.0}
