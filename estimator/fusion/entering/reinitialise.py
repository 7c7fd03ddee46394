"""Who begins anew, for what was believed of his beginning was wrong.

A beginning is a Gaussian, all readings are robust: a hundred fixes that contradict it would be outliers, for
ever. It is let go of where they are surer than it was: where nobody had told it, or a single fix. What a
gateway has told, or readings have confirmed, stays.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from estimator.fusion.entering.introduce import NO_PRIOR_SIGMA_M
from estimator.fusion.learned.link_correlation import SAME_PLACE
from estimator.fusion.memory.late_start import DOUBTED, LIKELY
from estimator.fusion.memory.ledger import RANGE
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.fusion.rows import rows
from estimator.graph.dense import Array

CONTRADICTED = 20.0
"""Squared error by what is said: one true place in 20,000 is farther off."""
SURE_SIGMAS = 4.0
"""What is nearer than so many of its own sigmas is not asked further."""
MORE, LATER = 3, 10
"""So many more seconds of fixes than ever fitted have to agree on another place than that of a first fix; and
so many against who was taken to be at the base and has walked on: a house can bend fixes for some seconds."""
SAME_SIGMAS = 4.0
SET_OFF_M = 5.0
"""Of who has walked no farther what is told of his beginning is still news: his introduction came late."""
FIXED = -1.0
"""The first column of those that are not in the matrix, for their place is certain."""


def check_fix(
    state: FusionState, node: NodeState, t: float, off_m: Sequence[float], sigma_m: float
) -> NodeState:
    """Hold a fix against where somebody seems to be, and let him begin anew where it is to be believed.

    Args:
        state: the fusion, changed in place.
        node: who moves.
        t: epoch of the fix (s).
        off_m: how far it is off, east and north (m).
        sigma_m: its standard deviation along each (m).

    Returns:
        The node after it.
    """
    known = node.absolute
    if known.beginning == "sure":
        return node
    east, north = off_m
    fits = (
        math.hypot(east, north) < SURE_SIGMAS * sigma_m
        or error_of(state, node, off_m, sigma_m) < CONTRADICTED
    )
    known = known.with_fix(t, fits, (east, north), SAME_SIGMAS * sigma_m)
    assumed = known.beginning in ("assumed", "unheard")
    soon = 1 if node.way_m < SET_OFF_M or known.late.odds > LIKELY else LATER
    needed = soon if assumed else known.fits + MORE
    if fits and (assumed or known.fits >= MORE):
        known = replace(known, beginning="sure")
    elif known.against >= needed and forget_beginning(state, node, height=True):
        # From now on it is this fix that tells where he is.
        known = replace(known, beginning="fix", fits=0, against=0)
    node = replace(node, absolute=known)
    state.nodes[node.node] = node
    return node


def check_ranges(state: FusionState, table: Array, good: Array) -> None:
    """Let those begin anew that were taken to be at the base, where no range from known places is believed.

    Args:
        state: the fusion, changed in place.
        table: readings that have been held, m × `rows.FIELDS`.
        good: probability that each has the good noise, m.
    """
    unsure = [n for n in state.nodes.values() if n.absolute.beginning == "assumed" and n.moving]
    if not unsure:
        return
    starts = state.graph.starts
    told = [n for n in state.nodes.values() if n.mode == "static" and n.absolute.told_m is not None]
    known = [FIXED, *(starts[n.position] for n in told)]
    for node in unsure:
        ends, own = table[:, [rows.A, rows.B]], starts[node.position]
        mine = (table[:, rows.KIND] == RANGE) & (ends == own).any(axis=1) & np.isin(ends, known).any(axis=1)
        believed = bool((good[mine] > SAME_PLACE).any())
        if believed and node.absolute.late.odds > DOUBTED:
            # Of a ring some range fits by chance: its likelihood counts, see `late_start`.
            continue
        # Those of one link share their error, however many there are.
        links = set(table[mine, rows.LINK].tolist())
        if believed or (len(links) >= MORE and forget_beginning(state, node, height=False)):
            state.nodes[node.node] = replace(node, absolute=replace(node.absolute, beginning="sure"))


def forget_beginning(state: FusionState, node: NodeState, height: bool) -> bool:
    """Forget where somebody who moves began, in the ledger and in the filter; his own way stays.

    Args:
        state: the fusion, changed in place.
        node: who moves.
        height: of his height as well.

    Returns:
        Whether that is still possible: later his beginning is part of what the window knows from before.
    """
    if known_before(state, node):
        return False
    begins = state.ledger.table("begins").copy()
    mine = (begins[:, 1] == node.index) & (begins[:, 2] == 0.0)
    axes = 3 if height else 2
    begins[mine, 7 : 7 + axes] = NO_PRIOR_SIGMA_M
    state.ledger.replace("begins", begins)
    here = (state.graph.starts[node.position] + np.arange(axes))[None]
    still = np.eye(axes)[None]
    state.graph.advance(here, state.graph.reference[here], still, still * NO_PRIOR_SIGMA_M**2)
    state.due = True
    return True


def known_before(state: FusionState, node: NodeState) -> bool:
    """Whether somebody's beginning is part of what the window knows from before."""
    mine = {("walk", node.index), ("free", node.index)}
    return state.prior is not None and not mine.isdisjoint(state.prior.keys)


def error_of(state: FusionState, node: NodeState, off_m: Sequence[float], sigma_m: float) -> float:
    """Squared error of a fix by what is said of both (dimensionless)."""
    first = state.graph.starts[node.position]
    said = state.graph.covariance()[first : first + 2, first : first + 2] + sigma_m**2 * np.eye(2)
    return float(np.asarray(off_m) @ np.linalg.solve(said, off_m))
