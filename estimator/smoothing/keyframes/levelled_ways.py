"""Ways of units without what their heights rise by themselves (decision 0128)."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from msgspec.structs import replace

from estimator.fusion.learned.level_legs import STRIDE_M
from estimator.fusion.learned.unit_rise import Rises, rises_of
from estimator.fusion.memory.ledger import COLUMNS, GIVEN, UNSEEN, own_rows
from estimator.fusion.memory.nodes import NodeState
from estimator.fusion.memory.state import FusionState
from estimator.graph.dense import Array

UP, UP_M2 = (COLUMNS["steps"].index(name) for name in ("u", "up2"))
"""Columns of the ledger's `steps`."""
SOME_S = 60.0
"""So much is forgotten at a time: what is cut in pieces has no legs."""
MUCH, SIGMAS = 0.02, 3.0
"""By how much heights rise at least (m/m), and how sure that is, where it is told."""
KNOWN = 64
"""Of so many units what they rise by is kept."""


def levelled(node: NodeState, steps: Array) -> Array:
    """A unit's rows of the ledger's `steps`, but for what its heights rise by themselves.

    They are as unsure besides as what the ground has climbed.

    Args:
        node: who wears it; what samples make has been levelled where they were navigated (decision 0042).
        steps: all its rows, in order of epoch.
    """
    if not _rises(node, steps):
        return steps
    found, told = steps.copy(), _told(node, steps)
    gone_m = np.hypot(steps[:, 3], steps[:, 4]) * (steps[:, GIVEN] != UNSEEN)
    found[:, UP] -= told.of_rows * gone_m
    found[:, UP_M2] += told.doubt_m**2 * gone_m / max(float(gone_m.sum()), STRIDE_M)
    return found


def tell_rises(state: FusionState, numbers: Sequence[int]) -> None:
    """Let the filter know by what units rise now.

    Args:
        state: the fusion, changed in place.
        numbers: of those who wear them.
    """
    for number in numbers:
        node, steps = state.life(number), own_rows(state.ledger.table("steps"), number)
        if not _rises(node, steps):
            continue
        told = _told(node, steps)
        state.keep(replace(node, rises=told.mean))
        if abs(told.mean) > max(MUCH, SIGMAS * told.variance**0.5):
            text = f"the heights of {node.node} {'rise' if told.mean > 0.0 else 'fall'} by themselves, by "
            text += f"about {100.0 * abs(told.mean):.0f} cm a metre, which is taken off: look at the unit"
            state.say("outlier", state.newest_t, node.node, text, once=f"heights of {node.node}")


def forget_steps(state: FusionState, before_t: float) -> None:
    """Leave out displacements of epochs before `before_t`, but for what they tell of how units rise."""
    if state.ledger.complete:
        return
    steps = state.ledger.table("steps")
    gone = steps[steps[:, 0] < before_t]
    if not len(gone) or gone[:, 0].min() > before_t - SOME_S:
        return
    for number in np.unique(gone[:, 1]).astype(int).tolist():
        node, mine = state.life(number), gone[gone[:, 1] == number]
        mine = mine[np.argsort(mine[:, 0], kind="stable")]
        if _rises(node, mine):
            told = _told(node, mine)
            state.keep(replace(node, rises_before=(told.mean, told.variance)))
    state.ledger.forget(before_t, ("steps",))


def _rises(node: NodeState, steps: Array) -> bool:
    """Whether somebody walks whose unit measures heights, which are not levelled elsewhere."""
    return node.role == "responder" and not node.raw and bool(steps[:, UP].any())


def _told(node: NodeState, steps: Array) -> Rises:
    seen = steps[:, GIVEN] != UNSEEN
    moved = np.column_stack([steps[:, 3 : UP + 1], steps[:, UP_M2], seen])
    return _known(moved.tobytes(), *node.rises_before)


@lru_cache(KNOWN)
def _known(moved: bytes, mean: float, variance: float) -> Rises:
    """See `rises_of`: each hypothesis of a window asks the same, and so does who hands it back."""
    return rises_of(np.frombuffer(moved).reshape(-1, 5).copy(), mean, variance)
