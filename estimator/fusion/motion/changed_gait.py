"""Since when somebody crawls, or walks again, and how far he has gone like that (decision 0129)."""

import numpy as np

from estimator.fusion import physics
from estimator.fusion.learned.gait import PACE_S, RENEWED, SHUFFLES_MPS, STRIDE_S, Gait
from estimator.fusion.memory.ledger import CLAIMED, GIVEN, SCALE2, UNSEEN, own_rows
from estimator.fusion.memory.state import FusionState
from estimator.fusion.motion.steps import Step, sum_of
from estimator.graph.dense import Array

LOOKED_BACK_S = 2.0 * PACE_S
"""Of so much of the time in which he went it is asked since when he goes like that."""


def change_gait(state: FusionState, step: Step, gait: Gait) -> None:
    """Let a unit's scale be another one since its bearer began to go otherwise.

    The window goes over that time again, and is told of its beginning; the filter is past it.

    Args:
        state: the fusion, whose ledger has the displacement with which it shows; changed.
        step: what the unit has moved in this tick, changed.
        gait: how he goes now.
    """
    index = step.node.index
    rows = own_rows(state.ledger.table("steps"), index)
    first = began(rows, gait.slow)
    since_t = float(rows[first, 2])
    state.ledger.add("steps", since_t, index, since_t, *(0.0,) * 7, gait.scale2, CLAIMED)
    east_m, north_m = rows[first:, 3:5].sum(axis=0).tolist()
    step.noise = sum_of(step.noise, (0.0, 0.0, 0.0, 0.0, 0.0, gait.scale2))
    step.changed_m = east_m, north_m


def began(rows: Array, slow: bool) -> int:
    """With which of a unit's displacements its bearer began to go as he does now.

    Where two paces, before it and since, fit best what was told lately, in least squares over time; with the
    oldest where the pace before says nothing else. Lately is since his gait changed before, too. Who may have
    crawled from the first on has not walked at a pace that says neither.

    Args:
        rows: its rows of the ledger's `steps`, in order of epoch, m × 12.
        slow: he may crawl now; else he walks again.
    """
    changed = np.flatnonzero(rows[:, SCALE2] > RENEWED)
    t, span_s, gone_m = rows[:, 0], rows[:, 0] - rows[:, 2], np.hypot(rows[:, 3], rows[:, 4])
    stride_s, way_m = np.maximum(span_s, STRIDE_S), np.cumsum(gone_m)
    stride_m = way_m - np.interp(t - stride_s, t, way_m, left=0.0)
    goes = (span_s > 0.0) & (stride_m > SHUFFLES_MPS * stride_s) & (rows[:, GIVEN] != UNSEEN)
    goes[: changed[-1] + 1 if len(changed) else 0] = False
    back = np.flatnonzero(goes)[::-1]
    if not len(back):
        return len(rows) - 1
    lasted_s, way_m = np.cumsum(span_s[back]), np.cumsum(gone_m[back])
    lately = int(np.searchsorted(lasted_s, LOOKED_BACK_S)) + 1
    lasted_s, way_m = lasted_s[:lately], way_m[:lately]
    before_s, before_m = lasted_s[-1] - lasted_s[:-1], way_m[-1] - way_m[:-1]
    if len(before_s):
        told = way_m[:-1] ** 2 / lasted_s[:-1] + before_m**2 / before_s
        best = int(told.argmax())
        pace_mps = before_m[best] / before_s[best]
        from_first = lately >= len(back) and not len(changed)
        walked_mps = physics.WALKS_MPS if from_first else physics.CRAWLS_MPS
        if pace_mps > walked_mps if slow else pace_mps < physics.WALKS_MPS:
            return int(back[best])
    return int(back[len(lasted_s) - 1])
