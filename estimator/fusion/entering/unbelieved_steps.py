"""Steps that a unit has told and nobody believes: its bearer went on as one whose unit is silent."""

import math

import numpy as np

from estimator.fusion import physics
from estimator.fusion.learned.link_correlation import ALIKE
from estimator.fusion.memory.ledger import COLUMNS, GIVEN, UNSEEN
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.silence import unheard_m2, unplaced_m2
from estimator.graph.dense import Array

T, LINK, SHARE = (COLUMNS["pairs"].index(name) for name in ("t", "link", "alike"))


def unbelieve(
    state: FusionState, number: int, since_t: float, until_t: float = math.inf, placed: bool = True
) -> Array:
    """Let the bearer of a unit have wandered where it has told steps.

    Args:
        state: the fusion, whose ledger is changed.
        number: of the unit's node in the ledger.
        since_t: only steps that end later (s).
        until_t: only steps that end by then (s).
        placed: ranges or fixes have told where he went; else powers alone, see `silence.unplaced_m2`.

    Returns:
        The steps as they were told, rows of the ledger.
    """
    steps = state.ledger.table("steps").copy()
    mine = (steps[:, 1] == number) & (steps[:, 0] > since_t) & (steps[:, 0] <= until_t)
    told: Array = steps[mine]
    for i in mine.nonzero()[0].tolist():
        t, from_t = steps[i, [0, 2]].tolist()
        wander_m2 = (unheard_m2 if placed else unplaced_m2)(t - from_t, max(from_t - since_t, 0.0))
        steps[i, 3:8], steps[i, GIVEN] = (0.0, 0.0, 0.0, wander_m2, 0.1 * wander_m2), UNSEEN
    state.ledger.replace("steps", steps)
    return told


def leave_behind(state: FusionState, number: int, since_t: float, until_t: float) -> None:
    """Let a bearer have left behind what readings of his links share, as who has no unit does.

    While he was thought to stand each counted as one more of the same place.

    Args:
        state: the fusion, whose ledger and links are changed.
        number: of his node in the ledger.
        since_t: since when he went (s).
        until_t: and until when (s).
    """
    pairs = state.ledger.table("pairs").copy()
    mine = np.flatnonzero((pairs[:, 2:4] == number).any(axis=1) & (pairs[:, LINK] >= 0.0))
    mine = mine[np.argsort(pairs[mine, T], kind="stable")]
    before, now = dict[int, tuple[float, float]](), dict[int, float]()
    for i in mine.tolist():
        t, link, told = float(pairs[i, T]), int(pairs[i, LINK]), float(pairs[i, SHARE])
        last_t, last = before.get(link, (t, 1.0))
        before[link] = t, told
        if t <= since_t:
            now[link] = told
            continue
        went_m = physics.FREE_WAY_MPS * max(min(t, until_t) - max(last_t, since_t), 0.0)
        kept = max(told - 1.0, 0.0) / last * math.exp(-went_m / physics.SHARED_M)
        now[link] = pairs[i, SHARE] = 1.0 + kept * now.get(link, 0.0)
    state.ledger.replace("pairs", pairs)
    for link, alike in now.items():
        if before[link][0] > since_t:
            state.links.table[link, ALIKE] = alike
